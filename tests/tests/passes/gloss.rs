//! `gloss` on scrambled inputs; and a glossy toy whose highlights move as reflections.

use std::sync::LazyLock;

use app_core::gloss::{Gloss, N_GLOSSES};
use app_core::preset::Preset;
use app_core::scene::Image;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::passes::specular::Specular;
use glam::{DVec2, DVec3, DVec4, UVec2};
use reference::gloss::{Glossy, SeenPoint, reflection};
use reference::model::centre_px;
use reference::raster::{Raster, texels_of};

use crate::alone::{Draw, check_faults, source};
use crate::cores::core_on;
use crate::device::Device;
use crate::errors::Errors;
use crate::numbers::number;
use crate::photo::Photo;
use crate::run::{codes_at, input, scene};
use crate::scrambled::{Scrambled, buffers, views};
use crate::setups::SETUPS;
use crate::stand::Stand;
use app_core::wgpu;

/// Highlights are up to some hundred times as bright as paint, and their exponents up to 200.
const ALLOWED: f64 = 1e-3;
const BOX: PixelRect = PixelRect {
    origin_px: UVec2::new(14, 9),
    size_px: UVec2::new(83, 71),
};
const RADII_RAD: [f64; 2] = [0.02, 0.3];

fn gloss() -> Gloss {
    Gloss {
        roughness: 0.13,
        strengths: [0.6, 0.0, 1.0, 1.7, 0.4, 0.8, 1.2, 2.2],
    }
}

/// The same gloss for the reference.
fn glossy(gloss: &Gloss, radii_rad: &[f64]) -> Glossy {
    Glossy {
        roughness: f64::from(gloss.roughness),
        strengths: gloss.strengths.map(f64::from).to_vec(),
        angular_radii_rad: radii_rad.to_vec(),
    }
}

struct Maps {
    depth: Raster<f64>,
    normal: Raster<DVec4>,
    received: Raster<DVec4>,
    base: Raster<DVec4>,
}

/// A toy of specks, each with another normal.
fn maps(near_m: f64) -> Maps {
    let texel = |seed: u32| {
        move |at: UVec2| {
            DVec4::from([0, 1, 2, 3].map(|k| number(at, seed + k)))
                .as_vec4()
                .as_dvec4()
        }
    };
    Maps {
        depth: Raster::from_fn(BOX.size_px, |at| {
            let depth_m = 0.25 + 0.2 * number(at, 200);
            if number(at, 201) < 0.1 {
                0.0
            } else {
                near_m / depth_m
            }
        }),
        normal: Raster::from_fn(BOX.size_px, |at| {
            let normal = (texel(210)(at).truncate() - DVec3::splat(0.5)).normalize();
            let material = (11.0 * number(at, 214)).floor();
            normal.extend(material).as_vec4().as_dvec4()
        }),
        received: Raster::from_fn(BOX.size_px, |at| {
            texel(220)(at).map(|value| if value < 0.2 { 0.0 } else { value })
        }),
        base: Raster::from_fn(BOX.size_px, texel(230)),
    }
}

/// The point at a texel of the box, for a known depth along the camera's axis.
fn seen_point(scene: &Scrambled, maps: &Maps, texel: UVec2, near_m: f64) -> SeenPoint {
    let stand = &scene.stand;
    let (origin, direction) =
        stand.camera_ray((scene.rect.origin_px + BOX.origin_px).as_dvec2() + centre_px(texel));
    let axis = (stand.anchor_from_world * stand.camera.world_from_camera).transform_vector3(DVec3::NEG_Z);
    let depth_m = near_m / maps.depth.at(texel);
    let surface = maps.normal.at(texel);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    let material = surface.w as usize;
    SeenPoint {
        in_anchor: origin + depth_m / direction.dot(axis) * direction,
        normal: surface.truncate(),
        camera_in_anchor: origin,
        material,
        received: maps.received.at(texel),
    }
}

fn errors(source: &str) -> Errors {
    let (device, scene) = (Device::shared(), Scrambled::new());
    let globals = scene.stand.globals(&scene.rect).with_boxes(&BOX, &BOX);
    let near_m = f64::from(globals.clip_from_anchor[3][2]);
    let maps = maps(near_m);
    let seen = scene.seen(device);
    let boxed = device.uniform(&globals);
    let mut shared = seen.bindings();
    shared[0].1 = boxed.as_entire_binding();
    let specular = [device.uniform(&Specular::new(&gloss(), RADII_RAD.into_iter()))];
    let views_of = [
        device.map(&maps.normal),
        device.map(&maps.received),
        device.map(&maps.base),
    ];
    let depth = device.depth(&maps.depth);
    let mut own = buffers(0, &specular);
    own.push((1, wgpu::BindingResource::TextureView(&depth)));
    own.extend(views(2, &views_of));
    let actual = device.draw(Draw::of(source, "fs_reflect", BOX.size_px), [&shared, &own]);
    let reference = glossy(&gloss(), &RADII_RAD);
    let pairs = texels_of(BOX.size_px).flat_map(|texel| {
        let expected = if maps.depth.at(texel) == 0.0 {
            DVec4::W
        } else {
            let point = seen_point(&scene, &maps, texel, near_m);
            let shown = scene.image.at(BOX.origin_px + texel).truncate();
            let columns = reference.columns(&scene.region, &point);
            let base = maps.base.at(texel).truncate();
            reflection(&scene.solution, &columns, &point, (base, shown))
        };
        let actual = actual.at(texel);
        // The error of a highlight that is brighter than white is relative to itself.
        let scale = 1.0_f64.max(expected.truncate().max_element());
        let colors = (0..3).map(move |channel| (actual[channel] / scale, expected[channel] / scale));
        colors.chain([(actual.w, expected.w)])
    });
    Errors::between(pairs.collect::<Vec<_>>())
}

