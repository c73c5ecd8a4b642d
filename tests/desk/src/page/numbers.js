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

function showNumbers() {
  const heads = ["", ...data.presets.map(preset => preset.report.preset)];
  const title = el("h2", {}, "Error against the truth");
  if (!data.presets.some(preset => preset.report.mean.scores)) {
    at("numbers").replaceChildren(title, el("p", { class: "soft" }, "The session has no truth to compare with."));
    return;
  }
  const byRegion = scores => REGIONS.map(region =>
    row(region, scoreCells(data.presets.map(preset => scores(preset)?.[region] ?? null))));
  const flicker = pick => data.presets.some(pick) ? REGIONS.map(region =>
    row(region, data.presets.map(preset => pick(preset)?.[region].toFixed(2) ?? "\u2013"))) : null;
  const ofFrame = flicker(preset => entry(preset).flicker);
  const ofAll = flicker(preset => preset.report.mean.flicker);
  const nScored = data.presets[0].report.mean.n_scored;
  const everyFrame = data.frames.map(({ index }, i) => {
    const jump = el("button", { type: "button" }, `${index}`);
    jump.addEventListener("click", () => go(i));
    const scores = data.presets.map(preset => preset.report.frames[i].scores?.shadow ?? null);
    return row(jump, scoreCells(scores), { "aria-current": i === current ? "true" : null });
  });
  const wasOpen = at("numbers").querySelector("details")?.open ?? false;
  at("numbers").replaceChildren(title,
    el("p", { class: "soft" }, "Large: RMSE in codes of 255, lower is better. Small: SSIM, 1 is equal.",
      several ? " Bold: the best." : "",
      ofAll && " Flicker: RMSE of what changes from frame to frame, less what changes in the truth."),
    el("div", { class: "columns" },
      table(`Frame ${data.frames[current].index}`, heads, byRegion(preset => entry(preset).scores)),
      table(`Mean over ${nScored} frames`, heads, byRegion(preset => preset.report.mean.scores)),
      ofFrame && table("Flicker since the frame before", heads, ofFrame),
      ofAll && table("Mean flicker", heads, ofAll)),
    el("details", { open: wasOpen }, el("summary", {}, "Shadow, frame by frame"),
      table("Choose a number to go to its frame", ["frame", ...heads.slice(1)], everyFrame)));
}

/* Times */

const hue = name => [...name].reduce((sum, letter) => (sum * 31 + letter.charCodeAt(0)) % 360, 7);

/* The passes of this frame, each with the time that can be told to be its own. */
function passesOf(preset) {
  const { ran, pass_times } = entry(preset);
  return ran.map(run => ({ ...run,
    gpu_ms: pass_times.find(time => time.path === run.path && time.pass === run.pass)?.gpu_ms ?? null }));
}

function sumOf(passes) {
  return passes.reduce((sum, { gpu_ms }) => sum + (gpu_ms ?? 0), 0);
}

function bar(preset, path, longest) {
  const passes = passesOf(preset).filter(pass => pass.path === path);
  const parts = passes.map(({ pass, gpu_ms }) => {
    const label = `${pass} ${ms(gpu_ms)}`;
    const width = longest > 0 ? 100 * (gpu_ms ?? 0) / longest : 0;
    const style = `flex: 0 0 ${width}%; background: hsl(${hue(pass)} 55% 72%)`;
    return el("span", { title: label, style, class: width < 2 && "thin" }, el("i", {}, label));
  });
  const text = passes.length === 0 ? "did not run" : ms(sumOf(passes));
  return el("div", { class: "bar-row" }, el("div", {}, el("b", {}, preset.report.preset), el("div", {}, text)),
    el("div", { class: "bar", role: "img", "aria-label": `${preset.report.preset}: ${text}` }, parts));
}

