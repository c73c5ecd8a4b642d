/* Times: a steady frame first, since that is what each frame costs in the long run; the first frame apart. */

/* Every pass has its colour on the whole page: neighbours in the order of work are far apart in hue, and differ in lightness. */
const passNames = unique(data.presets.flatMap(preset => preset.report.frames.flatMap(frame => (frame.ran ?? []).map(run => run.pass))));
function colorOf(pass) {
  const index = passNames.indexOf(pass);
  return `hsl(${(index * 137.5) % 360} ${index % 2 ? 45 : 75}% ${[58, 74, 84][index % 3]}%)`;
}

/* The passes of one frame, each with the time that is its own; none if the device cannot time it. */
function passesOf({ ran, pass_times }) {
  return ran.map(run => ({ ...run,
    gpu_ms: pass_times.find(time => time.path === run.path && time.pass === run.pass)?.gpu_ms ?? null }));
}
const sumOf = passes => sum(passes.map(({ gpu_ms }) => gpu_ms ?? 0));

/* The mean of several frames, pass by pass; one that did not run counts as nothing. */
function meanPasses(list) {
  const runs = list.map(passesOf);
  return unique(runs.flat().map(run => run.pass)).map(pass => {
    const own = runs.flat().filter(run => run.pass === pass);
    const isTimed = own.some(run => run.gpu_ms !== null);
    return { ...own[0], gpu_ms: isTimed ? sum(own.map(run => run.gpu_ms ?? 0)) / list.length : null };
  });
}

function bar(name, passes, longest, note) {
  const total = sumOf(passes);
  const parts = passes.map(({ pass, gpu_ms }) => el("span", { title: `${pass} ${ms(gpu_ms)}`,
    style: `flex: 0 0 ${longest > 0 ? 100 * (gpu_ms ?? 0) / longest : 0}%; background: ${colorOf(pass)}` }));
  const labels = passes.filter(pass => pass.gpu_ms !== null).sort((a, b) => b.gpu_ms - a.gpu_ms)
    .map(({ pass, gpu_ms }) => el("span", {}, el("i", { class: "swatch", style: `background: ${colorOf(pass)}` }), `${pass} ${ms(gpu_ms)}`));
  return el("div", { class: "bar-row" }, el("div", {}, el("b", {}, name), ` ${ms(total)}`, el("span", { class: "soft" }, note)),
    el("div", { class: "bar", role: "img", "aria-label": `${name}: ${ms(total)}` }, parts), el("div", { class: "swatches" }, labels));
}

/* Bars of all presets to one measure; those that have nothing to show are named in one line. */
function bars(title, words, of) {
  const all = data.presets.map(preset => ({ name: preset.report.preset, ...of(preset) }));
  const shown = all.filter(({ passes }) => passes.length > 0);
  const idle = all.filter(({ passes }) => passes.length === 0).map(({ name }) => name);
  const longest = Math.max(...shown.map(({ passes }) => sumOf(passes)), 0);
  return el("div", {}, el("h2", {}, title), el("p", { class: "soft" }, words),
    shown.map(({ name, passes, note }) => bar(name, passes, longest, note)),
    idle.length > 0 && el("p", { class: "soft" }, `Nothing ran with ${idle.join(", ")}.`));
}

const processor = of => of.cpu_ms === null ? "" : `, ${ms(of.cpu_ms)} on the processor, ${ms(of.wall_ms)} until read back`;

function showTimes() {
  at("times").hidden = isFilm;
  if (isFilm) return;
  const tells = data.presets.some(preset => preset.report.frames.some(frame => frame.pass_times.length > 0));
  const [one] = data.presets;
  const steady = one.report.mean.n_steady > 0 && bars("A steady frame",
    `Device time by pass, mean over ${frames(one.report.mean.n_steady)} that ${one.report.mean.n_steady === 1 ? "moves" : "move"} and in which nothing was learned anew.`,
    ({ report }) => ({ passes: meanPasses(report.frames.filter(isSteady)), note: processor(report.mean) }));
  const start = one.report.frames.findIndex(isMoving);
  const first = start >= 0 && bars("The first frame that moves",
    `Frame ${one.report.frames[start].index}: it also learns from the real shadow (the capture path, once in a place) and may wait for shaders to be compiled.`,
    ({ report }) => ({ passes: passesOf(report.frames[start]), note: processor(report.frames[start]) }));
  const wasOpen = at("times").querySelector("details")?.open ?? false;
  const lists = data.presets.map(preset => table(preset.report.preset, ["pass", "path", "device time"], [
    ...passesOf(entry(preset)).map(({ pass, n_runs, path, gpu_ms }) => row(n_runs > 1 ? `${pass} \u00d7 ${n_runs}` : pass, [path, ms(gpu_ms)])),
    row("on the processor", ["", ms(entry(preset).cpu_ms)]),
    row("until read back", ["", ms(entry(preset).wall_ms)])]));
  const untimed = data.presets.map(({ report }) => row(report.preset, [ms(report.mean.cpu_ms), ms(report.mean.wall_ms),
    ms(report.frames[Math.max(start, 0)].wall_ms)]));
  at("times").replaceChildren(
    tells ? el("div", { class: "columns" }, [steady, first])
      : table("This device cannot time its passes. Means are over steady frames.",
        ["", "on the processor", "until read back", "first frame, until read back"], untimed),
    el("details", { open: wasOpen }, el("summary", {}, `Every pass of frame ${entry(one).index}`),
      el("div", { class: "columns" }, lists)));
}
