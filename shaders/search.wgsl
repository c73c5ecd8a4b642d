// The shadow term of each texel of the new shadow: the warped sample where it is eligible, else the closest eligible one.
//
// Reads: warp, eligible, frame, plate. Writes: term (ratio to the plate, or colour), 1 where found; taps taken.
// Twin: reference/search.rs. Source: Casas et al. 2018, section 3.3 (concentric rings, all candidates of a ring, the
// closest wins, early exit) and section 3.4 with its ratio the right way up: shadow over light at the sample.

@group(1) @binding(0) var warp: texture_2d<f32>;
@group(1) @binding(1) var eligible: texture_2d<f32>;
@group(1) @binding(2) var frame: texture_2d<f32>;
@group(1) @binding(3) var plate: texture_2d<f32>;

struct Term {
  @location(0) term: vec4f,
  @location(1) taps: vec4f,
}

fn is_eligible(texel: vec2i) -> bool {
  let size = vec2i(textureDimensions(eligible));
  return all(texel >= vec2i(0)) && all(texel < size) && textureLoad(eligible, texel, 0).r > 0.0;
}

fn term_at(texel: vec2i) -> vec4f {
  let image_texel = texel + vec2i(globals.region_origin_px);
  let shaded = textureLoad(frame, image_texel, 0).rgb;
  if published.is_textured == 0u { return vec4f(shaded, 1.0); }
  let lit = textureLoad(plate, texel, 0).rgb;
  // Black in the plate tells nothing of the shadow: no change. Nor does a shadow add light: noise in the dark would.
  return vec4f(select(vec3f(1.0), min(shaded / lit, vec3f(1.0)), lit > vec3f(0.0)), 1.0);
}

@fragment
fn fs_search(@builtin(position) at: vec4f) -> Term {
  let warped = textureLoad(warp, vec2i(at.xy), 0);
  if warped.a == 0.0 { return Term(vec4f(0.0), vec4f(0.0)); }
  let start = vec2i(floor(warped.xy));
  if is_eligible(start) { return Term(term_at(start), vec4f(0.0)); }
  var taps = 0u;
  for (var ring = 1u; ring <= published.n_rings; ring++) {
    var best = 1e9;
    var found = vec2i(0);
    for (var k = 0u; k < published.n_ring_directions; k++) {
      // Every other ring is turned by half a step, so that rays are not left out altogether.
      let turn = (f32(k) + 0.5 * f32(ring & 1u)) / f32(published.n_ring_directions) * 6.2831853;
      let candidate = vec2i(floor(warped.xy + f32(ring) * published.ring_step_px * vec2f(cos(turn), sin(turn))));
      taps++;
      if is_eligible(candidate) {
        let away = distance(vec2f(candidate) + 0.5, warped.xy);
        if away < best {
          best = away;
          found = candidate;
        }
      }
    }
    if best < 1e9 { return Term(term_at(found), vec4f(f32(taps))); }
  }
  return Term(vec4f(0.0), vec4f(f32(taps)));
}
