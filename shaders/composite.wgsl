// The picture: plate times new shadow, real toy and real shadow gone, animated toy drawn with its camera pixels.
//
//   out = gain plate (M' + r)         in general, r the pooled residual, fading where the shadow changed much
//   out = frame + gain plate (M' - M) where the receiver is seen and M' is near M: r is the pixel's own, so the frame
//                                     passes; also where the frame shows what the model cannot explain
//
// Reads: all that was captured, visibility and ambient of the animated pose. Writes: linear colour, opaque.
// Twin: reference/composite.rs.

@group(1) @binding(1) var<storage, read> cells: array<vec4f>;
@group(1) @binding(2) var frame: texture_2d<f32>;
@group(1) @binding(3) var plate: texture_2d<f32>;
@group(1) @binding(4) var evidence: texture_2d<f32>;
@group(1) @binding(5) var physical_visibility: texture_2d<f32>;
@group(1) @binding(6) var physical_ambient: texture_2d<f32>;
@group(1) @binding(7) var visibility: texture_2d<f32>;
@group(1) @binding(8) var ambient: texture_2d<f32>;
@group(1) @binding(9) var linear_sampler: sampler;
@group(1) @binding(10) var appearance: texture_2d<f32>;
@group(1) @binding(11) var object_depth: texture_depth_2d;
@group(1) @binding(12) var object_base: texture_2d<f32>;
@group(1) @binding(13) var object_normal: texture_2d<f32>;

// Change of the model, in plates, up to which a seen pixel keeps its own residual, and from which it has none of it.
const KEEP_ALL: f32 = 0.02;
const KEEP_NONE: f32 = 0.15;
// Change of the model from which the pooled residual no longer holds at half its size.
const RESIDUAL_HALF: f32 = 0.5;
// Pooled residual, in plates, from which something unknown is seen, such as a hand or the shadow of a light that is not
// listed, and from which nothing else counts: what the camera saw stays.
const UNKNOWN_NONE: f32 = 0.15;
const UNKNOWN_ALL: f32 = 0.3;
// A turned surface is never made more than this much brighter or darker than its camera pixel.
const MAX_TURN: f32 = 4.0;
// Surface per camera pixel, shown over physical, down to which pixels are carried in full, and from which not at all:
// a surface that was seen at a grazing angle and turns to the camera has too few pixels to show.
const STRETCH_ALL: f32 = 0.3;
const STRETCH_NONE: f32 = 0.1;
// Difference of base colours, against the lighter one, from which two points of the model are of two materials.
const OTHER_MATERIAL: f32 = 0.25;
// Cosine between two normals below which they are of two sides.
const OTHER_SIDE_COSINE: f32 = 0.9;
// Weight of colours carried past the outline, against those of the surface itself.
const CARRIED_WEIGHT: f32 = 1e-3;

// 1 inside, falling to 0 at an inner border of the region.
fn inside_border(region_px: vec2f) -> f32 {
  let to_edge = vec4f(region_px, globals.region_size_px - region_px);
  let fade = select(vec4f(1.0), to_edge / globals.border_px, globals.border_px > vec4f(0.0));
  return saturate(min(min(fade.x, fade.y), min(fade.z, fade.w)));
}

@fragment
fn fs_receiver(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2u(position.xy);
  let at = position.xy;
  let image_texel = texel + vec2u(globals.region_origin_px);
  let f = textureLoad(frame, image_texel, 0).rgb;
  let point = receiver_point(at);
  let b = textureLoad(plate, texel, 0);
  let lit = fit.gain.rgb * b.rgb;
  let seen = textureLoad(evidence, texel, 0).r;
  // Nothing is known of what is behind.
  if b.a == 0.0 { return vec4f(f, 1.0); }
  // Beyond the receivers nothing changes but that the real toy goes.
  if !is_hit(point) { return vec4f(mix(lit, f, seen), 1.0); }
  let uv = at / globals.region_size_px;
  let before = receiver_model(point, textureSampleLevel(physical_ambient, linear_sampler, uv, 0.0).r,
    textureLoad(physical_visibility, texel, 0));
  let after = receiver_model(point, textureSampleLevel(ambient, linear_sampler, uv, 0.0).r,
    textureLoad(visibility, texel, 0));
  let most = largest(abs(after - before));
  let pooled = cell_at(point).rgb;
  let residual = pooled * (1.0 - smoothstep(0.0, 2.0 * RESIDUAL_HALF, most));
  let is_unknown = smoothstep(UNKNOWN_NONE, UNKNOWN_ALL, largest(abs(pooled)));
  let keep = seen * max(1.0 - smoothstep(KEEP_ALL, KEEP_NONE, most), is_unknown);
  let made = lit * max(after + residual, vec3f(0.0));
  let kept = f + lit * (after - before);
  let inside = max(inside_border(at), 1.0 - seen);
  return vec4f(max(mix(f, mix(made, kept, keep), inside), vec3f(0.0)), 1.0);
}

