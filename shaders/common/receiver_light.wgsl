// Constraints of the receivers on the light on the toy: sums of coefficients times its unknowns
// that are 0.
//
// In the open, each light's part of a receiver's radiance is to the ambient part as its light on
// the toy times the cosine to the receiver is to the ambient light on a surface parallel to the
// receiver. The light from below is reflected by the first receiver.

//#import common/fit
//#import common/hemispheres

// Part of the light from above that a receiver reflects: middle grey, somewhat reduced, since the
// toy shades it.
const PRIOR_REFLECTANCE: f32 = 0.25;
// Share of all lights below which a light's relation has reduced weight.
const LEAST_SHARE: f32 = 0.05;

// Vector from a receiver's reference point to light `i`, in its plane space: metres, or a unit
// direction.
fn reference_to_light(receiver: u32, i: u32) -> vec3f {
  let light = globals.receivers[receiver].lights[i];
  let reference = globals.receivers[receiver].reference_in_plane;
  return light.xyz - light.w * vec3f(reference.x, 0.0, reference.y);
}

// Cosine of light `i` to a receiver, at its reference point; 0 if the light is behind it.
fn reference_cosine(receiver: u32, i: u32) -> f32 {
  let to_light = reference_to_light(receiver, i);
  let distance_m = length(to_light);
  if distance_m == 0.0 { return 1.0; }
  return max(to_light.y / distance_m, 0.0);
}

// The first receiver that light `i` reaches, or the first of all.
fn receiver_in_light(i: u32) -> u32 {
  for (var k = 0u; k < globals.n_receivers; k++) {
    if reference_cosine(k, i) > 0.0 { return k; }
  }
  return 0u;
}

fn direct_fraction_of(receiver: u32, i: u32, channels: vec3f) -> f32 {
  return dot(solution.receivers[receiver].direct_fraction[i].rgb, channels);
}

fn total_direct_fraction(receiver: u32, n_lights: u32, channels: vec3f) -> f32 {
  var total = 0.0;
  for (var i = 0u; i < n_lights; i++) { total += direct_fraction_of(receiver, i, channels); }
  return total;
}

// Weight of light `i`'s relation: a light that is listed twice, with half the intensity each, has
// the same weight as once.
fn relation_weight(i: u32, n_lights: u32, channels: vec3f) -> f32 {
  let k = receiver_in_light(i);
  let total = total_direct_fraction(k, n_lights, channels);
  if total == 0.0 { return 1.0; }
  return 1.0 / max(direct_fraction_of(k, i, channels) / total, LEAST_SHARE);
}

fn light_relation(i: u32, n_lights: u32, channels: vec3f) -> array<f32, N_COLUMNS> {
  let k = receiver_in_light(i);
  let fraction = direct_fraction_of(k, i, channels);
  let part = hemispheres(transpose(globals.receivers[k].plane_from_anchor)[1].xyz);
  var relation: array<f32, N_COLUMNS>;
  relation[0] = -fraction * part.x;
  relation[1] = -fraction * part.y;
  relation[2u + i] = (1.0 - total_direct_fraction(k, n_lights, channels)) * reference_cosine(k, i);
  return relation;
}

fn reflection_relation(n_lights: u32) -> array<f32, N_COLUMNS> {
  var relation: array<f32, N_COLUMNS>;
  relation[0] = -PRIOR_REFLECTANCE;
  relation[1] = 1.0;
  for (var i = 0u; i < n_lights; i++) { relation[2u + i] = -PRIOR_REFLECTANCE * reference_cosine(0u, i); }
  return relation;
}
