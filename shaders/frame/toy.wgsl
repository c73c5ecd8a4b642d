// The toy in the shown pose, textured with its camera pixels.
//
// Visible points of the physical pose take the camera's pixels, scaled by the change of the fitted
// light, and those that have not moved each their own; hidden points take the model's base colour
// under the fitted light, times the tint. The old reflection of a glossy toy is subtracted from its
// pixels, and the new one is added. Drawn once for each offset; with the multisample positions the
// offsets make a denser pattern.
//
// Reads: both poses, materials, frame, the source pixels of the toy's colours and the light on
// them, gbuffer, fit, depth maps from the lights, tints; validity beside things with fronts. Writes: linear
// radiance, premultiplied, with the fraction of hit samples in alpha; difference from the camera's pixel.

//#import common/fit
//#import common/frame
//#import common/toy_light
//#import common/toy_radiance
//#import common/self_shadow
//#import common/material
//#import common/depth
//#import common/moved
//#import common/channels
//#import common/tint_grid
//#import common/between_tints
//#import common/behind
//#import common/camera_paint
//#import common/source
//#import common/spread
//#import common/over_things
//#import common/still_toy
//#import common/gloss

// Offset of the whole picture, in pixels to the right and down.
@group(1) @binding(0) var<uniform> offset_px: vec2f;
@group(1) @binding(1) var gbuffer_depth: texture_depth_2d;
@group(1) @binding(2) var appearance_base: texture_2d<f32>;
@group(1) @binding(3) var appearance_received: texture_2d<f32>;
@group(1) @binding(4) var<uniform> tint_grid: TintGrid;
@group(1) @binding(5) var<storage, read> tints: array<vec4f>;
@group(1) @binding(6) var appearance_source: texture_2d<f32>;
// Colour that a soft picture mixes into the toy's, over the gain, and the toy's part of a pixel.
@group(1) @binding(7) var rim: texture_2d<f32>;
// Reflected radiance of a glossy toy, relative to the gain; alpha is the visibility of the paint.
@group(1) @binding(8) var reflected: texture_2d<f32>;
@group(1) @binding(9) var<uniform> specular: Specular;
// Factor from a soft picture's mixture of the toy's surfaces to the one at the pixel's centre.
@group(1) @binding(10) var unmixed: texture_2d<f32>;
@group(1) @binding(11) var validity: texture_2d<f32>;

// Whether the light of the camera's pixel replaces the point's own in the test for changes.
override IS_COARSE: bool = false;
// Whether any part of the toy is glossy.
override IS_GLOSSY: bool = false;

// Surface area per pixel, shown relative to physical pose, above which camera pixels are used in full,
// and below which not at all: a surface seen at a grazing angle has too few pixels.
const STRETCH_ALL: f32 = 0.3;
const STRETCH_NONE: f32 = 0.1;
// The area from which texture lines that are thinner than a pixel come from the camera.
const STRETCH_LINES: f32 = 0.75;
// Relative difference of base colours above which two points of the model have different materials.
const OTHER_MATERIAL: f32 = 0.25;
// Relative step of depth up to which a point is the visible one: .1 mm at one metre.
const SHOWN_DEPTH: f32 = 1e-4;
// Weight of other paint around a visible point: with less of it lines are ragged, with all of it they
// are soft. It reduced the bundled toy's error from 3.89 to 3.75 codes.
const OTHER_PAINT_WEIGHT: f32 = 0.3;
// Weight of colours extrapolated past the outline, relative to the surface's own.
const CARRIED_WEIGHT: f32 = 1e-3;
// Weight of a pixel whose paint is hidden, relative to a visible one.
const UNTOLD_WEIGHT: f32 = 1e-3;

struct Vertex {
  @builtin(instance_index) material: u32,
  @location(0) in_anchor: vec3f,
  @location(1) normal: vec3f,
  @location(2) uv: vec2f,
  @location(3) color: vec4f,
  @location(4) physical_in_anchor: vec3f,
  @location(5) physical_normal: vec3f,
}

