/* Where the pictures are seen from: one zoom and one place for all viewers. `state.scale` is screen pixels a picture pixel, none
   fits the picture into its stage; `state.centre` is the picture pixel in the middle of the stage. */

const SCALES = [1, 2, 4, 8, 16];
const [WIDTH, HEIGHT] = data.size_px;
const pixelRatio = () => window.devicePixelRatio || 1;
const sizeOf = stage => [stage.clientWidth * pixelRatio(), stage.clientHeight * pixelRatio()];

/* The scale that fits the picture into a stage. */
function fitting(stage) {
  const [width, height] = sizeOf(stage);
  return Math.min(width / WIDTH, height / HEIGHT);
}
const scaleIn = stage => state.scale ?? fitting(stage);

/* The centre that shows no more of what is beyond the picture than must be. */
function held(centre, scale, stage) {
  return [0, 1].map(i => {
    const half = sizeOf(stage)[i] / scale / 2;
    const size = data.size_px[i];
    return 2 * half >= size ? size / 2 : clamp(centre[i], half, size - half);
  });
}

/* The middle of what was worked on. */
function middle() {
  const region = data.presets.flatMap(preset => preset.report.frames).find(frame => frame.region)?.region;
  return [0, 1].map(i => region ? region.origin_px[i] + region.size_px[i] / 2 : data.size_px[i] / 2);
}

/* Left top corner of the picture in a stage, in whole screen pixels, so that a picture pixel is exactly so many of them. */
function corner(stage, scale) {
  const centre = held(state.centre ?? middle(), scale, stage);
  const box = stage.getBoundingClientRect();
  return [0, 1].map(i => {
    const start = (i === 0 ? box.left + scrollX : box.top + scrollY) * pixelRatio();
    const own = sizeOf(stage)[i] / 2 - scale * centre[i];
    return (Math.round(start + own) - start) / pixelRatio();
  });
}

function placePictures() {
  for (const viewer of viewers) {
    if (viewer.node.hidden) continue;
    const scale = scaleIn(viewer.stage);
    const [left, top] = corner(viewer.stage, scale);
    viewer.place = { left, top, step: scale / pixelRatio() };
    for (const side of viewer.sides) {
      Object.assign(side.image.style, { left: `${left}px`, top: `${top}px`,
        width: `${WIDTH * scale / pixelRatio()}px`, height: `${HEIGHT * scale / pixelRatio()}px` });
    }
    viewer.stage.classList.toggle("close", state.scale !== null && state.scale >= 1);
    viewer.stage.classList.toggle("fits", state.scale === null || state.scale <= fitting(viewer.stage));
  }
  const exact = state.scale === null ? "fit" : SCALES.includes(state.scale) ? String(state.scale) : "free";
  at("zoom").value = exact;
  at("zoom").querySelector("[value=free]").textContent = exact === "free" ? `${state.scale.toFixed(2)}:1` : "other";
}

/* The place in the picture under a point of the window, in pixels, not rounded. */
function inPicture(viewer, x, y) {
  const box = viewer.stage.getBoundingClientRect();
  return [(x - box.left - viewer.place.left) / viewer.place.step, (y - box.top - viewer.place.top) / viewer.place.step];
}

/* Zooms so that what lies under a point of the window stays there; without one, about the middle of the stage. */
function zoomTo(scale, viewer = shownViewers()[0], point = null) {
  const fit = fitting(viewer.stage);
  const box = viewer.stage.getBoundingClientRect();
  const [x, y] = point ?? [box.left + box.width / 2, box.top + box.height / 2];
  const fixed = inPicture(viewer, x, y);
  if (scale !== null && scale <= Math.min(fit, 1)) scale = fit <= 1 || scale < 1 ? null : scale;
  if (scale !== null) scale = Math.min(scale, 64);
  const away = [x - box.left - box.width / 2, y - box.top - box.height / 2];
  if (scale !== null) {
    const centre = fixed.map((value, i) => value - away[i] * pixelRatio() / scale);
    state.centre = held(state.scale === null && point === null ? middle() : centre, scale, viewer.stage);
  }
  state.scale = scale;
  placePictures();
  keepAddress();
}

/* The next scale of the list, or "fit" below the first. */
function stepZoom(direction) {
  const now = scaleIn(shownViewers()[0].stage);
  const next = direction > 0 ? SCALES.find(scale => scale > now * 1.01) : SCALES.findLast(scale => scale < now * 0.99);
  if (next || direction < 0) zoomTo(next ?? null);
}

