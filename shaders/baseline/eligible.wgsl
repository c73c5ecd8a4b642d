// The paper's masks 3b and 3c, of all lights and receivers: g is the real shadow with its penumbra,
// r the part of it that is sampled, labelled with its receiver and the set of lights whose umbra
// contains it.
//
// Eligible are pixels that show the receiver with each light either hidden or fully visible, and
// that are like all pixels within a margin: the penumbrae of all lights are excluded.
//
// Reads: masks (3a), visibility of each light with the physical toy. Writes: a label; 0 or 1.
// CPU reference: tests/reference/src/eligible.rs. Source: Casas et al. 2018, sections 3.3, 4.2 (3b
// is the soft shadow made binary) and 4.6 (a mask per light); 2019, section 5.7 (a subregion per
// receiver). The margin is an addition: a pixel at an edge is half lit, or half toy.

//#import common/baseline
//#import common/fullscreen

@group(1) @binding(0) var masks: texture_2d<f32>;
@group(1) @binding(1) var visibility: texture_2d<f32>;

// A fainter shadow is not cropped: two codes of a white table.
const FAINT: f32 = 0.01;

// The label of the umbra that a texel shows; 0 for the toy, a penumbra or no shadow.
fn umbra_at(texel: vec2i) -> u32 {
  let at = clamp(texel, vec2i(0), vec2i(textureDimensions(masks)) - 1);
  if textureLoad(masks, at, 0).r != 0.0 { return 0u; }
  let v = textureLoad(visibility, at, 0);
  var lights = 0u;
  for (var light = 0u; light < globals.n_lights; light++) {
    if v[light] == 0.0 { lights |= 1u << light; }
    else if v[light] < 1.0 - FAINT { return 0u; }
  }
  return label_of(receiver_at(at), lights);
}

fn is_shaded(texel: vec2i) -> bool {
  let v = textureLoad(visibility, texel, 0);
  for (var light = 0u; light < globals.n_lights; light++) {
    if v[light] < 1.0 - FAINT { return true; }
  }
  return false;
}

@fragment
fn fs_mark(@builtin(position) at: vec4f) -> @location(0) vec2u {
  let texel = vec2i(at.xy);
  let in_shadow = select(0u, 1u, is_shaded(texel));
  let label = umbra_at(texel);
  if label == 0u { return vec2u(0u, in_shadow); }
  let margin = baseline.eligible_margin_px;
  for (var y = -margin; y <= margin; y++) {
    for (var x = -margin; x <= margin; x++) {
      if umbra_at(texel + vec2i(x, y)) != label { return vec2u(0u, in_shadow); }
    }
  }
  return vec2u(label, in_shadow);
}
