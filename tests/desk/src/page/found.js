/* What alignment found: the same for all presets */

const mm = metres => `${(1e3 * metres).toFixed(2)} mm`;
const degrees = radians => `${radians === null ? "?" : (radians * 180 / Math.PI).toFixed(2)}\u00b0`;
const times = ratio => `\u00d7 ${ratio.toFixed(2)}`;

function showAlignment() {
  const alignment = entry(data.presets[0]).alignment;
  at("alignment").hidden = !alignment;
  if (!alignment) return;
  const { focal_length, world_scale, camera, pose, lights, probe, discovered, assumed, is_long, no_light, unexplained, is_relit, planes, n_listed, cpu_ms,
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
  planes.forEach(({ height_m, tilt_rad, half_extent_m }) => rows.push(row("a plane", ["found by the shadow on it",
    `${(1e3 * height_m).toFixed(0)} mm above the receiver, tilted by ${degrees(tilt_rad)}`,
    half_extent_m.map(half => (200 * half).toFixed(0)).join(" x ") + " cm"])));
  const ratios = ({ distance_ratio, size_ratio }) => [distance_ratio && `distance ${times(distance_ratio)}`,
    size_ratio && `angular size ${times(size_ratio)}`].filter(Boolean);
  lights.forEach((light, i) => rows.push(row(`light ${i}`, [verdict(light), degrees(light.turned_rad), ratios(light).join(", ")])));
  const against = error => error ? [`light ${error.index} of the list: ${degrees(error.direction_rad)} off`, ...ratios(error)].join(", ") : "";
  (probe?.lights ?? []).forEach((light, i) => rows.push(row(`light ${i} of the probe`, [`seen in ${light.n_views} of its pictures`,
    `${light.distance_m ? `${light.distance_m.toFixed(2)} m away` : "distance unknown"}, direction \u00b1 ${degrees(light.seen.deviation_rad)}`,
    against(probe_against_listed[i])])));
  (probe?.rejected ?? []).forEach(({ at_px, reason }) => rows.push(row("no light of the probe",
    ["left out", `at ${at_px.map(at => at.toFixed(0)).join(", ")} px: ${reason}`, ""])));
  discovered.forEach((light, i) => rows.push(row(`light ${i}`, ["found by its shadow",
    `${(100 * light.share).toFixed(0)} % of the light, ${light.distance_m ? `${light.distance_m.toFixed(2)} m` : "far"} away, ${degrees(2 * light.angular_radius_rad)} wide, direction \u00b1 ${degrees(light.deviation.direction_rad)}`,
    against(discovered_against_listed[i])])));
  if (no_light) rows.push(row("lights", [probe?.lights.length ? "as the probe shows: no shadow shows them" : "none found", no_light, n_listed ? `${n_listed} on the list` : ""]));
  if (assumed) rows.push(row("a light", ["assumed", `${(100 * assumed.share).toFixed(0)} % of the light, far away and wide`,
    `explains ${(100 * assumed.explained).toFixed(0)} % of the error with ambient light alone`]));
  if (is_long) rows.push(row("the light", ["long", "shown as a line of four round ones", ""]));
  if (unexplained !== null) rows.push(row("shadows in the picture", ["cast by the lights", `but for ${(100 * unexplained).toFixed(1)} %`,
    is_relit ? "the plates were taken in another light" : ""]));
  // Drawn in the first frame of a search alone, whose lights the frames after it have.
  const upToNow = discovered.length > 0 ? data.presets[0].report.frames.slice(0, state.frame + 1) : [];
  const hemisphere = upToNow.flatMap(frame => frame.maps.filter(map => map.name === "hemisphere")).pop();
  const searched = hemisphere ? [el("figure", {}, el("img", { src: data.presets[0].folder + hemisphere.file, alt: "Directions that a light was looked for in" }),
    el("figcaption", { class: "soft" }, "The hemisphere above the table, seen from above with the camera below: the brighter, the more of the shadow a light there explains. Yellow ring: found; red: listed."))] : [];
  at("alignment").replaceChildren(el("h2", {}, "Aligned by the picture"), ...searched,
    rows.length > 0 ? table(`Alignment took ${ms(cpu_ms)}`, ["", "", "difference from what was given", ""], rows)
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
  at("skipped").hidden = isFilm;
  if (isFilm) return;
  const lists = data.presets.map(preset => el("div", {}, el("b", {}, preset.report.preset),
    el("ul", {}, entry(preset).skipped.map(({ what, reason }) => el("li", {}, `${what}: ${reason}`)))));
  const wasOpen = at("skipped").querySelector("details")?.open ?? false;
  at("skipped").replaceChildren(el("details", { open: wasOpen, style: "margin: 0" },
    el("summary", {}, isMoving(entry(data.presets[0])) ? "Work left out of this frame, and why" : "This frame was passed through, and why"), el("div", { class: "columns" }, lists)));
}

function showWarnings() {
  const tell = warnings => data.presets.flatMap(preset => warnings(preset).map(text => [text, preset.report.preset]));
  const ofFrame = preset => [entry(preset).session_warnings, entry(preset).alignment?.warnings, entry(preset).warnings].flatMap(list => list ?? []);
  const all = [...tell(preset => preset.report.warnings), ...tell(ofFrame)];
  at("warnings").replaceChildren(...unique(all.map(([text]) => text)).map(text => {
    const presets = unique(all.filter(([other]) => other === text).map(([, preset]) => preset));
    const whose = presets.length < data.presets.length ? `${presets.join(", ")}: ` : "";
    return el("p", { class: "note" }, `Warning: ${whose}${text}`);
  }));
}


/* What the frame is made of; of a replay, why it was passed through. Its line stays if another frame has words. */
function wordsOf(frame) {
  const passed = isMoving(frame) ? [] : [`Passed through as the camera saw it: ${frame.skipped[0]?.reason ?? "no reason was given"}.`];
  return frame.words ?? passed;
}

function showWords() {
  const [one] = data.presets;
  at("words").hidden = one.report.frames.every(frame => wordsOf(frame).length === 0);
  at("words").textContent = wordsOf(entry(one)).join(" \u00b7 ");
}