struct Vertex {
  @location(0) in_plane: vec3f,
  @location(1) normal: vec3f,
  @location(2) uv: vec2f,
  @location(3) color: vec4f,
  @location(4) physical_in_plane: vec3f,
  @location(5) physical_normal: vec3f,
}

struct Surface {
  @builtin(position) clip: vec4f,
  @location(0) in_plane: vec3f,
  @location(1) normal: vec3f,
  @location(2) uv: vec2f,
  @location(3) color: vec4f,
  @location(4) physical_in_plane: vec3f,
  @location(5) physical_normal: vec3f,
}

@vertex
fn vs_toy(in: Vertex) -> Surface {
  return Surface(globals.clip_from_stage * vec4f(in.in_plane, 1.0), in.in_plane, in.normal, in.uv, in.color,
    in.physical_in_plane, in.physical_normal);
}

fn toy_radiance_over_base(normal: vec3f, in_plane: vec3f) -> vec3f {
  var sum = vec3f(0.0);
  for (var i = 0u; i < 2u + globals.n_lights; i++) { sum += fit.toy[i].rgb * toy_column(i, normal, in_plane); }
  return fit.gain.rgb * max(sum, vec3f(0.0));
}

fn largest(c: vec3f) -> f32 {
  return max(c.r, max(c.g, c.b));
}

// Whether the camera sees another side of the toy at `texel`: turned away and of another colour. Either alone is common
// on one surface, at a fold or in a pattern.
fn is_other_side(texel: vec2u, base: vec3f, normal: vec3f) -> bool {
  let other = textureLoad(object_base, texel, 0).rgb;
  let is_other_color = largest(abs(other - base)) > OTHER_MATERIAL * max(largest(other), largest(base));
  return is_other_color && dot(textureLoad(object_normal, texel, 0).xyz, normal) < OTHER_SIDE_COSINE;
}

// The camera's colour of a point of the physical toy, alpha 0 where something hides it.
//
// Of the four pixels around it only those count that show its own surface and side, or that lie beyond the toy's
// outline where `appearance` carried its colours.
fn camera_color(clip: vec4f, region_px: vec2f, base: vec3f, normal: vec3f) -> vec4f {
  let depth = clip.z / clip.w;
  let at = region_px - 0.5;
  let low = floor(at);
  let t = at - low;
  let last = globals.region_size_px - 1.0;
  var sum = vec4f(0.0);
  for (var k = 0u; k < 4u; k++) {
    let corner = vec2f(f32(k & 1u), f32(k >> 1u));
    let tap = low + corner;
    if !(all(tap >= vec2f(0.0)) && all(tap <= last)) { continue; }
    let texel = vec2u(tap);
    let surface = textureLoad(object_depth, texel, 0);
    if surface > depth && !is_same_surface(surface, depth) { continue; }
    if surface > 0.0 && is_other_side(texel, base, normal) { continue; }
    let color = textureLoad(appearance, texel, 0);
    let bilinear = mix(1.0 - t.x, t.x, corner.x) * mix(1.0 - t.y, t.y, corner.y);
    let weight = bilinear * color.a * select(CARRIED_WEIGHT, 1.0, surface > 0.0);
    sum += weight * vec4f(color.rgb, 1.0);
  }
  if sum.a == 0.0 { return sum; }
  return vec4f(sum.rgb / sum.a, 1.0);
}

// Cosine between the triangle and the direction to the camera; `normal` tells its outer side.
fn facing(in_plane: vec3f, normal: vec3f) -> f32 {
  let across = cross(dpdx(in_plane), dpdy(in_plane));
  let outward = unit_normal(across * sign(dot(across, normal)));
  return dot(outward, normalize(globals.camera_in_stage - in_plane));
}

@fragment
fn fs_toy(in: Surface) -> @location(0) vec4f {
  let base = base_color(in.uv, in.color);
  let normal = unit_normal(in.normal);
  let physical_normal = unit_normal(in.physical_normal);
  let physical_facing = facing(in.physical_in_plane, physical_normal);
  let stretch = select(0.0, physical_facing / max(facing(in.in_plane, normal), physical_facing), physical_facing > 0.0);
  let clip = globals.clip_from_stage * vec4f(in.physical_in_plane, 1.0);
  let region_px = (clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5) * globals.region_size_px;
  let pixel = camera_color(clip, region_px, base, physical_normal);
  let seen = pixel.a * smoothstep(STRETCH_NONE, STRETCH_ALL, stretch);
  let lit = toy_radiance_over_base(normal, in.in_plane);
  let was_lit = toy_radiance_over_base(physical_normal, in.physical_in_plane);
  let turn = select(vec3f(1.0), lit / was_lit, was_lit > vec3f(0.0));
  let carried = pixel.rgb * clamp(turn, vec3f(1.0 / MAX_TURN), vec3f(MAX_TURN));
  return vec4f(mix(base * lit, carried, seen), 1.0);
}
