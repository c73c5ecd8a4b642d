/* Frames */

function show() {
  const { index } = data.frames[state.frame];
  at("frame").value = state.frame;
  at("frame-name").textContent = `Frame ${index}, at ${entry(data.presets[0]).time_secs.toFixed(2)} s`;
  showPresets();
  showWords();
  viewers.forEach(showViewer);
  showModes();
  placePictures();
  showValues();
  [showNumbers, showTimes, showAlignment, showSkipped, showWarnings].forEach(part => part());
  keepAddress();
}

function go(frame) {
  const n = data.frames.length;
  state.frame = (frame + n) % n;
  if (playing) playing.passed_secs = starts_secs[state.frame];
  show();
}

/* Presets that are shown; at least one is. */

function showPresets() {
  const names = state.presets;
  for (const viewer of viewers) {
    viewer.node.hidden = state.isLarge ? viewer.name !== names[0] : !names.includes(viewer.name);
    viewer.larger.textContent = state.isLarge ? "Close" : "Large";
  }
  for (const button of at("shown").children) {
    const name = button.textContent;
    button.setAttribute("aria-pressed", state.isLarge ? name === names[0] : names.includes(name));
  }
  document.body.classList.toggle("large", state.isLarge);
  at("viewers").style.setProperty("--columns", Math.min(shownViewers().length === 4 ? 2 : shownViewers().length, 3));
}

/* Shows or hides one; of those that are as large as the window, another takes its place. */
function toggle(name) {
  if (state.isLarge) {
    state.presets = [name, ...state.presets.filter(other => other !== name)];
    show();
    return;
  }
  const shown = data.presets.map(preset => preset.report.preset)
    .filter(other => other === name ? !state.presets.includes(name) : state.presets.includes(other));
  if (shown.length > 0) state.presets = shown;
  show();
}

let before = null;
function enlarge(name) {
  if (name !== null && !state.isLarge) {
    before = state.presets;
    state.presets = [name, ...before.filter(other => other !== name)];
  } else if (name === null && before) {
    state.presets = before;
  }
  state.isLarge = name !== null;
  show();
}

/* Playing: by the session's own clock, so that a late picture is left out rather than all later ones delayed. */

const times_secs = data.presets[0].report.frames.map(frame => frame.time_secs);
const isTimed = times_secs.every((time, i) => i === 0 || time > times_secs[i - 1]);
const step_secs = isTimed && times_secs.length > 1 ? (times_secs.at(-1) - times_secs[0]) / (times_secs.length - 1) : 1 / 24;
const starts_secs = times_secs.map((time, i) => isTimed ? time - times_secs[0] : i * step_secs);
const length_secs = starts_secs.at(-1) + step_secs;
let playing = null;

function play() {
  if (playing) cancelAnimationFrame(playing.request);
  playing = playing ? null : { passed_secs: starts_secs[state.frame], at_ms: performance.now() };
  point(null);
  if (playing) tick(playing.at_ms);
  at("play").textContent = playing ? "Pause" : "Play";
  at("play").setAttribute("aria-pressed", Boolean(playing));
  if (!playing) show();
}

function tick(now_ms) {
  playing.passed_secs += Math.max(now_ms - playing.at_ms, 0) / 1e3 * Number(at("speed").value);
  playing.at_ms = now_ms;
  const now_secs = playing.passed_secs % length_secs;
  const frame = starts_secs.findLastIndex(start => start <= now_secs + 1e-9);
  if (frame !== state.frame) showQuickly(frame);
  playing.request = requestAnimationFrame(tick);
}

/* Pictures alone; the tables follow when it stops. */
const kept = new Map();
function showQuickly(frame) {
  state.frame = frame;
  at("frame").value = frame;
  at("frame-name").textContent = `Frame ${data.frames[frame].index}, at ${times_secs[frame].toFixed(2)} s`;
  showWords();
  shownViewers().forEach(showViewer);
  const ahead = (frame + 4) % data.frames.length;
  for (const viewer of shownViewers()) {
    for (const side of viewer.sides) {
      const file = pathIn(ahead, viewer, side);
      if (file && !kept.has(file)) kept.set(file, Object.assign(new Image(), { src: file }));
    }
  }
  while (kept.size > 200) kept.delete(kept.keys().next().value);
}

