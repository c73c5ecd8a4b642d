/* Viewers: each shows two pictures, A and B, of whatever preset. */

const CAMERA = { name: "before", title: "Camera frame", caption: "What the camera saw: the real toy, at rest." };
const RESULT = { name: "after", title: "Result", caption: "The picture that was made." };
const TRUTH = { name: "truth", title: "Truth", caption: "What the camera would have seen." };
const COMMON = [CAMERA, TRUTH];
const MODES = { divider: "Divider", flip: "Flip", overlay: "Overlay", difference: "Difference" };

/* Path of a picture in the frame that is shown; none if it was not made. */
function fileOf(preset, name) {
  const frame = entry(preset);
  if (name === "before" || name === "truth") return data.frames[state.frame][name];
  const file = name === "after" ? frame.picture : name === "error" ? frame.error
    : frame.maps.find(map => map.name === name)?.file;
  return file ? preset.folder + file : null;
}

/* The pictures that some frame of a preset has, but for those that all presets share. */
function offered(preset) {
  const frames = preset.report.frames;
  return [RESULT, ...data.shown].filter(({ name }) => name === "after"
    || frames.some(frame => name === "error" ? frame.error : frame.maps.some(map => map.name === name)));
}
const shared = () => COMMON.filter(({ name }) => data.frames.some(frame => frame[name]));

/* Choices of all pictures: those of the viewer's own preset go by their name, those of another by preset/name. */
function choices(own) {
  const others = data.presets.filter(preset => preset !== own);
  const group = (label, prefix, pictures) => el("optgroup", { label },
    pictures.map(({ name, title }) => el("option", { value: prefix + name }, prefix ? `${prefix.slice(0, -1)}: ${title}` : title)));
  return [group("of the session", "", shared()), group(own.report.preset, "", offered(own)),
    ...others.map(preset => group(preset.report.preset, `${preset.report.preset}/`, offered(preset)))];
}

function makeViewer(preset) {
  const name = preset.report.preset;
  const sides = ["a", "b"].map(key => {
    const select = el("select", { "aria-label": `${name}, picture ${key.toUpperCase()}` }, choices(preset));
    const first = shared()[0]?.name ?? offered(preset)[1]?.name ?? "after";
    select.value = key === "a" ? first : "after";
    const image = el("img", { draggable: "false", alt: "" });
    const missing = el("span", { class: "missing", hidden: true }, "not made for this frame");
    const side = { key, select, image, missing, node: el("div", { class: `side ${key}` }, image, missing), caption: el("div") };
    select.addEventListener("change", () => choose(side));
    return side;
  });
  const handle = el("div", {
    class: "handle", role: "slider", tabindex: "0", "aria-label": `${name}, divider`,
    "aria-valuemin": "0", "aria-valuemax": "100",
  });
  const stage = el("div", { class: "stage", style: `--wide: ${WIDTH / HEIGHT}` }, el("div", { class: "both" }, sides.map(side => side.node)), handle);
  const larger = el("button", { type: "button", class: "larger", title: "As large as the window (L)" }, "Large");
  larger.addEventListener("click", () => enlarge(state.isLarge ? null : name));
  const readout = el("p", { class: "readout" });
  const node = el("article", { class: "viewer" }, el("div", { class: "head" }, el("h2", {}, name),
    sides.map(side => el("label", {}, el("b", {}, side.key.toUpperCase()), side.select)), larger), stage, readout,
    el("div", { class: "captions" }, sides.map(side => side.caption)));
  const viewer = { preset, name, sides, handle, stage, larger, readout, node, place: { left: 0, top: 0, step: 1 } };
  listen(viewer);
  return viewer;
}

const shownViewers = () => viewers.filter(viewer => !viewer.node.hidden);

/* The picture that a side shows: whose it is, and what. */
function chosen(viewer, side) {
  const parts = side.select.value.split("/");
  const preset = parts.length > 1 ? presetOf(parts[0]) : viewer.preset;
  const picture = [...COMMON, RESULT, ...data.shown].find(({ name }) => name === parts.at(-1));
  return { preset, picture, title: parts.length > 1 ? `${parts[0]}: ${picture.title}` : picture.title };
}

/* Sets a side to a choice, as another viewer names it; stays as it is if it has no such picture. */
function setSide(viewer, key, value) {
  const side = viewer.sides.find(side => side.key === key);
  const own = value.startsWith(`${viewer.name}/`) ? value.slice(viewer.name.length + 1) : value;
  if ([...side.select.options].some(option => option.value === own)) side.select.value = own;
}

function choose(side) {
  if (at("link").checked) viewers.forEach(viewer => setSide(viewer, side.key, side.select.value));
  show();
}

