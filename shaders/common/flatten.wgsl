// Projection of a point from a light onto a receiver, and the clip position of its shadow. Source: Blinn 1988.

//#import common/globals

// Homogeneous (x, z, w): the line from the light through the point meets y = 0 at (x, z) / w. w is the height of the
// light above the point; nothing is divided here, since the rasteriser clips points above the light.
fn flatten(light: vec4f, in_plane: vec3f) -> vec3f {
  return vec3f(light.y * in_plane.xz - in_plane.y * light.xz, light.y - light.w * in_plane.y);
}

// Clip position of a flattened point: 0 <= z keeps points in front of the camera, z <= w points below the light.
fn clip_from_flattened(receiver: u32, shadow: vec3f) -> vec4f {
  let at = globals.receivers[receiver].clip_from_plane * shadow;
  return vec4f(at.xy, at.z - globals.near_m * shadow.z, at.z);
}
