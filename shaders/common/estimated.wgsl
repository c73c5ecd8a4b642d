// The mark of an estimate in a plate.

// Alpha of an estimated pixel: it marks the pixel as such, and is its weight in the fit.
const ESTIMATED: f32 = 0.25;
