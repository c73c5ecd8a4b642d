// Marks of the validity mask, which is of the physical box: all else shows the receiver, well clear of the toy.

//#import common/globals

const FAR_MARKS = vec4f(1.0, 0.0, 1.0, 1.0);

fn marks_at(region_texel: vec2i) -> vec4f {
  let texel = physical_texel(region_texel);
  if !is_in_physical_box(texel) { return FAR_MARKS; }
  return textureLoad(validity, texel, 0);
}
