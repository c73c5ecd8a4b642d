// Cosine of the toy's surface to a light, for a unit normal in anchor space.

//#import common/globals

// Cosine of the normal to light `i`, 0 if the surface is turned away.
fn light_cosine(i: u32, normal: vec3f, in_anchor: vec3f) -> f32 {
  let light = globals.lights[i];
  let to_light = light.xyz - in_anchor * light.w;
  let distance_squared = dot(to_light, to_light);
  if distance_squared == 0.0 { return 1.0; }
  return max(dot(normal, to_light) * inverseSqrt(distance_squared), 0.0);
}
