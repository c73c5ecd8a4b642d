// Solution of the least-squares fits to the real shadow and the real toy.

//#import common/globals

const N_COLUMNS: u32 = 6u;

struct ReceiverFit {
  // Light that the toy reflects at places where it occludes ambient light, as a fraction of that
  // light.
  bounce: vec4f,
  // Each light's fraction of the plate's radiance at the reference point.
  direct_fraction: array<vec4f, MAX_LIGHTS>,
  // Part of the energy of the plate's column from pixels that are clipped in frame and plate: 1 if
  // no other is visible.
  clipped: vec4f,
}

struct Fit {
  // Ratio of frame to plate in unchanged pixels: the exposure between the two.
  gain: vec4f,
  // Each light's power relative to the time of the plate.
  intensity: array<vec4f, MAX_LIGHTS>,
  receivers: array<ReceiverFit, MAX_RECEIVERS>,
  // Radiance of the toy relative to base colour and gain: light from above, from below, and a
  // factor for each light's cosine.
  toy: array<vec4f, N_COLUMNS>,
}

@group(0) @binding(1) var<storage, read> fit: Fit;