struct Surface {
  @builtin(position) clip: vec4f,
  @location(0) in_anchor: vec3f,
  @location(1) normal: vec3f,
  @location(2) uv: vec2f,
  @location(3) color: vec4f,
  @location(4) physical_in_anchor: vec3f,
  @location(5) physical_normal: vec3f,
  @location(6) @interpolate(flat, either) material: u32,
}

@vertex
fn vs_toy(in: Vertex) -> Surface {
  var clip = globals.clip_from_anchor * vec4f(in.in_anchor, 1.0);
  clip += vec4f(clip.w * vec2f(2.0, -2.0) * offset_px / globals.region_size_px, 0.0, 0.0);
  return Surface(
    clip,
    in.in_anchor,
    in.normal,
    in.uv,
    in.color,
    in.physical_in_anchor,
    in.physical_normal,
    in.material,
  );
}

// Whether a base colour belongs to another material of the model.
fn is_other_material(other: vec3f, base: vec3f) -> bool {
  return largest(abs(other - base)) > OTHER_MATERIAL * max(largest(other), largest(base));
}

// Reflection of a surface in the shown pose, or with its light in the physical one, over the gain.
fn reflected_at(material: u32, normal: vec3f, in_anchor: vec3f, received: vec4f) -> vec3f {
  if !IS_GLOSSY { return vec3f(0.0); }
  let strength = strength_of(material);
  if strength == 0.0 { return vec3f(0.0); }
  return strength * (reflected_of_lights(normal, in_anchor, received) + reflected_of_ambient(normal, in_anchor));
}

// Light's effect on a surface: the light on it, and a glossy toy's reflection.
fn looks(base: vec3f, lit: vec3f, reflects: vec3f) -> vec3f {
  if IS_GLOSSY { return base * lit + reflects; }
  return lit;
}

// Texel of the physical box of one of the four pixels around a point.
fn physical_tap(low: vec2f, k: u32) -> vec2i {
  return physical_texel(vec2i(low)) + vec2i(vec2u(k & 1u, k >> 1u));
}

// Whether the camera saw this point: its depth is between those of the four pixels around it, each of
// which shows one surface.
fn is_point_shown(low: vec2f, t: vec2f, depth: f32) -> bool {
  var depths = vec4f(0.0);
  for (var k = 0u; k < 4u; k++) {
    let texel = physical_tap(low, k);
    if !is_in_physical_box(texel) { return false; }
    if number_at(textureLoad(appearance_source, texel, 0)) != number_of(vec2i(0)) { return false; }
    depths[k] = textureLoad(gbuffer_depth, texel, 0);
  }
  let between = mix(mix(depths.x, depths.y, t.x), mix(depths.z, depths.w, t.x), t.y);
  return abs(between - depth) <= SHOWN_DEPTH * depth;
}

