// The shadow term of each texel of the new shadows: the warped sample if the same lights are hidden
// there, otherwise the closest such sample.
//
// If the receiver has no sample with the same lights hidden, the closest one of the most similar
// sets is used, and if it has no sample at all, one of another receiver: the papers call this case
// a failure of the method.
//
// Reads: warp of each light, eligible (mask 3c), seen_sets, frame, plate. Writes: term (ratio to
// the plate, or colour), and the texel's label, 0 if nothing was found; number of taps.
// CPU reference: tests/reference/src/search.rs. Source: Casas et al. 2018, sections 3.3 (concentric
// rings, all candidates of a ring, the closest wins, early exit), 4.6 (no sample until all masks
// agree) and 3.4, whose ratio is corrected here to shadow over light at the sample; Casas et al.
// 2019, section 5.7 (each receiver separately).

//#import common/baseline
//#import common/fullscreen

@group(1) @binding(0) var warp: texture_2d_array<f32>;
@group(1) @binding(1) var eligible: texture_2d<u32>;
@group(1) @binding(2) var frame: texture_2d<f32>;
@group(1) @binding(3) var plate: texture_2d<f32>;
@group(1) @binding(4) var<storage, read> seen_sets: array<u32, MAX_RECEIVERS>;

struct Term {
  @location(0) term: vec4f,
  @location(1) taps: vec4f,
}

// Result of a search: xy is the texel, z is 1 if there is one, w the number of taps.
alias Found = vec4i;

// Whether a texel can be a sample: it shows `receiver`, and a set s whose bit in `sets` is 1.
fn is_eligible(texel: vec2i, receiver: u32, sets: u32) -> bool {
  let size = vec2i(textureDimensions(eligible));
  if any(texel < vec2i(0)) || any(texel >= size) { return false; }
  let label = textureLoad(eligible, texel, 0).r;
  return label / N_SETS == receiver && ((sets >> (label % N_SETS)) & 1u) != 0u;
}

fn ratio_at(texel: vec2i) -> vec3f {
  let shaded = textureLoad(frame, texel + vec2i(globals.region_origin_px), 0).rgb;
  let lit = textureLoad(plate, texel, 0).rgb;
  // The ratio over a black plate is undefined and counts as 1. It is at most 1: noise in dark
  // pixels would add light.
  return select(vec3f(1.0), min(shaded / lit, vec3f(1.0)), lit > vec3f(0.0));
}

// The term for a texel of `receiver` from a sample, which may be `borrowed` from another receiver.
fn term_at(texel: vec2i, found: vec2i, receiver: u32, borrowed: bool) -> vec3f {
  if ((baseline.textured_receivers >> receiver) & 1u) != 0u { return ratio_at(found); }
  if borrowed { return ratio_at(found) * textureLoad(plate, texel, 0).rgb; }
  return textureLoad(frame, found + vec2i(globals.region_origin_px), 0).rgb;
}

// The sets in `remaining` that are most similar to `wanted`.
fn closest_sets(wanted: u32, remaining: u32) -> u32 {
  var least = 0xffffffffu;
  var accepted = 0u;
  for (var lights = 1u; lights < 1u << globals.n_lights; lights++) {
    if ((remaining >> lights) & 1u) == 0u { continue; }
    let far = unlikeness(wanted, lights);
    if far < least { accepted = 0u; }
    least = min(least, far);
    if far == least { accepted |= 1u << lights; }
  }
  return accepted;
}

// Number of rings around a point that may intersect the region, given its farthest corner.
fn n_rings_around(at: vec2f) -> u32 {
  let farthest_px = length(max(abs(at), abs(globals.region_size_px - at)));
  return min(baseline.n_rings, u32(farthest_px / baseline.ring_step_px));
}

// Searches at the warped position of each light of the set, then in rings around it.
fn search(texel: vec2i, lights: u32, receiver: u32, sets: u32) -> Found {
  var n_rings = 0u;
  for (var light = 0u; light < globals.n_lights; light++) {
    if ((lights >> light) & 1u) == 0u { continue; }
    let warped = textureLoad(warp, texel, light, 0).xy;
    let start = vec2i(floor(warped));
    if is_eligible(start, receiver, sets) { return vec4i(start, 1, 0); }
    n_rings = max(n_rings, n_rings_around(warped));
  }
  var taps = 0;
  for (var ring = 1u; ring <= n_rings; ring++) {
    var best = 1e9;
    var found = vec2i(0);
    for (var light = 0u; light < globals.n_lights; light++) {
      if ((lights >> light) & 1u) == 0u { continue; }
      let warped = textureLoad(warp, texel, light, 0).xy;
      for (var k = 0u; k < baseline.n_ring_directions; k++) {
        // Every other ring is rotated by half a step, so that the directions in between are
        // sampled, too.
        let turn = (f32(k) + 0.5 * f32(ring & 1u)) / f32(baseline.n_ring_directions) * 6.2831853;
        let candidate = vec2i(floor(warped + f32(ring) * baseline.ring_step_px * vec2f(cos(turn), sin(turn))));
        taps++;
        if is_eligible(candidate, receiver, sets) {
          let away = distance(vec2f(candidate) + 0.5, warped);
          if away < best {
            best = away;
            found = candidate;
          }
        }
      }
    }
    if best < 1e9 { return vec4i(found, 1, taps); }
  }
  return vec4i(0, 0, 0, taps);
}

@fragment
fn fs_search(@builtin(position) at: vec4f) -> Term {
  let texel = vec2i(at.xy);
  var lights = 0u;
  for (var light = 0u; light < globals.n_lights; light++) {
    if textureLoad(warp, texel, light, 0).a > 0.0 { lights |= 1u << light; }
  }
  if lights == 0u { return Term(vec4f(0.0), vec4f(0.0)); }
  let receiver = receiver_at(texel);
  var taps = 0u;
  for (var k = 0u; k < globals.n_receivers; k++) {
    let source = (receiver + k) % globals.n_receivers;
    // A set that occurs may still be out of range: then the remaining ones are searched.
    var remaining = seen_sets[source];
    while remaining != 0u {
      let sets = closest_sets(lights, remaining);
      if sets == 0u { break; }
      let found = search(texel, lights, source, sets);
      taps += u32(found.w);
      if found.z == 1 {
        let term = term_at(texel, found.xy, receiver, source != receiver);
        return Term(vec4f(term, f32(label_of(receiver, lights))), vec4f(f32(taps)));
      }
      remaining &= ~sets;
    }
  }
  return Term(vec4f(0.0), vec4f(f32(taps)));
}
