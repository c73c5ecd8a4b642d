// Reflected radiance of a glossy toy at each pixel of its physical pose, and the visibility of its
// paint below.
//
// A highlight that is brighter than the paint, or clipped, hides the paint: `toy` fills it from its
// neighbours.
//
// Reads: frame, gbuffer, fit. Writes: in the physical box, reflected radiance relative to the gain;
// alpha is 1 if the pixel shows the paint, and 0 if it does not.
// CPU reference: tests/reference/src/gloss.rs.

//#import common/gloss
//#import common/frame
//#import common/toy_radiance
//#import common/toy_point
//#import common/pixel
//#import common/channels
//#import common/fullscreen

@group(1) @binding(0) var<uniform> specular: Specular;
@group(1) @binding(1) var gbuffer_depth: texture_depth_2d;
// w is the material's index.
@group(1) @binding(2) var gbuffer_normal: texture_2d<f32>;
@group(1) @binding(3) var gbuffer_received: texture_2d<f32>;
@group(1) @binding(4) var gbuffer_base: texture_2d<f32>;

// Share of lamps' reflection in a pixel's light up to which its paint counts in full, and from
// which it does not count.
const PAINT_TOLD: f32 = 0.5;
const PAINT_OUTSHONE: f32 = 0.8;
// The share from which a clipped pixel counts as a highlight.
const CLIPPED_HIGHLIGHT: f32 = 0.1;

@fragment
fn fs_reflect(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  let none = vec4f(0.0, 0.0, 0.0, 1.0);
  let depth = textureLoad(gbuffer_depth, texel, 0);
  if depth == 0.0 { return none; }
  let surface = textureLoad(gbuffer_normal, texel, 0);
  let strength = strength_of(u32(surface.w));
  if strength == 0.0 { return none; }
  let received = textureLoad(gbuffer_received, texel, 0);
  let in_anchor = seen_in_anchor(at.xy + globals.physical_box_origin_px, depth);
  let of_lights = strength * reflected_of_lights(surface.xyz, in_anchor, received);
  let reflected = of_lights + strength * reflected_of_ambient(surface.xyz, in_anchor);
  let paint = textureLoad(gbuffer_base, texel, 0).rgb * toy_radiance_over_base(surface.xyz, received);
  let total = dot(reflected + paint, vec3f(1.0));
  if total == 0.0 { return none; }
  let share = dot(of_lights, vec3f(1.0)) / total;
  let is_clipped = largest(frame_at(region_texel(texel))) > BRIGHTEST_USABLE && share > CLIPPED_HIGHLIGHT;
  let told = 1.0 - smoothstep(PAINT_TOLD, PAINT_OUTSHONE, share);
  return vec4f(reflected, select(told, 0.0, is_clipped));
}
