// Sets of lights whose shadows occur in mask 3c, so that `search` skips the others.
//
// Reads: eligible (mask 3c). Writes: seen_sets, one word per receiver, in which bit s is set if the
// set s occurs; the words start at 0.
// CPU reference: tests/reference/src/census.rs.

//#import common/baseline

@group(1) @binding(0) var eligible: texture_2d<u32>;
@group(1) @binding(1) var<storage, read_write> seen_sets: array<atomic<u32>, MAX_RECEIVERS>;

var<workgroup> seen_here: array<atomic<u32>, MAX_RECEIVERS>;

@compute @workgroup_size(16, 16)
fn cs_count(@builtin(global_invocation_id) texel: vec3u, @builtin(local_invocation_index) local: u32) {
  if all(texel.xy < textureDimensions(eligible)) {
    let label = textureLoad(eligible, texel.xy, 0).r;
    if label != 0u && label < MAX_RECEIVERS * N_SETS { atomicOr(&seen_here[label / N_SETS], 1u << (label % N_SETS)); }
  }
  workgroupBarrier();
  if local < MAX_RECEIVERS { atomicOr(&seen_sets[local], atomicLoad(&seen_here[local])); }
}
