// A receiver without known lights: whether the toy casts a shadow of the ambient light, and the
// other unknowns of the fit if it does not.

//#import common/fit
//#import common/fit_step

// Part of the difference between frame and plate that a shadow of the ambient light must explain.
// Measured: under two overcast skies .6 and more, in an office's wide light .02 to .03, under one
// lamp .3 to .6.
const LEAST_EXPLAINED: f32 = 0.1;

// Square of the plate, from sums of the remaining and of the hidden ambient light.
fn squares_of_plate() -> f32 {
  return matrix[0] + 2.0 * matrix[1] + matrix[N_COLUMNS + 1u];
}

// Whether a shadow of the ambient light explains enough of the difference between frame and plate:
// in squares, over all channels, and after fitting the gain. A frame that is brighter below the toy
// excludes one.
fn is_ambient_shadow_known() -> bool {
  var left = 0.0;
  var explained = 0.0;
  for (var channel = 0u; channel < 3u; channel++) {
    load_equations(channel, 1u);
    // Sums of products of the plate, of the loss by an ambient shadow of full strength, and of the
    // difference.
    let first = UNSHADED_COLUMN * N_COLUMNS;
    let plate_plate = squares_of_plate();
    if plate_plate <= 0.0 { continue; }
    let plate_taken = matrix[1] + matrix[N_COLUMNS + 1u];
    let plate_beside = matrix[first] + matrix[first + 1u];
    let taken_taken = matrix[N_COLUMNS + 1u] - plate_taken * plate_taken / plate_plate;
    let taken_beside = matrix[first + 1u] - plate_taken * plate_beside / plate_plate;
    left += matrix[first + UNSHADED_COLUMN] - plate_beside * plate_beside / plate_plate;
    let darker = min(taken_beside, 0.0);
    if taken_taken > 0.0 { explained += darker * darker / taken_taken; }
  }
  return explained > LEAST_EXPLAINED * left;
}

// Solution that is as bright below the toy as in the open.
fn solve_unshadowed(channel: u32) {
  load_equations(channel, 1u);
  let plate_plate = squares_of_plate();
  let clipped = sums[channel * N_SUMS + CLIPPED_SUM] / matrix[0];
  let gain_weight = select(PRIOR_WEIGHT, SAME_GAIN_WEIGHT, step.receiver > 0u) * plate_plate;
  let correction = (unknowns[0] + unknowns[1] + gain_weight) / (plate_plate + gain_weight);
  unknowns[0] = correction;
  unknowns[1] = MAX_BOUNCE * correction;
  if correction > 0.0 { store_receiver(channel, clipped); }
}
