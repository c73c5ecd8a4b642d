// How covered positions of a pixel are counted.

const N_POSITIONS: u32 = 32u;
// What each adds, in codes of eight bits, into which all positions fit.
const COVERED_CODES: u32 = 7u;
const COVERED_POSITION: f32 = f32(COVERED_CODES) / 255.0;
