// The model of a receiver: what a frame is, as a fraction of the plate times the gain.
//
//   M = A (1 - sum f) + bounce A (1 - A) + sum f intensity V
//   f = fraction falloff / (1 - sum fraction + sum fraction falloff)
//
// V is the visibility of a light, A the ambient visibility, f a light's fraction of the plate's radiance there,
// `fraction` that at the
// reference point.
// What hides 1 - A of the sky throws back light that came in through what is open, A: in a crevice it is dark itself.
// Source: Casas et al. 2019, section 4, gives the ratio of one sample; this is its additive form with one fraction per
// light, so that no sample with the same overlap is needed (compare Chuang et al. 2003, shadow matting).

// Plate's irradiance at a receiver point over that at the reference point, were the ambient light even.
// Positive, since the direct fractions sum to less than 1.
fn plate_falloff(point: ReceiverPoint) -> vec3f {
  var total = vec3f(1.0);
  for (var i = 0u; i < globals.n_lights; i++) {
    total += fit.receivers[receiver_of(point)].direct_fraction[i].rgb * (falloff(i, point) - 1.0);
  }
  return total;
}

// How much of the toy's bounce a point sees: 0 in the open, and 0 where the toy touches it.
fn bounced(ambient: f32) -> f32 {
  return ambient * (1.0 - ambient);
}

// What the ambient light and what the toy throws back leave of the plate, whose falloff is `total`.
fn ambient_part(point: ReceiverPoint, ambient: f32, total: vec3f) -> vec3f {
  var ambient_fraction = vec3f(1.0);
  for (var i = 0u; i < globals.n_lights; i++) {
    ambient_fraction -= fit.receivers[receiver_of(point)].direct_fraction[i].rgb;
  }
  return ambient * ambient_fraction / total + fit.receivers[receiver_of(point)].bounce.rgb * bounced(ambient);
}

// Light `i`'s fraction of the plate's radiance at a point, where the plate's falloff is `total`.
fn light_part(i: u32, point: ReceiverPoint, total: vec3f) -> vec3f {
  return fit.receivers[receiver_of(point)].direct_fraction[i].rgb * falloff(i, point) / total;
}

fn ambient_model(point: ReceiverPoint, ambient: f32) -> vec3f {
  return ambient_part(point, ambient, plate_falloff(point));
}

fn light_fraction(i: u32, point: ReceiverPoint) -> vec3f {
  return light_part(i, point, plate_falloff(point));
}

// The model's coefficients at a point, the same for every pose: of A, of A (1 - A), and of V for each light.
// An array, since drivers of older Adreno keep structs in fragment shaders at 16 bits.
alias ReceiverLight = array<vec3f, 6>; // 2 + MAX_LIGHTS

fn receiver_light(point: ReceiverPoint) -> ReceiverLight {
  let receiver = receiver_of(point);
  var total = vec3f(1.0);
  var light: ReceiverLight;
  light[0] = vec3f(1.0);
  light[1] = fit.receivers[receiver].bounce.rgb;
  for (var i = 0u; i < globals.n_lights; i++) {
    let fraction = fit.receivers[receiver].direct_fraction[i].rgb;
    let here = fraction * falloff(i, point);
    total += here - fraction;
    light[0] -= fraction;
    light[2u + i] = here * fit.intensity[i].rgb;
  }
  light[0] /= total;
  for (var i = 0u; i < globals.n_lights; i++) { light[2u + i] /= total; }
  return light;
}

// `visibility` holds up to four lights, light 0 in x.
fn model_in(light: ReceiverLight, ambient: f32, visibility: vec4f) -> vec3f {
  return light[0] * ambient + light[1] * bounced(ambient)
    + mat4x3f(light[2], light[3], light[4], light[5]) * visibility;
}

fn receiver_model(point: ReceiverPoint, ambient: f32, visibility: vec4f) -> vec3f {
  return model_in(receiver_light(point), ambient, visibility);
}
