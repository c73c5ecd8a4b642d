// Mark of a pixel that shows one surface of the toy, mixed with another one by the picture's spread.
//
// Its colour is no paint's. In a picture that is 5 px of a motion or 2 px of defocus soft, the toy's error is
// 7.66 codes if such a pixel counts as a sixteenth, 7.86 if it counts in full (heron, 60 degrees); 6.69 and
// 6.78 (0 degrees); 27.2 and 31.3 (heron out of focus); 5.39 and 5.37 (figure). Other weights were not tried.
// If it also counts as a sixteenth of a pixel, the figure has 5.66.

const MIXED: f32 = 16.0 / 255.0;