function showViewer(viewer) {
  for (const side of viewer.sides) {
    const { preset, picture, title } = chosen(viewer, side);
    const file = fileOf(preset, picture.name);
    const hasValues = [CAMERA, RESULT, TRUTH].includes(picture) || (isFilm && !picture.legend && picture.swatches.length === 0);
    side.valueFile = hasValues ? file : null;
    side.missing.hidden = Boolean(file);
    side.image.hidden = !file;
    if (file && side.image.getAttribute("src") !== file) side.image.src = file;
    side.image.alt = `${title}, frame ${data.frames[state.frame].index}, preset ${preset.report.preset}`;
    side.caption.replaceChildren(el("b", {}, `${side.key.toUpperCase()} ${title}. `), picture.caption, ...legend(picture));
  }
  const { mode } = state;
  viewer.stage.dataset.mode = mode;
  viewer.stage.classList.toggle("flipped", state.isFlipped);
  viewer.stage.style.setProperty("--opacity", state.opacity / 100);
  viewer.handle.hidden = mode !== "divider";
}

/* The meaning of a picture's colours. */
function legend({ legend: ramp, swatches = [] }) {
  const box = ([r, g, b]) => el("i", { class: "swatch", style: `background: rgb(${r} ${g} ${b})` });
  const single = swatches.map(({ color, meaning }) => el("span", {}, box(color), meaning));
  if (!ramp) return single.length > 0 ? [el("div", { class: "swatches" }, single)] : [];
  return rampOf(ramp.ramp, ramp.low, ramp.high);
}

function rampOf(ramp, low, high) {
  const colors = ramp.map(color => `rgb(${color.join(" ")})`).join(", ");
  return [el("div", { class: "ramp", style: `background: linear-gradient(to right, ${colors})` }),
    el("div", { class: "ends" }, el("span", {}, low), el("span", {}, high))];
}

/* The difference is made by the browser's own filters: the largest over red, green and blue, times a gain, through a ramp. */
const errorRamp = data.shown.find(({ name }) => name === "error").legend.ramp;
function makeFilter() {
  const gray = channel => Array(3).fill([0, 1, 2].map(i => i === channel ? 1 : 0).join(" ") + " 0 0").join(" ") + " 0 0 0 1 0";
  const parts = ["r", "g", "b"].map((result, i) => draw("feColorMatrix", { in: "SourceGraphic", values: gray(i), result }));
  const lighter = (a, b, result) => draw("feBlend", { mode: "lighten", in: a, in2: b, result });
  const perChannel = attributes => ["R", "G", "B"].map((name, i) => draw(`feFunc${name}`, attributes(i)));
  const gains = perChannel(() => ({ type: "linear", slope: state.gain }));
  const table = perChannel(i => ({ type: "table", tableValues: errorRamp.map(color => color[i] / 255).join(" ") }));
  const filter = draw("filter", { id: "difference", "color-interpolation-filters": "sRGB", x: "0", y: "0", width: "1", height: "1" },
    ...parts, lighter("r", "g", "rg"), lighter("rg", "b", "most"), draw("feComponentTransfer", { in: "most" }, ...gains),
    draw("feComponentTransfer", {}, ...table));
  document.body.append(draw("svg", { width: "0", height: "0", "aria-hidden": "true", style: "position: absolute" }, filter));
  return slope => gains.forEach(gain => gain.setAttribute("slope", slope));
}
const setGain = makeFilter();

/* Modes and what each can be set to. */

function setMode(mode) {
  // The key of a mode that is on already flips the pictures.
  if (mode === "flip") state.isFlipped = state.mode === "flip" ? !state.isFlipped : true;
  state.mode = mode;
  show();
}

const GAINS = [1, 2, 4, 8, 16, 32, 64, 128];
function setAmount(value) {
  if (state.mode === "overlay") state.opacity = clamp(value, 0, 100);
  else if (state.mode === "difference") state.gain = GAINS[clamp(value, 0, GAINS.length - 1)];
  else if (state.mode === "divider") moveDivider(value);
  show();
}
const amount = () => state.mode === "difference" ? GAINS.indexOf(state.gain) : state.mode === "overlay" ? state.opacity : state.divider;

function showModes() {
  for (const button of at("modes").children) button.setAttribute("aria-pressed", button.dataset.mode === state.mode);
  const slider = at("amount");
  slider.hidden = state.mode === "flip" || state.mode === "divider";
  slider.max = state.mode === "difference" ? GAINS.length - 1 : 100;
  slider.value = amount();
  setGain(state.gain);
  const white = 255 / state.gain;
  at("amount-name").textContent = { divider: "", flip: state.isFlipped ? "shows B" : "shows A", overlay: `${state.opacity} % of B`,
    difference: `\u00d7 ${state.gain}: ends at ${white >= 10 ? Math.round(white) : white.toFixed(1)} codes` }[state.mode];
  at("amount-ramp").hidden = state.mode !== "difference";
}
