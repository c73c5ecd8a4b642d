// The model of the receiver: what a frame is, as a fraction of the plate.
//
//   M = gain (A (1 - sum f) + bounce (1 - A) + sum f V)
//   f = share falloff / (1 - sum share + sum share falloff)
//
// V is the visibility of a light, A the ambient visibility, f a light's share of the plate's radiance there.
// Source: Casas et al. 2019, section 4, gives the ratio of one sample; this is its additive form with one share per
// light, so that no sample with the same overlap is needed (compare Chuang et al. 2003, shadow matting).

// Plate's irradiance at a receiver point over that at the reference point, were the ambient light even.
// Positive, since the shares sum to less than 1.
fn plate_falloff(in_plane: vec2f) -> vec3f {
  var total = vec3f(1.0);
  for (var i = 0u; i < globals.n_lights; i++) {
    total += fit.share[i].rgb * (falloff(i, in_plane) - 1.0);
  }
  return total;
}

// `visibility` holds up to four lights, light 0 in x.
fn receiver_model(in_plane: vec2f, ambient: f32, visibility: vec4f) -> vec3f {
  var direct = vec3f(0.0);
  var shares = vec3f(0.0);
  for (var i = 0u; i < globals.n_lights; i++) {
    let share = fit.share[i].rgb;
    shares += share;
    direct += share * (falloff(i, in_plane) * visibility[i]);
  }
  let kept = (direct + ambient * (1.0 - shares)) / plate_falloff(in_plane);
  return fit.gain.rgb * (kept + fit.bounce.rgb * (1.0 - ambient));
}