#[test]
fn what_a_glossy_toy_reflects() {
    errors(&source("gloss")).check_all("gloss", ALLOWED);
}

#[test]
fn a_fault_in_the_reflection_is_found() {
    let faults = [
        (
            "STRAIGHT_REFLECTANCE: f32 = 0.04",
            "STRAIGHT_REFLECTANCE: f32 = 0.05",
        ),
        ("HORIZON_SLOPE: f32 = 2.5", "HORIZON_SLOPE: f32 = 2.0"),
        ("2.0 / lobe - 2.0", "2.0 / lobe - 1.0"),
        ("min(material, N_GLOSSES - 1u)", "min(material, 3u)"),
        ("specular.lobes[i]", "specular.lobes[0]"),
        ("reflect(-to_camera, normal).y", "normal.y"),
        (
            "cosines.x * masked.y + cosines.y * masked.x",
            "cosines.x * masked.x + cosines.y * masked.y",
        ),
        (
            "part * fit.toy[2u + i].rgb * fit.intensity[i].rgb",
            "part * fit.toy[2u + i].rgb",
        ),
        (
            "return part.x * fit.toy[0].rgb + part.y * fit.toy[1].rgb",
            "return part.x * fit.toy[0].rgb + part.y * fit.toy[0].rgb",
        ),
        ("frame_at(region_texel(texel))", "frame_at(texel)"),
        ("PAINT_TOLD: f32 = 0.5", "PAINT_TOLD: f32 = 0.4"),
        ("CLIPPED_HIGHLIGHT: f32 = 0.1", "CLIPPED_HIGHLIGHT: f32 = 0.3"),
        ("at.xy + globals.physical_box_origin_px", "at.xy"),
    ];
    check_faults("gloss", &faults, ALLOWED, errors);
}

/// Difference in codes of the toy, away from its outline, from a photograph of its shown pose, if
/// the core uses that gloss.
fn error_of_shown(photo: &Photo, told: Gloss) -> (f64, Image) {
    let stand = Stand::new(SETUPS[0]);
    let mut core = core_on(scene(&stand, &photo.plate(&stand)), Preset::Balanced).unwrap();
    let frame = photo.frame(&stand, &stand.physical);
    core.frame(&input(&stand, &frame).with_gloss(told)).unwrap();
    let picture = core.read_picture().unwrap();
    let expected = photo.frame(&stand, &stand.shown);
    let shown = stand.occluder(&stand.shown);
    let around = [DVec2::ZERO, DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(|offset| 2.0 * offset);
    let is_toy = |at: DVec2| {
        let (origin, direction) = stand.camera_ray(at);
        shown.nearest(origin, direction).is_some()
    };
    let inside = texels_of(stand.setup.image_px)
        .filter(|texel| around.iter().all(|offset| is_toy(centre_px(*texel) + *offset)));
    let pairs = inside.flat_map(|texel| codes_at(&picture, &expected, texel));
    (Errors::between(pairs).mean(), picture)
}

/// Uniform gloss of lacquer, rough enough to be visible on the faces of boxes.
const LACQUER: Gloss = Gloss {
    roughness: 0.4,
    strengths: [2.5; N_GLOSSES],
};

static GLOSSY_PHOTO: LazyLock<Photo> = LazyLock::new(|| Photo {
    gloss: Some(LACQUER),
    ..Photo::plain(SETUPS[0].lights.len())
});

#[test]
fn highlights_move_as_reflections() {
    let (as_paint, _) = error_of_shown(&GLOSSY_PHOTO, Gloss::NONE);
    let (as_reflection, _) = error_of_shown(&GLOSSY_PHOTO, LACQUER);
    // Surfaces that were hidden, or are drawn at grazing angles, have errors even without gloss.
    let (of_matt, _) = error_of_shown(&Photo::plain(SETUPS[0].lights.len()), Gloss::NONE);
    assert!(
        as_reflection - of_matt < 0.5 * (as_paint - of_matt),
        "{as_reflection} codes, {as_paint} where highlights are taken for paint, and {of_matt} of a matt toy"
    );
}

/// Zero strength equals no gloss, to the last bit, for every roughness; a wrong strength increases
/// the error.
#[test]
fn a_matt_toy_stays_as_it_is() {
    let matt = Photo::plain(SETUPS[0].lights.len());
    let (error, plain) = error_of_shown(&matt, Gloss::NONE);
    let none = Gloss {
        roughness: 0.2,
        ..Gloss::NONE
    };
    let (_, told) = error_of_shown(&matt, none);
    assert_eq!(plain.rgba8, told.rgba8);
    let (glossy_error, glossy) = error_of_shown(&matt, LACQUER);
    assert_ne!(plain.rgba8, glossy.rgba8);
    assert!(
        glossy_error > error,
        "{glossy_error} codes, and {error} of a matt toy"
    );
}
