// Mark of a pixel that shows one surface of the toy, mixed with another one by the picture's spread.
//
// Its colour is no paint's: a picture that is 5 px of a motion or 2 px of defocus soft tells a tint best
// if such a pixel counts as a sixteenth. The toy's error then was 7.66 for 7.86 codes (heron, 60
// degrees), 6.69 for 6.78 (0 degrees), 27.2 for 31.3 (heron out of focus); 5.39 for 5.37 (figure). If it also
// counts as a sixteenth of a pixel, the figure has 5.66.

const MIXED: f32 = 16.0 / 255.0;