// The camera's colour of the paint, under the light `lit`, of the point of the physical toy at
// `physical_px` and `depth` with the base colour `base`; alpha is 0 if it is hidden. `is_beside`
// becomes whether other paint is beside it.
//
// Of the four pixels around it only those count that show its material, on its surface or on one farther
// away, or lie beyond the outline, with colours from `appearance`. Their mean is relit from their mean
// light. Less weight for the farther surface makes no difference: the error at a husky's edge is 3.65
// codes in place of 3.64. If the camera saw this point at a similar angle, pixels of other paint count,
// too: a line of the texture may be thinner than a pixel, and beside the camera's colours the model's own
// would be a speck.
fn camera_color(physical_px: vec2f, depth: f32, base: vec3f, lit: vec3f, expected: vec3f, stretch: f32, is_beside: ptr<function, bool>) -> vec4f {
  let at = physical_px - 0.5;
  let low = floor(at);
  let t = at - low;
  let is_shown = stretch >= STRETCH_LINES && is_point_shown(low, t, depth);
  var sum = vec4f(0.0);
  var told = 0.0;
  var up = 0.0;
  var received = vec4f(0.0);
  for (var k = 0u; k < 4u; k++) {
    let texel = physical_tap(low, k);
    if !is_in_physical_box(texel) { continue; }
    let surface = textureLoad(gbuffer_depth, texel, 0);
    if surface > depth && !is_same_surface(surface, depth) { continue; }
    let seen_base = textureLoad(appearance_base, texel, 0);
    let is_other = is_other_material(seen_base.rgb, base);
    let number = number_at(textureLoad(appearance_source, texel, 0));
    if number == NO_SOURCE { continue; }
    if is_other && !is_shown {
      *is_beside = true;
      continue;
    }
    let color = unmixed_paint(source_texel(texel, number));
    let corner = vec2f(vec2u(k & 1u, k >> 1u));
    let bilinear = mix(1.0 - t.x, t.x, corner.x) * mix(1.0 - t.y, t.y, corner.y);
    let own = bilinear * select(CARRIED_WEIGHT, 1.0, surface > 0.0) * select(1.0, OTHER_PAINT_WEIGHT, is_other);
    let weight = own * mix(UNTOLD_WEIGHT, 1.0, color.a);
    sum += weight * vec4f(color.rgb, 1.0);
    told += weight * color.a;
    up += weight * seen_base.a;
    received += weight * textureLoad(appearance_received, texel, 0);
  }
  if sum.a == 0.0 { return sum; }
  let was_lit = toy_radiance_from(vec2f(up, sum.a - up) / sum.a, received / sum.a);
  return vec4f(relit(sum.rgb / sum.a, lit, was_lit, expected), told / sum.a);
}

// Cosine between the triangle's normal and the direction to the camera; `normal` selects its outer side.
fn facing(in_anchor: vec3f, normal: vec3f) -> f32 {
  let across = cross(dpdx(in_anchor), dpdy(in_anchor));
  let outward = unit_normal(across * sign(dot(across, normal)));
  return dot(outward, normalize(globals.camera_in_anchor - in_anchor));
}

// Each light's cosine times its visibility at a still place of a glossy toy before: its paint and its
// reflection both depend on it.
fn received_before(place: vec3f, normal: vec3f) -> vec4f {
  if !IS_GLOSSY || IS_COARSE { return vec4f(0.0); }
  return light_received(true, normal, place);
}

// The reflection of a still place before, over the gain.
fn reflected_before(in_region: vec2i, material: u32, place: vec3f, normal: vec3f, received: vec4f) -> vec3f {
  if !IS_GLOSSY { return vec3f(0.0); }
  if IS_COARSE { return seen_reflected(clamped_to_physical_box(physical_texel(in_region))); }
  return reflected_at(material, normal, place, received);
}

// The light on a still place before, as radiance over base colour, if the light after is `lit` at
// its centre; that becomes the mean over a soft picture's spread.
//
// It is that of the same point, since the centre of a pixel may not represent a fold or a shadow's
// edge in it; `received` is that light on a glossy toy. Most still pixels are unchanged in both.
fn light_before(in_region: vec2i, shown: mat3x3f, normal: vec3f, before: mat3x3f, normal_before: vec3f, received: vec4f, lit: ptr<function, vec3f>) -> vec3f {
  let seen = seen_under(clamped_to_physical_box(physical_texel(in_region)));
  if IS_COARSE { return seen; }
  let is_same = light_change(*lit, seen) == 0.0;
  if is_soft() {
    if is_same && is_lit_alike(shown, normal, before, normal_before) { return *lit; }
    *lit = light_on(false, shown, normal);
    return light_on(true, before, normal_before);
  }
  if is_same { return *lit; }
  if IS_GLOSSY { return toy_radiance_over_base(normal_before, received); }
  return toy_radiance_over_base(normal_before, light_received(true, normal_before, before[0]));
}

