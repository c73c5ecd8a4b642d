// Specular reflection of the toy: one lobe of a rough dielectric.
//
// It reflects the light that the fit estimates from the diffuse reflection, so only roughness and
// strength are new. The importing shader declares `specular`.
// Source: Blinn 1977 (lobe), Walter et al. 2007 (its exponent from the slope of facets), Schlick
// 1994 (Fresnel), Hammon 2017 (shadowing).

//#import common/fit
//#import common/reflectance

struct Specular {
  // Squared roughness of each light's lobe, widened by the light's size.
  lobes: vec4f,
  // Strength of each material, relative to a dielectric of refractive index 1.5; later ones share
  // the last.
  strengths: array<vec4f, 2>,
  roughness: f32,
  _pad_0: f32,
  _pad_1: vec2f,
}

const N_GLOSSES: u32 = 8u;
// Slope of the transition from the light below to that above as the mirrored direction rises.
const HORIZON_SLOPE: f32 = 2.5;
// Smaller cosines are clamped: interpolated normals turn away from a camera that sees the surface.
const LEAST_COSINE: f32 = 0.05;

fn strength_of(material: u32) -> f32 {
  let index = min(material, N_GLOSSES - 1u);
  return specular.strengths[index / 4u][index % 4u];
}

fn direction_to_camera(in_anchor: vec3f) -> vec3f {
  return normalize(globals.camera_in_anchor - in_anchor);
}

// Radiance reflected from the ambient light from above and from below, at strength 1.
fn reflected_ambient(normal: vec3f, to_camera: vec3f) -> vec2f {
  let view_cosine = max(dot(normal, to_camera), LEAST_COSINE);
  let above = saturate(0.5 + HORIZON_SLOPE * reflect(-to_camera, normal).y);
  return even_reflectance(view_cosine, sqrt(specular.roughness)) * vec2f(above, 1.0 - above);
}

// Radiance reflected from light `i`, at strength 1, relative to a white matt surface.
fn reflected_light(i: u32, normal: vec3f, to_camera: vec3f, in_anchor: vec3f) -> f32 {
  let light = globals.lights[i];
  let between = light.xyz - in_anchor * light.w;
  if all(between == vec3f(0.0)) { return 0.0; }
  let to_light = normalize(between);
  let sum = to_camera + to_light;
  if all(sum == vec3f(0.0)) { return 0.0; }
  let half_way = normalize(sum);
  let lobe = specular.lobes[i];
  let exponent = 2.0 / lobe - 2.0;
  let distribution = 0.5 * (exponent + 2.0) * pow(saturate(dot(normal, half_way)), exponent);
  let fresnel = STRAIGHT_REFLECTANCE + (1.0 - STRAIGHT_REFLECTANCE) * pow(1.0 - saturate(dot(to_light, half_way)), 5.0);
  let cosines = max(vec2f(dot(normal, to_light), dot(normal, to_camera)), vec2f(LEAST_COSINE));
  let masked = mix(cosines, vec2f(1.0), sqrt(lobe));
  // Half the distribution over pi, times pi, divided by the masking of both directions: Hammon's
  // form of Smith's shadowing.
  return 0.5 * distribution * fresnel / (cosines.x * masked.y + cosines.y * masked.x);
}

// Radiance relative to the gain that a surface of the toy reflects from all lights, at strength 1.
fn reflected_of_lights(normal: vec3f, in_anchor: vec3f, received: vec4f) -> vec3f {
  let to_camera = direction_to_camera(in_anchor);
  var sum = vec3f(0.0);
  for (var i = 0u; i < globals.n_lights; i++) {
    if received[i] == 0.0 { continue; }
    let part = received[i] * reflected_light(i, normal, to_camera, in_anchor);
    sum += part * fit.toy[2u + i].rgb * fit.intensity[i].rgb;
  }
  return sum;
}

// The same for the ambient light.
fn reflected_of_ambient(normal: vec3f, in_anchor: vec3f) -> vec3f {
  let part = reflected_ambient(normal, direction_to_camera(in_anchor));
  return part.x * fit.toy[0].rgb + part.y * fit.toy[1].rgb;
}
