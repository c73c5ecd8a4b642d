// Which sets of lights are shadowed anywhere in mask 3c, so that no search looks for what is nowhere.
//
// Reads: mask 3c. Writes: bit s of the word where the set s occurs; the word starts at 0.
// Twin: reference/census.rs.

@group(1) @binding(0) var eligible: texture_2d<u32>;
@group(1) @binding(1) var<storage, read_write> seen_sets: atomic<u32>;

var<workgroup> seen_here: atomic<u32>;

@compute @workgroup_size(16, 16)
fn cs_count(@builtin(global_invocation_id) texel: vec3u, @builtin(local_invocation_index) local: u32) {
  if all(texel.xy < textureDimensions(eligible)) {
    let lights = textureLoad(eligible, texel.xy, 0).r;
    if lights != 0u { atomicOr(&seen_here, 1u << lights); }
  }
  workgroupBarrier();
  if local == 0u { atomicOr(&seen_sets, atomicLoad(&seen_here)); }
}