function showTimes() {
  const tells = data.presets.some(preset => entry(preset).pass_times.length > 0);
  const groups = Object.entries(PATHS).map(([path, title]) => {
    const sums = data.presets.map(preset => sumOf(passesOf(preset).filter(pass => pass.path === path)));
    return el("div", {}, el("h2", {}, title), data.presets.map(preset => bar(preset, path, Math.max(...sums))));
  });
  const wasOpen = at("times").querySelector("details")?.open ?? false;
  const lists = data.presets.map(preset => table(preset.report.preset, ["pass", "path", "device time"], [
    ...passesOf(preset).map(({ pass, n_runs, path, gpu_ms }) => row(n_runs > 1 ? `${pass} × ${n_runs}` : pass, [path, ms(gpu_ms)])),
    row("on the processor", ["", ms(entry(preset).cpu_ms)]),
    row("until read back", ["", ms(entry(preset).wall_ms)])]));
  at("times").replaceChildren(
    tells ? el("div", { class: "columns" }, groups) : el("p", { class: "soft" }, "This device cannot time its passes."),
    el("details", { open: wasOpen }, el("summary", {}, "Every pass of this frame"),
      el("div", { class: "columns" }, lists)));
}

/* What alignment found: the same for all presets */

const mm = metres => `${(1e3 * metres).toFixed(2)} mm`;
const degrees = radians => `${radians === null ? "?" : (radians * 180 / Math.PI).toFixed(2)}\u00b0`;
const times = ratio => `\u00d7 ${ratio.toFixed(2)}`;

function showAlignment() {
  const alignment = entry(data.presets[0]).alignment;
  at("alignment").hidden = !alignment;
  if (!alignment) return;
  const { focal_length, world_scale, camera, pose, lights, probe, discovered, assumed, is_long, no_light, unexplained, is_relit, n_listed, cpu_ms,
    probe_against_listed, discovered_against_listed } = alignment;
  const verdict = found => found.is_held ? "as in a frame before" : found.is_applied || found.outcome === "corrected" ? "corrected" : "left as given";
  const rows = [];
  const { lens } = data.presets[0].report;
  if (lens) rows.push(row("the lens", [verdict(lens), `k1 ${lens.distortion.k1.toFixed(4)}, k2 ${lens.distortion.k2.toFixed(4)}`, lens.outcome]));
  for (const [name, found] of [["the focal length", focal_length], ["the world's scale", world_scale]]) {
    if (found) rows.push(row(name, [verdict(found), `\u00d7 ${found.ratio.toFixed(4)} \u00b1 ${found.deviation?.toFixed(4) ?? "?"}`, found.outcome]));
  }
  if (camera) rows.push(row("the camera", [verdict(camera), `${mm(camera.moved_m)}, ${degrees(camera.turned_rad)}`,
    `the table by ${camera.moved_px.toFixed(2)} px in the picture`]));
  if (pose) rows.push(row("the toy's pose", [verdict(pose), `${mm(pose.moved_m)}, ${degrees(pose.turned_rad)}`,
    `outline ${pose.given_outline_px.toFixed(2)} px off ${pose.is_held ? "as held" : "as given"}, ${pose.outline_px.toFixed(2)} px as found`]));
  const ratios = ({ distance_ratio, size_ratio }) => [distance_ratio && `distance ${times(distance_ratio)}`,
    size_ratio && `angular size ${times(size_ratio)}`].filter(Boolean);
  lights.forEach((light, i) => rows.push(row(`light ${i}`, [verdict(light), degrees(light.turned_rad), ratios(light).join(", ")])));
  const against = error => error ? [`light ${error.index} of the list: ${degrees(error.direction_rad)} off`, ...ratios(error)].join(", ") : "";
  (probe?.lights ?? []).forEach((light, i) => rows.push(row(`light ${i} of the probe`, [`told by ${light.n_views} of its pictures`,
    `${light.distance_m ? `${light.distance_m.toFixed(2)} m away` : "distance not told"}, direction \u00b1 ${degrees(light.seen.deviation_rad)}`,
    against(probe_against_listed[i])])));
  (probe?.rejected ?? []).forEach(({ at_px, reason }) => rows.push(row("no light of the probe",
    ["left out", `at ${at_px.map(at => at.toFixed(0)).join(", ")} px: ${reason}`, ""])));
  discovered.forEach((light, i) => rows.push(row(`light ${i}`, ["found by its shadow",
    `${(100 * light.share).toFixed(0)} % of the light, ${light.distance_m ? `${light.distance_m.toFixed(2)} m` : "far"} away, ${degrees(2 * light.angular_radius_rad)} wide, direction \u00b1 ${degrees(light.deviation.direction_rad)}`,
    against(discovered_against_listed[i])])));
  if (no_light) rows.push(row("lights", [probe?.lights.length ? "as the probe tells: no shadow shows them" : "none found", no_light, n_listed ? `${n_listed} on the list` : ""]));
  if (assumed) rows.push(row("a light", ["assumed", `${(100 * assumed.share).toFixed(0)} % of the light, far away and wide`,
    `explains ${(100 * assumed.explained).toFixed(0)} % of what light from all around leaves`]));
  if (is_long) rows.push(row("the light", ["long", "shown as a line of four round ones", ""]));
  if (unexplained !== null) rows.push(row("shadows in the picture", ["cast by the lights", `but for ${(100 * unexplained).toFixed(1)} %`,
    is_relit ? "the plates were taken in another light" : ""]));
  const hemisphere = entry(data.presets[0]).maps.find(map => map.name === "hemisphere");
  const searched = hemisphere ? [el("figure", {}, el("img", { src: data.presets[0].folder + hemisphere.file, alt: "Directions that a light was looked for in" }),
    el("figcaption", { class: "soft" }, "The hemisphere above the table, seen from above with the camera below: the brighter, the more of the shadow a light there explains. Yellow ring: found; red: listed."))] : [];
  at("alignment").replaceChildren(el("h2", {}, "Aligned by the picture"), ...searched,
    rows.length > 0 ? table(`took ${ms(cpu_ms)}`, ["", "", "found elsewhere by", ""], rows)
      : el("p", { class: "soft" }, "Too little of the toy's outline is seen to align anything."));
}

