// Residuals of things and shadows that the model does not know.

//#import common/channels
//#import common/pixel

// Pooled residual, in plates, from which it may be an unknown thing or shadow, and from which it
// certainly is: then the pixel stays as photographed.
const OUTLIER_NONE: f32 = 0.15;
const OUTLIER_ALL: f32 = 0.3;
// Smallest over largest channel of a residual from which it may be a shadow, and below which it is
// not.
const SHADOW_EVENNESS: f32 = 0.4;
const OBJECT_EVENNESS: f32 = 0.2;
// Part of the receiver in the new shadow up to which a darkened pixel is too dark, and from which it
// is not.
const DARK_ALL: f32 = 0.1;
const DARK_NONE: f32 = 0.4;

// Certainty that a pooled residual shows something unknown.
fn outlier(pooled: vec3f) -> f32 {
  return smoothstep(OUTLIER_NONE, OUTLIER_ALL, largest(abs(pooled)));
}

// Likelihood that a residual is a shadow: all channels are darker, by similar amounts.
fn shadow_likeness(residual: vec3f) -> f32 {
  let least = -largest(residual);
  let most = largest(-residual);
  if least <= 0.0 { return 0.0; }
  return smoothstep(OBJECT_EVENNESS, SHADOW_EVENNESS, least / most);
}

// A pixel's own colour after a change of the model, which leaves a receiver as bright as `shadowed`.
// If nearly nothing would be left, it is in the shadow of something else already, and no second one
// of the same light falls there.
fn darkened(own_color: vec3f, changed: vec3f, shadowed: vec3f) -> vec3f {
  let left = smallest(changed / max(shadowed, vec3f(DARKEST_USABLE)));
  let kept = max(changed, min(own_color, shadowed));
  return kept + smoothstep(DARK_ALL, DARK_NONE, left) * (changed - kept);
}

// The model; 1 if the plate is clipped and no real shadow shows its true brightness.
fn shown_model(plate: vec3f, clipped: vec3f, model: vec3f) -> vec3f {
  return select(model, mix(model, vec3f(1.0), clipped), plate > vec3f(BRIGHTEST_USABLE));
}
