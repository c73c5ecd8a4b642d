"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const REGIONS = ["shadow", "toy", "edge", "frame"];
const PATHS = { frame: "Frame path, for every picture", capture: "Capture path, when the place is new" };
const at = id => document.getElementById(id);
const several = data.presets.length > 1;
let current = 0;
let divider = 50;
let centre = middle();

/* An element with its attributes and children; text is never read as HTML. */
function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.flat().filter(child => child !== null));
  return node;
}
const ms = value => value === null ? "\u2013" : `${value < 10 ? value.toFixed(2) : value.toFixed(1)} ms`;
const entry = preset => preset.report.frames[current];
const unique = list => [...new Set(list)];

/* Pictures */

const CAMERA = { name: "before", title: "Camera frame", caption: "What the camera saw: the real toy, at rest." };
const RESULT = { name: "after", title: "Result", caption: "The picture that was made." };
const TRUTH = { name: "truth", title: "Truth", caption: "What the camera would have seen." };
const PICTURES = [CAMERA, RESULT, TRUTH, ...data.shown];

function fileOf(preset, name) {
  const frame = entry(preset);
  if (name === "before" || name === "truth") return data.frames[current][name];
  const file = name === "after" ? frame.picture : name === "error" ? frame.error
    : frame.maps.find(map => map.name === name)?.file;
  return file ? preset.folder + file : null;
}

function offered(preset) {
  const frames = preset.report.frames;
  return PICTURES.filter(({ name }) => name === "before" || name === "after"
    || (name === "truth" ? data.frames.some(frame => frame.truth)
      : name === "error" ? frames.some(frame => frame.error)
        : frames.some(frame => frame.maps.some(map => map.name === name))));
}

function makeViewer(preset) {
  const pictures = offered(preset);
  const name = preset.report.preset;
  const halves = ["left", "right"].map(side => {
    const select = el("select", { "aria-label": `${name}, ${side} picture` },
      pictures.map(picture => el("option", { value: picture.name }, picture.title)));
    select.value = side === "left" ? "before" : "after";
    const image = el("img", { draggable: "false" });
    const missing = el("span", { class: "missing", hidden: true }, "not made for this frame");
    const pan = el("div", { class: "pan" }, image);
    const node = el("div", { class: `half ${side}` }, pan, missing);
    const caption = el("div");
    const half = { side, select, image, missing, pan, node, caption };
    select.addEventListener("change", () => choose(half));
    return half;
  });
  const handle = el("div", {
    class: "divider", role: "slider", tabindex: "0", "aria-label": `${name}, divider`,
    "aria-valuemin": "0", "aria-valuemax": "100",
  });
  const stage = el("div", { class: "stage", style: `aspect-ratio: ${data.size_px.join(" / ")}` },
    halves.map(half => half.node), handle);
  const node = el("article", { class: "viewer" }, el("h2", {}, name),
    el("div", { class: "choice" }, halves.map(half => half.select)), stage,
    el("div", { class: "captions" }, halves.map(half => half.caption)));
  listen(stage, handle);
  return { preset, pictures, halves, handle, stage, node };
}

/* Drags the divider; in a close-up, what is not the divider drags the picture. */
function listen(stage, handle) {
  let isPanning = false;
  stage.addEventListener("pointerdown", event => {
    isPanning = scale() > 1 && event.target !== handle;
    stage.setPointerCapture(event.pointerId);
    if (!isPanning) dragDivider(event);
  });
  const dragDivider = event => {
    const box = stage.getBoundingClientRect();
    moveDivider(100 * (event.clientX - box.left) / box.width);
  };
  stage.addEventListener("pointermove", event => {
    if (!stage.hasPointerCapture(event.pointerId)) return;
    const box = stage.getBoundingClientRect();
    if (isPanning) pan(-event.movementX / box.width, -event.movementY / box.height);
    else dragDivider(event);
  });
  handle.addEventListener("keydown", event => {
    const step = { ArrowLeft: -2, ArrowDown: -2, ArrowRight: 2, ArrowUp: 2, Home: -100, End: 100 }[event.key];
    if (!step || event.shiftKey) return;
    event.preventDefault();
    event.stopPropagation();
    moveDivider(divider + step);
  });
}

const scale = () => Number(at("zoom").value);

/* Moves the close-up by parts of the stage, up to the picture's border. */
function pan(x, y) {
  const margin = 0.5 / scale();
  centre = [centre[0] + x / scale(), centre[1] + y / scale()]
    .map(value => Math.min(1 - margin, Math.max(margin, value)));
  const shift = centre.map(value => `${50 - 100 * scale() * value}%`).join(", ");
  for (const half of viewers.flatMap(viewer => viewer.halves)) {
    half.pan.style.transform = `translate(${shift}) scale(${scale()})`;
    half.pan.classList.toggle("close", scale() > 1);
  }
}

/* The middle of what was worked on, from 0 to 1 along each side. */
function middle() {
  const region = data.presets.flatMap(preset => preset.report.frames).find(frame => frame.region)?.region;
  return [0, 1].map(i => region ? (region.origin_px[i] + region.size_px[i] / 2) / data.size_px[i] : 0.5);
}

function moveDivider(percent) {
  divider = Math.min(100, Math.max(0, percent));
  for (const viewer of viewers) {
    viewer.stage.style.setProperty("--at", `${divider}%`);
    viewer.handle.setAttribute("aria-valuenow", Math.round(divider));
  }
}

function choose(half) {
  if (at("link").checked) {
    for (const viewer of viewers) {
      const other = viewer.halves.find(other => other.side === half.side);
      if (viewer.pictures.some(picture => picture.name === half.select.value)) other.select.value = half.select.value;
    }
  }
  show();
}

function showViewer(viewer) {
  for (const half of viewer.halves) {
    const picture = viewer.pictures.find(picture => picture.name === half.select.value);
    const file = fileOf(viewer.preset, picture.name);
    half.missing.hidden = Boolean(file);
    half.image.hidden = !file;
    if (file && half.image.getAttribute("src") !== file) half.image.src = file;
    half.image.alt = `${picture.title}, frame ${data.frames[current].index}, preset ${viewer.preset.report.preset}`;
    half.caption.replaceChildren(el("b", {}, picture.title), ` ${picture.caption}`,
      ...legend(picture.legend));
  }
}

function legend(legend) {
  if (!legend) return [];
  const colors = legend.ramp.map(color => `rgb(${color.join(" ")})`).join(", ");
  return [el("div", { class: "ramp", style: `background: linear-gradient(to right, ${colors})` }),
    el("div", { class: "ends" }, el("span", {}, legend.low), el("span", {}, legend.high))];
}