/* What was learned, what was skipped, what is odd */

function makeFit() {
  const fitted = data.presets.filter(preset => preset.report.fit);
  at("fit").hidden = fitted.length === 0;
  const rgb = color => color.map(value => value.toFixed(3)).join("  ");
  at("fit").replaceChildren(el("h2", {}, "Learned from the real shadow"), ...fitted.map(({ report }) =>
    table(report.preset, ["", "red  green  blue"], [
      row("gain: frame over plate", [rgb(report.fit.gain)]),
      row("bounce: light thrown back by the toy", [rgb(report.fit.bounce)]),
      ...report.fit.direct_fraction.map((fraction, i) => row(`f: fraction of light ${i} in the plate`, [rgb(fraction)]))])));
}

function showSkipped() {
  const lists = data.presets.map(preset => el("div", {}, el("b", {}, preset.report.preset),
    el("ul", {}, entry(preset).skipped.map(({ what, reason }) => el("li", {}, `${what}: ${reason}`)))));
  const wasOpen = at("skipped").querySelector("details")?.open ?? false;
  at("skipped").replaceChildren(el("details", { open: wasOpen, style: "margin: 0" },
    el("summary", {}, "Work left out of this frame, and why"), el("div", { class: "columns" }, lists)));
}

function showWarnings() {
  const tell = warnings => data.presets.flatMap(preset => warnings(preset).map(text => [text, preset.report.preset]));
  const ofFrame = preset => [...entry(preset).session_warnings, ...entry(preset).alignment?.warnings ?? [], ...entry(preset).warnings];
  const all = [...tell(preset => preset.report.warnings), ...tell(ofFrame)];
  at("warnings").replaceChildren(...unique(all.map(([text]) => text)).map(text => {
    const presets = unique(all.filter(([other]) => other === text).map(([, preset]) => preset));
    const whose = presets.length < data.presets.length ? `${presets.join(", ")}: ` : "";
    return el("p", { class: "note" }, `Warning: ${whose}${text}`);
  }));
}

