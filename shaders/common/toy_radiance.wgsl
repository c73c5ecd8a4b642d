// Fitted radiance of the toy over base colour and gain: a constant, a vertical gradient, and one factor per light,
// stated at the plate's intensity, for intensity times cosine times visibility.

fn toy_radiance_over_base(normal: vec3f, received: vec4f) -> vec3f {
  var sum = fit.toy[0].rgb + fit.toy[1].rgb * normal.y;
  for (var i = 0u; i < globals.n_lights; i++) { sum += fit.toy[2u + i].rgb * fit.intensity[i].rgb * received[i]; }
  return max(sum, vec3f(0.0));
}