// Tint of a material at a point of the physical pose.
fn tint_at(material: u32, physical_in_anchor: vec3f) -> vec3f {
  return between_tints(TINT_PYRAMID * tint_grid_of(material), TINT_SIDE, tint_place(physical_in_anchor)).rgb;
}

struct Drawn {
  @location(0) radiance: vec4f,
  // 1 if the surface has moved, less if its light alone has changed.
  @location(1) change: vec4f,
}

@fragment
fn fs_toy(
  @builtin(position) at: vec4f,
  @location(0) in_anchor: vec3f,
  @location(1) interpolated_normal: vec3f,
  @location(2) uv: vec2f,
  @location(3) color: vec4f,
  @location(4) physical_in_anchor: vec3f,
  @location(5) interpolated_physical_normal: vec3f,
  @location(6) @interpolate(flat, either) material: u32,
) -> Drawn {
  let base = base_color(material, uv, color);
  let normal = unit_normal(interpolated_normal);
  let physical_normal = unit_normal(interpolated_physical_normal);
  let physical_facing = facing(physical_in_anchor, physical_normal);
  let stretch =
    select(0.0, physical_facing / max(facing(in_anchor, normal), physical_facing), physical_facing > 0.0);
  let clip = globals.clip_from_anchor * vec4f(physical_in_anchor, 1.0);
  let physical_px = region_px(clip);
  let place = mat3x3f(in_anchor, dpdx(in_anchor), dpdy(in_anchor));
  let physical_place = mat3x3f(physical_in_anchor, dpdx(physical_in_anchor), dpdy(physical_in_anchor));
  let received = light_received(false, normal, in_anchor);
  let lit = toy_radiance_over_base(normal, received);
  let reflects = reflected_at(material, normal, in_anchor, received);
  let tint = tint_at(material, physical_in_anchor);
  let model = fit.gain.rgb * base * tint;
  var unseen = model * lit;
  var is_beside = false;
  let pixel = camera_color(physical_px, clip.z / clip.w, base, lit, unseen, stretch, &is_beside);
  if pixel.a == 0.0 && is_beside {
    unseen *= brightness_beside(physical_texel(vec2i(physical_px)), hemispheres(physical_normal).x, tint);
  }
  let seen = pixel.a * smoothstep(STRETCH_NONE, STRETCH_ALL, stretch);
  // Nothing is discarded, so that depth is tested first: surfaces behind this one are hidden, too.
  let is_behind = is_behind_receiver(at.xy + globals.toy_box_origin_px - offset_px, at.w);
  let in_region = vec2i(at.xy + globals.toy_box_origin_px);
  if is_behind || is_behind_thing(in_region, before_fronts_m(in_anchor)) { return Drawn(vec4f(0.0), vec4f(0.0)); }
  let is_moved = moved(region_px(globals.clip_from_anchor * vec4f(in_anchor, 1.0)), physical_px);
  var paint = mix(unseen, pixel.rgb, seen);
  var relit_part = 0.0;
  if is_moved < 1.0 {
    var after = lit;
    let was_received = received_before(physical_in_anchor, physical_normal);
    let reflects_before = reflected_before(in_region, material, physical_in_anchor, physical_normal, was_received);
    let before = light_before(in_region, place, normal, physical_place, physical_normal, was_received, &after);
    relit_part = light_change(looks(base, after, reflects), looks(base, before, reflects_before));
    if is_seen_still(in_region, physical_px, clip.z / clip.w, base) {
      let own = unmixed_paint(physical_texel(in_region));
      paint = mix(paint, relit(own.rgb, after, before, model * after), own.a * (1.0 - is_moved));
    }
  }
  let change = vec4f(written_change(is_moved, relit_part));
  if !IS_GLOSSY { return Drawn(vec4f(paint, 1.0), change); }
  return Drawn(vec4f(paint + fit.gain.rgb * reflects, 1.0), change);
}
