/* Frames */

function show() {
  const { index } = data.frames[current];
  const [preset] = data.presets;
  at("frame").value = current;
  at("frame-name").textContent = `Frame ${index}, at ${entry(preset).time_secs.toFixed(2)} s`;
  viewers.forEach(showViewer);
  [showNumbers, showTimes, showAlignment, showSkipped, showWarnings].forEach(part => part());
}

function go(frame) {
  current = (frame + data.frames.length) % data.frames.length;
  show();
}

let timer = null;
function play() {
  clearInterval(timer);
  timer = timer === null ? setInterval(() => go(current + 1), 400) : null;
  at("play").textContent = timer === null ? "Play" : "Pause";
  at("play").setAttribute("aria-pressed", timer !== null);
}

const viewers = data.presets.map(makeViewer);
at("viewers").append(...viewers.map(viewer => viewer.node));
document.querySelector("main").classList.toggle("single", !several);
at("link-label").hidden = !several;
const [{ report }] = data.presets;
document.title = `${data.session || "Session"} \u2013 replay`;
at("session").textContent = data.session || "Session without a name";
at("facts").textContent = `${data.frames.length} frames of ${data.size_px.join(" \u00d7 ")} px with `
  + `${data.presets.map(preset => preset.report.preset).join(", ")} on ${report.adapter}`;
at("software").hidden = !report.is_software;
at("frame").max = data.frames.length - 1;
at("frame").addEventListener("input", event => go(Number(event.target.value)));
at("zoom").addEventListener("change", () => pan(0, 0));
at("play").addEventListener("click", play);
document.addEventListener("keydown", event => {
  if (event.target.closest("input, select, button, summary") || event.ctrlKey || event.metaKey || event.altKey) return;
  const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  const shift = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
  if (event.shiftKey && shift) pan(...shift);
  else if (step) go(current + step);
  else if (event.key === " ") play();
  else return;
  event.preventDefault();
});
makeFit();
moveDivider(divider);
pan(0, 0);
show();
