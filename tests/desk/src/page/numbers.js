/* Numbers */

function table(caption, heads, rows) {
  const header = el("thead", {}, el("tr", {}, heads.map(head => el("th", { scope: "col" }, head))));
  return el("div", { class: "scroll" }, el("table", {}, el("caption", {}, caption), header, el("tbody", {}, rows)));
}

function row(head, cells, attributes = {}) {
  return el("tr", attributes, el("th", { scope: "row" }, head), cells.map(cell => el("td", {}, cell)));
}

/* RMSE over SSIM, each preset beside the others; the best of several in bold. */
function scoreCells(scores) {
  const rounded = (score, key, digits) => score && score[key].toFixed(digits);
  const best = (key, digits, pick) => pick(...scores.filter(Boolean).map(score => Number(rounded(score, key, digits))));
  const mark = (text, isBest) => several && isBest ? el("b", {}, text) : text;
  const lowest = best("rmse", 2, Math.min);
  const highest = best("ssim", 4, Math.max);
  return scores.map(score => score === null ? "\u2013" : [
    mark(rounded(score, "rmse", 2), Number(rounded(score, "rmse", 2)) === lowest),
    el("small", {}, mark(rounded(score, "ssim", 4), Number(rounded(score, "ssim", 4)) === highest)),
  ]);
}

const FLOOR_WORDS = "Floor: RMSE of the camera frame against the truth beyond both shadows, where the two show the same: "
  + "the noise of both and rounding. A picture made of that frame is not expected to come below it there.";

function showNumbers() {
  const heads = ["", ...data.presets.map(preset => preset.report.preset)];
  const title = el("h2", {}, "Error against the truth");
  const means = data.presets.map(preset => preset.report.mean_of_moving);
  at("numbers").hidden = isFilm && !means[0].scores;
  if (!data.presets.some(preset => preset.report.mean.scores)) {
    at("numbers").replaceChildren(title, el("p", { class: "soft" }, "The session has no truth to compare with."));
    return;
  }
  const byRegion = scores => REGIONS.map(region => row(region, scoreCells(scores.map(of => of?.[region] ?? null))));
  const floor = values => values.some(value => (value ?? null) !== null)
    ? [row("floor", values.map(value => value?.toFixed(2) ?? "\u2013"), { class: "floor" })] : [];
  const flicker = all => all.some(Boolean)
    ? REGIONS.map(region => row(region, all.map(of => of?.[region].toFixed(2) ?? "\u2013"))) : null;
  const ofFrame = flicker(data.presets.map(preset => entry(preset).flicker));
  const ofAll = flicker(means.map(of => of.flicker));
  const [first] = data.presets;
  const passed = first.report.frames.filter(frame => !isMoving(frame)).map(frame => frame.index);
  const left = passed.length === 0 ? "" : `; without ${passed.length > 1 ? "frames" : "frame"} ${listed(passed)}, passed through as the camera saw it`;
  const everyFrame = data.frames.map(({ index }, i) => {
    const jump = el("button", { type: "button" }, `${index}`);
    jump.addEventListener("click", () => go(i));
    const scores = data.presets.map(preset => preset.report.frames[i].scores?.shadow ?? null);
    return row(jump, scoreCells(scores), { "aria-current": i === state.frame ? "true" : null });
  });
  const own = entry(first);
  const wasOpen = at("numbers").querySelector("details")?.open ?? false;
  at("numbers").replaceChildren(title,
    el("p", { class: "soft" }, "Large: RMSE in codes of 255, lower is better. Small: SSIM, 1 is equal.",
      several ? " Bold: the best." : "",
      ofAll && " Flicker: RMSE of what changes from frame to frame, less what changes in the truth.",
      means.some(of => (of.floor_rmse ?? null) !== null) && ` ${FLOOR_WORDS}`),
    el("div", { class: "columns" },
      means.some(of => of.scores) && table(`Mean over ${frames(means[0].n_scored, "moving ")}${left}`, heads,
        [...byRegion(means.map(of => of.scores)), ...floor(means.map(of => of.floor_rmse))]),
      table(`Frame ${own.index}${isMoving(own) ? "" : ": passed through"}`, heads,
        [...byRegion(data.presets.map(preset => entry(preset).scores)), ...floor(data.presets.map(preset => entry(preset).floor_rmse))]),
      ofAll && table("Mean flicker", heads, ofAll),
      ofFrame && table("Flicker since the frame before", heads, ofFrame)),
    el("details", { open: wasOpen }, el("summary", {}, "Shadow, frame by frame"), curves(),
      table("Choose a number to go to its frame", ["frame", ...heads.slice(1)], everyFrame)));
}
const frames = (n, kind = "") => `${n} ${kind}${n === 1 ? "frame" : "frames"}`;
const listed = list => list.length > 8 ? `${list.slice(0, 8).join(", ")} and ${list.length - 8} more` : list.join(", ");

/* Error over time: a line for each preset, broken where frames were passed through; a click goes to the frame there. */
const LINES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
const errorOf = frame => isMoving(frame) ? frame.scores?.shadow.rmse ?? null : null;
function curves() {
  const n = data.frames.length;
  const highest = Math.max(...data.presets.flatMap(({ report }) => report.frames.map(frame => errorOf(frame) ?? 0)));
  if (n < 3 || highest === 0) return null;
  const [width, height] = [1000, 160];
  const x = i => width * (i + 0.5) / n;
  const y = value => height - 4 - (height - 8) * value / highest;
  const path = ({ report }) => report.frames.map((frame, i) => {
    const value = errorOf(frame);
    if (value === null) return "";
    const isFirst = i === 0 || errorOf(report.frames[i - 1]) === null;
    return `${isFirst ? "M" : "L"}${x(i).toFixed(1)} ${y(value).toFixed(1)}${isFirst ? "h.1" : ""}`;
  }).join("");
  const lines = data.presets.map((preset, i) => draw("path", { d: path(preset), fill: "none", stroke: LINES[i % LINES.length],
    "stroke-width": 2.5, "stroke-linecap": "round", "vector-effect": "non-scaling-stroke" }));
  const here = draw("path", { d: `M${x(state.frame)} 0V${height}`, stroke: "currentColor", "stroke-dasharray": "3 3", "vector-effect": "non-scaling-stroke" });
  const chart = draw("svg", { class: "curves", viewBox: `0 0 ${width} ${height}`, preserveAspectRatio: "none", role: "img",
    "aria-label": "RMSE of the shadow over time" }, here, lines);
  chart.addEventListener("click", event => {
    const box = chart.getBoundingClientRect();
    go(clamp(Math.floor(n * (event.clientX - box.left) / box.width), 0, n - 1));
  });
  const names = data.presets.map(({ report }, i) =>
    el("span", {}, el("i", { class: "swatch", style: `background: ${LINES[i % LINES.length]}` }), report.preset));
  return el("figure", {}, el("figcaption", { class: "soft" }, `RMSE of the shadow from 0 to ${highest.toFixed(1)} codes, over frames `
    + `${data.frames[0].index} to ${data.frames[n - 1].index}. A click goes to the frame there.`, el("div", { class: "swatches" }, names)), chart);
}
