// How the toy's surface is lit: radiance over base colour, for a unit normal in plane space.

fn toy_column(i: u32, normal: vec3f, in_plane: vec3f) -> f32 {
  if i == 0u { return 1.0; }
  if i == 1u { return normal.y; }
  let light = globals.lights[i - 2u];
  let to_light = normalize(light.xyz - in_plane * light.w);
  return max(dot(normal, to_light), 0.0);
}
