// sRGB codes from 0 to 1, and linear light. Source: IEC 61966-2-1.

fn linear_from_srgb(codes: vec3f) -> vec3f {
  let curved = pow((codes + 0.055) / 1.055, vec3f(2.4));
  return select(curved, codes / 12.92, codes <= vec3f(0.04045));
}

fn srgb_from_linear(light: vec3f) -> vec3f {
  let curved = 1.055 * pow(light, vec3f(1.0 / 2.4)) - 0.055;
  return select(curved, light * 12.92, light <= vec3f(0.0031308));
}
