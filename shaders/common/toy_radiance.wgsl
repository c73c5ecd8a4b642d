// Fitted radiance of the toy relative to base colour and gain: ambient light from above and from
// below, and one factor per light, stated at the plate's intensity, for intensity times cosine
// times visibility. None of them is negative.

//#import common/fit
//#import common/hemispheres

fn toy_radiance_over_base(normal: vec3f, received: vec4f) -> vec3f {
  return toy_radiance_from(hemispheres(normal), received);
}

// The same for a surface with these parts of its view above and below the horizon.
fn toy_radiance_from(part: vec2f, received: vec4f) -> vec3f {
  var sum = part.x * fit.toy[0].rgb + part.y * fit.toy[1].rgb;
  for (var i = 0u; i < globals.n_lights; i++) { sum += fit.toy[2u + i].rgb * fit.intensity[i].rgb * received[i]; }
  return sum;
}
