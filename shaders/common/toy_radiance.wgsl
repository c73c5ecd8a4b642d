// What was fitted of the light on the toy: a constant, a vertical gradient, and one factor for each light's cosine times
// its visibility, when the light has the power it had for the plate. Over base colour and the exposure's gain.

fn toy_radiance_over_base(normal: vec3f, received: vec4f) -> vec3f {
  var sum = fit.toy[0].rgb + fit.toy[1].rgb * normal.y;
  for (var i = 0u; i < globals.n_lights; i++) { sum += fit.toy[2u + i].rgb * fit.intensity[i].rgb * received[i]; }
  return max(sum, vec3f(0.0));
}
