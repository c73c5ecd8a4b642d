// Solution of the least-squares fits to the real shadow and the real toy.

//#import common/globals

const N_COLUMNS: u32 = 6u;

struct ReceiverFit {
  // Light reflected by the toy where it occludes ambient light, as a fraction of that light.
  bounce: vec4f,
  // Each light's fraction of the plate's radiance at the reference point.
  direct_fraction: array<vec4f, MAX_LIGHTS>,
  // Part of the energy of the plate's column that pixels give which are clipped in frame and plate: 1 where no other is
  // seen.
  clipped: vec4f,
}

struct Fit {
  // Frame over plate where nothing changed: the exposure between the two.
  gain: vec4f,
  // Each light's power over that when the plate was taken.
  intensity: array<vec4f, MAX_LIGHTS>,
  receivers: array<ReceiverFit, MAX_RECEIVERS>,
  // Radiance of the toy over its base colour and the gain: light from above, from below, a factor per light's cosine.
  toy: array<vec4f, N_COLUMNS>,
}

@group(0) @binding(1) var<storage, read> fit: Fit;