function pathIn(frame, viewer, side) {
  const { preset, picture } = chosen(viewer, side);
  const now = state.frame;
  state.frame = frame;
  const file = fileOf(preset, picture.name);
  state.frame = now;
  return file;
}

/* The address: what is after # says what is shown, and is kept up, so that it can be sent to someone. */

let addressTimer = null;
function keepAddress() {
  clearTimeout(addressTimer);
  addressTimer = setTimeout(() => history.replaceState(null, "", `#${address()}`), 200);
}

function address() {
  const all = data.presets.length === state.presets.length && !state.isLarge;
  const of = key => {
    const values = viewers.map(viewer => viewer.sides.find(side => side.key === key).select.value);
    const whole = values.map((value, i) => value.includes("/") || shared().some(({ name }) => name === value) ? value : `${viewers[i].name}/${value}`);
    return [values, whole].find(list => unique(list).length === 1)?.[0] ?? values.join(",");
  };
  const parts = { frame: data.frames[state.frame].index, preset: all ? null : state.presets.join(","), large: state.isLarge ? 1 : null,
    mode: state.mode, divider: state.mode === "divider" ? Math.round(state.divider) : null,
    opacity: state.mode === "overlay" ? state.opacity : null, gain: state.mode === "difference" ? state.gain : null,
    flipped: state.mode === "flip" && state.isFlipped ? 1 : null,
    a: of("a"), b: of("b"), zoom: state.scale === null ? null : Number(state.scale.toFixed(3)),
    at: state.scale === null || !state.centre ? null : state.centre.map(value => value.toFixed(1)).join(",") };
  return Object.entries(parts).filter(([, value]) => value !== null).map(([name, value]) => `${name}=${value}`).join("&");
}

/* Takes what an address says; what it does not say, or says wrongly, stays. */
function takeAddress() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const number = (name, low, high) => {
    const value = Number.parseFloat(asked.get(name));
    return Number.isFinite(value) ? clamp(value, low, high) : null;
  };
  const frame = data.frames.findIndex(({ index }) => String(index) === asked.get("frame"));
  if (frame >= 0) state.frame = frame;
  const names = unique((asked.get("preset") ?? "").split(",")).filter(presetOf);
  if (names.length > 0) state.presets = names;
  state.isLarge = asked.get("large") === "1";
  if (asked.get("mode") in MODES) state.mode = asked.get("mode");
  state.isFlipped = asked.get("flipped") === "1";
  state.divider = number("divider", 0, 100) ?? state.divider;
  state.opacity = number("opacity", 0, 100) ?? state.opacity;
  state.gain = GAINS.find(gain => gain === number("gain", 1, 128)) ?? state.gain;
  state.scale = number("zoom", 0.01, 64);
  const place = (asked.get("at") ?? "").split(",").map(Number);
  state.centre = place.length === 2 && place.every(Number.isFinite) ? place : null;
  for (const key of ["a", "b"]) {
    const values = (asked.get(key) ?? "").split(",").filter(Boolean);
    viewers.forEach((viewer, i) => values.length > 0 && setSide(viewer, key, values[i] ?? values[0]));
    if (values.length > 1) at("link").checked = false;
  }
}

/* Keys do the same after whatever was clicked: a control that was used by a pointer does not keep them. */

