// The model of a receiver: the frame as a fraction of the plate times the gain.
//
//   M = A (1 - sum f) + bounce A (1 - A) + sum f intensity V
//   f = fraction falloff / ((1 - sum fraction) sky + sum fraction falloff)
//
// V is the visibility of a light, A the ambient visibility, f a light's fraction of the plate's
// radiance there, `fraction` that at the reference point, and `sky` the part of the sky that no
// other receiver hides there.
// The occluder of 1 - A of the sky reflects light that enters through the open part, A: in a
// crevice it is dark itself.
// Source: Casas et al. 2019, section 4, gives the ratio of one sample; this is its additive form
// with one fraction per light, so that no sample with the same overlap is needed (compare Chuang et
// al. 2003, shadow matting). Without any light it is M = A + bounce (1 - A): the share of ambient
// light is unknown, and the bounce is the part of it that casts no shadow, for 1 all of it.

//#import common/fit
//#import common/plate_light

// Ambient light's fraction of the plate's radiance at the reference point.
fn ambient_fraction(receiver: u32) -> vec3f {
  var fraction = vec3f(1.0);
  for (var i = 0u; i < globals.n_lights; i++) { fraction -= fit.receivers[receiver].direct_fraction[i].rgb; }
  return fraction;
}

// Irradiance of the plate at a receiver point relative to the reference point, if the ambient light
// were even. It is positive, since the direct fractions sum to less than 1 and some sky is open.
fn plate_falloff(point: ReceiverPoint) -> vec3f {
  let receiver = receiver_of(point);
  var total = open_sky(point) * ambient_fraction(receiver);
  for (var i = 0u; i < globals.n_lights; i++) {
    total += fit.receivers[receiver].direct_fraction[i].rgb * falloff(i, point);
  }
  return total;
}

// Share of the toy's bounce that reaches a point: 0 in the open, and 0 at the contact with the toy,
// unless no light is known.
fn bounced(ambient: f32) -> f32 {
  return select(ambient, 1.0, has_no_light()) * (1.0 - ambient);
}

// Part of the plate, whose falloff is `total`, from the ambient light and the toy's bounce.
fn ambient_part(point: ReceiverPoint, ambient: f32, total: vec3f) -> vec3f {
  let receiver = receiver_of(point);
  let of_sky = ambient * open_sky(point) * ambient_fraction(receiver);
  return of_sky / total + fit.receivers[receiver].bounce.rgb * bounced(ambient);
}

// Light `i`'s fraction of the plate's radiance at a point with the plate's falloff `total`.
fn light_part(i: u32, point: ReceiverPoint, total: vec3f) -> vec3f {
  return fit.receivers[receiver_of(point)].direct_fraction[i].rgb * falloff(i, point) / total;
}

// The model of a receiver in two states of its light at once, such as before and after, as columns.
// No array is indexed by a light's number, since processors keep such arrays in memory.
fn receiver_models(point: ReceiverPoint, ambient: vec2f, visibility_0: vec4f, visibility_1: vec4f) -> mat2x3f {
  let receiver = receiver_of(point);
  let of_sky = open_sky(point) * ambient_fraction(receiver);
  var total = of_sky;
  var lit = mat2x3f();
  for (var i = 0u; i < globals.n_lights; i++) {
    let here = fit.receivers[receiver].direct_fraction[i].rgb * falloff(i, point);
    total += here;
    let shining = here * fit.intensity[i].rgb;
    lit[0] += visibility_0[i] * shining;
    lit[1] += visibility_1[i] * shining;
  }
  let bounce = fit.receivers[receiver].bounce.rgb;
  return mat2x3f(
    (ambient.x * of_sky + lit[0]) / total + bounced(ambient.x) * bounce,
    (ambient.y * of_sky + lit[1]) / total + bounced(ambient.y) * bounce,
  );
}

// `visibility` holds up to four lights, light 0 in x.
fn receiver_model(point: ReceiverPoint, ambient: f32, visibility: vec4f) -> vec3f {
  return receiver_models(point, vec2f(ambient), visibility, visibility)[0];
}
