// A point flattened from a light onto a receiver, and where the camera sees its shadow. Source: Blinn 1988.

// Depth in metres nearer than which a flattened point is cut off.
const NEAR_M: f32 = 0.01;

// Homogeneous (x, z, w): the line from the light through the point meets y = 0 at (x, z) / w. w is the height by which the
// light is above the point; nothing is divided here, since a point above the light is for the rasteriser to clip.
fn flatten(light: vec4f, in_plane: vec3f) -> vec3f {
  return vec3f(light.y * in_plane.xz - in_plane.y * light.xz, light.y - light.w * in_plane.y);
}

// Clip position of a flattened point: 0 <= z keeps what the camera has in front of it, z <= w what the light has below it.
fn clip_from_flattened(receiver: u32, shadow: vec3f) -> vec4f {
  let at = globals.receivers[receiver].clip_from_plane * shadow;
  return vec4f(at.xy, at.z - NEAR_M * shadow.z, at.z);
}