const KEYS = { " ": play, ArrowLeft: () => go(state.frame - 1), ArrowRight: () => go(state.frame + 1), Home: () => go(0),
  End: () => go(data.frames.length - 1), d: () => setMode("divider"), f: () => setMode("flip"), o: () => setMode("overlay"),
  x: () => setMode("difference"), "[": () => turn(-1), "]": () => turn(1), 1: () => zoomTo(1), 0: () => zoomTo(null),
  "+": () => stepZoom(1), "=": () => stepZoom(1), "-": () => stepZoom(-1),
  l: () => enlarge(state.isLarge ? null : state.presets[0]), Escape: () => state.isLarge && enlarge(null) };
const PANS = { ArrowLeft: [-40, 0], ArrowRight: [40, 0], ArrowUp: [0, -40], ArrowDown: [0, 40] };

const turn = direction => setAmount(amount() + direction * (state.mode === "difference" ? 1 : 5));

document.addEventListener("keydown", event => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const control = event.target.closest?.("button, summary, input[type=checkbox]");
  if (control && (event.key === " " || event.key === "Enter")) return;
  const isSelect = event.target.closest?.("select");
  // A list is opened by space or Enter; arrows, and letters that are keys of the page, do not change it while it is closed.
  if (isSelect && [" ", "Enter"].includes(event.key)) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const action = event.shiftKey && PANS[event.key] ? () => pan(shownViewers()[0], ...PANS[event.key]) : KEYS[key];
  if (action) {
    event.preventDefault();
    action();
  } else if (isSelect && event.key.startsWith("Arrow")) {
    event.preventDefault();
  }
});
document.addEventListener("click", event => {
  const control = event.target.closest?.("button, summary, input");
  if (control && event.detail > 0) control.blur();
});
document.addEventListener("change", event => event.target.matches("select, input") && event.target.blur());

/* The page */

const viewers = data.presets.map(makeViewer);
at("viewers").append(...viewers.map(viewer => viewer.node));
document.querySelector("main").classList.toggle("single", !several);
at("link-label").hidden = !several;
at("shown").hidden = !several;
at("modes").append(...Object.entries(MODES).map(([mode, title]) => {
  const button = el("button", { type: "button", "data-mode": mode, title: `${title} (${mode === "difference" ? "X" : title[0]})` }, title);
  button.addEventListener("click", () => setMode(mode));
  return button;
}));
at("shown").append(...data.presets.map(({ report }) => {
  const button = el("button", { type: "button", title: "Show or hide this preset's pictures" }, report.preset);
  button.addEventListener("click", () => toggle(report.preset));
  return button;
}));
at("speed").append(...[[0.125, "1/8"], [0.25, "1/4"], [0.5, "1/2"], [1, "1"], [2, "2"]].map(([value, text]) =>
  el("option", { value, selected: value === 1 }, `\u00d7 ${text}`)));
at("amount-ramp").style.background = `linear-gradient(to right, ${errorRamp.map(color => `rgb(${color.join(" ")})`).join(", ")})`;
const [{ report }] = data.presets;
document.title = `${data.session || "Session"} \u2013 ${isFilm ? "film" : "replay"}`;
at("session").textContent = data.session || "Session without a name";
const nMoving = report.frames.filter(isMoving).length;
const sizes = `${frames(data.frames.length)} of ${data.size_px.join(" \u00d7 ")} px`;
at("facts").textContent = isFilm ? `${sizes}, ${length_secs.toFixed(2)} s`
  : `${sizes}, ${nMoving} moving, with ${data.presets.map(preset => preset.report.preset).join(", ")} on ${report.adapter}`;
at("software").hidden = !report.is_software;
at("frame").max = data.frames.length - 1;
at("frame").addEventListener("input", event => go(Number(event.target.value)));
at("amount").addEventListener("input", event => setAmount(Number(event.target.value)));
at("zoom").addEventListener("change", event => zoomTo(event.target.value === "fit" ? null : Number(event.target.value)));
at("play").addEventListener("click", play);
addEventListener("resize", placePictures);
addEventListener("hashchange", () => { takeAddress(); moveDivider(state.divider); show(); });
makeFit();
takeAddress();
moveDivider(state.divider);
show();