/* Moves what is seen by so many CSS pixels. */
function pan(viewer, x, y) {
  const scale = scaleIn(viewer.stage);
  const centre = held(state.centre ?? middle(), scale, viewer.stage);
  state.centre = held([centre[0] + x * pixelRatio() / scale, centre[1] + y * pixelRatio() / scale], scale, viewer.stage);
  placePictures();
  keepAddress();
}

/* Whether there is more of the picture than the stage shows. */
const isZoomed = viewer => state.scale !== null && state.scale > fitting(viewer.stage) * 1.001;

/* Pointers on a stage: one drags the divider, or a picture that is larger than its stage; two zoom. A wheel zooms. */
function listen(viewer) {
  const { stage, handle } = viewer;
  const down = new Map();
  let task = null;
  let start = null;
  const spread = () => {
    const [a, b] = [...down.values()];
    return { distance: Math.hypot(a[0] - b[0], a[1] - b[1]), middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] };
  };
  const dragDivider = event => {
    const box = stage.getBoundingClientRect();
    moveDivider(100 * (event.clientX - box.left) / box.width);
  };
  /* A finger that goes up or down scrolls the page, and shall not take the divider along. */
  const isMeant = event => event.pointerType !== "touch" || event.target === handle || Math.abs(event.clientX - start[0]) > 8;
  const release = event => {
    down.delete(event.pointerId);
    task = down.size === 0 ? null : task === "pinch" ? "pan" : task;
  };
  stage.addEventListener("pointerdown", event => {
    if (event.button !== 0) return;
    // The focus stays where it is: arrow keys go on to change the frame.
    event.preventDefault();
    if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
    stage.setPointerCapture(event.pointerId);
    down.set(event.pointerId, [event.clientX, event.clientY]);
    const onHandle = event.target === handle;
    task = down.size > 1 ? "pinch" : state.mode === "divider" && (onHandle || !isZoomed(viewer)) ? "divider" : "pan";
    start = [event.clientX, event.clientY];
    if (task === "divider" && isMeant(event)) dragDivider(event);
    point(pixelUnder(viewer, event));
  });
  stage.addEventListener("pointermove", event => {
    point(pixelUnder(viewer, event));
    const before = down.get(event.pointerId);
    if (!before) return;
    const old = down.size > 1 ? spread() : null;
    down.set(event.pointerId, [event.clientX, event.clientY]);
    if (task === "divider") {
      if (isMeant(event)) dragDivider(event);
    } else if (task === "pan") pan(viewer, before[0] - event.clientX, before[1] - event.clientY);
    else if (old) {
      const now = spread();
      pan(viewer, old.middle[0] - now.middle[0], old.middle[1] - now.middle[1]);
      zoomTo(scaleIn(stage) * now.distance / Math.max(old.distance, 1), viewer, now.middle);
    }
  });
  stage.addEventListener("pointerup", release);
  stage.addEventListener("pointercancel", release);
  stage.addEventListener("pointerleave", event => event.pointerType === "mouse" && point(null));
  stage.addEventListener("wheel", event => {
    // A picture that fits already leaves the wheel to the page.
    if (state.scale === null && event.deltaY > 0) return;
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : 1);
    zoomTo(scaleIn(stage) * Math.exp(-clamp(pixels, -200, 200) * (event.ctrlKey ? 0.01 : 0.003)), viewer, [event.clientX, event.clientY]);
  }, { passive: false });
  handle.addEventListener("keydown", event => {
    const step = { ArrowLeft: -2, ArrowDown: -2, ArrowRight: 2, ArrowUp: 2, Home: -100, End: 100 }[event.key];
    if (!step || event.shiftKey) return;
    event.preventDefault();
    event.stopPropagation();
    moveDivider(state.divider + step);
  });
}

/* The pixel under a pointer; none beside the picture. */
function pixelUnder(viewer, event) {
  const pixel = inPicture(viewer, event.clientX, event.clientY).map(Math.floor);
  return pixel.every((value, i) => value >= 0 && value < data.size_px[i]) ? pixel : null;
}

function moveDivider(percent) {
  state.divider = clamp(percent, 0, 100);
  for (const viewer of viewers) {
    viewer.stage.style.setProperty("--at", `${state.divider}%`);
    viewer.handle.setAttribute("aria-valuenow", Math.round(state.divider));
  }
  keepAddress();
}
