"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const REGIONS = ["shadow", "toy", "edge", "frame"];
const at = id => document.getElementById(id);
const several = data.presets.length > 1;
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
const unique = list => [...new Set(list)];
const sum = list => list.reduce((total, value) => total + value, 0);
const mean = list => list.length > 0 ? sum(list) / list.length : null;
const ms = value => value === null ? "\u2013" : `${value < 10 ? value.toFixed(2) : value.toFixed(1)} ms`;

/* An element with its attributes and children; text is never read as HTML. */
function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.flat(2).filter(child => child !== null && child !== undefined && child !== false));
  return node;
}

/* The same of a drawing. */
const DRAWING = ["http", "www.w3.org/2000/svg"].join("://");
function draw(tag, attributes, ...children) {
  const node = document.createElementNS(DRAWING, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children.flat());
  return node;
}

/* Of a film there are pictures, words and errors; of a replay there are times, too, and what was found. */
const isFilm = Boolean(data.is_film);
/* Frames that were worked on; the others are the camera frame as it is. */
const isMoving = frame => isFilm || Boolean(frame.region);
const isSteady = frame => isMoving(frame) && !isFilm && frame.ran.every(run => run.path !== "capture");
/* The order of work puts the project's own presets before the ones that it is compared with. */
const LAST = ["paper", "flat"];
const place = preset => LAST.indexOf(preset.report.preset);
data.presets.sort((a, b) => place(a) - place(b));

/* What is shown now: the page's whole state, which its address keeps. */
const state = {
  frame: firstShown(),
  presets: data.presets.map(preset => preset.report.preset),
  isLarge: false,
  mode: "divider",
  divider: 50,
  opacity: 50,
  gain: 8,
  isFlipped: false,
  scale: null,
  centre: null,
};

/* A steady frame that moves, or else one that moves at all. */
function firstShown() {
  const [{ report }] = data.presets;
  const find = test => report.frames.findIndex(test);
  return [find(isSteady), find(isMoving), 0].find(index => index >= 0);
}
const entry = preset => preset.report.frames[state.frame];
const presetOf = name => data.presets.find(preset => preset.report.preset === name);
