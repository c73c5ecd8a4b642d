// Reflectance of a rough dielectric in even surroundings.
// Source: Karis 2014.

// Reflectance of a dielectric of refractive index 1.5 at normal incidence.
const STRAIGHT_REFLECTANCE: f32 = 0.04;

// `cosine` is that between the direction to the eye and the normal; `root` is the square root of the roughness.
fn even_reflectance(cosine: f32, root: f32) -> f32 {
  let terms = root * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
  let grazing = min(terms.x * terms.x, exp2(-9.28 * cosine)) * terms.x + terms.y;
  return STRAIGHT_REFLECTANCE * (terms.z - 1.04 * grazing) + 1.04 * grazing + terms.w;
}
