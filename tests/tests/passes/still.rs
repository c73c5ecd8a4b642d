//! A still part of the toy beside a part that moves: its pixels are the camera's.

use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::sharpness::{Sharpness, Spread};
use app_core::toy::PosedMesh;
use glam::{DVec3, IVec2, UVec2};
use reference::model::{ReceiverPoint, centre_px};
use reference::raster::texels_of;

use crate::device::Device;
use crate::photo::Photo;
use crate::run::{Run, texel_of};
use crate::setups::SETUPS;
use crate::stand::Stand;

/// Distance in pixels within which the toy is still, beyond the reach of the picture's spread.
const STILL_PX: i32 = 5;
/// Distance within which the light is the same, beyond the spread of the light.
const LIT_ALIKE_PX: i32 = 2;

/// Positions within a distance of a texel, rows and columns.
fn around(texel: UVec2, reach_px: i32) -> impl Iterator<Item = UVec2> {
    let steps = move || -reach_px..=reach_px;
    let offsets = steps().flat_map(move |y| steps().map(move |x| IVec2::new(x, y)));
    offsets.map(move |offset| (texel.as_ivec2() + offset).as_uvec2())
}

/// The triangle of the toy that a camera sees at a pixel of its picture, and its distance.
fn seen(stand: &Stand, posed: &PosedMesh, texel: UVec2) -> Option<(usize, f64)> {
    let (origin, direction) = stand.camera_ray(centre_px(texel));
    let hit = stand.occluder(posed).nearest(origin, direction)?;
    Some((hit.triangle, hit.distance))
}

/// A shadow that moves over a still part of a soft picture changes the pixels that it reaches, and none
/// of those beside them.
#[test]
fn pixels_beside_a_moved_shadow_are_the_cameras() {
    let spread = Spread::round(1.0);
    let sharpness = Sharpness {
        plate_spread: spread,
        outline_spread: spread,
    };
    let stand = Stand::new(SETUPS[0].twice());
    let photo = Photo::plain(stand.setup.lights.len());
    let frame = photo.frame(&stand, &stand.physical);
    let shown = photo.frame(&stand, &stand.shown);
    let pictures = [photo.plate(&stand), frame.clone()];
    let decoded = Device::shared().decoded();
    let run = Run::of(Preset::Balanced, (stand, sharpness), pictures, &decoded).unwrap();
    let is_still = |at: UVec2| {
        let before = seen(&run.stand, &run.stand.physical, at);
        before.is_some() && before == seen(&run.stand, &run.stand.shown, at)
    };
    let is_alike = |at: UVec2| texel_of(&frame, at) == texel_of(&shown, at);
    let (mut n_beside, mut worst) = (0, 0);
    for texel in texels_of(run.region.size_px) {
        let at = run.plan.region.origin_px + texel;
        if !is_still(at) {
            continue;
        }
        let is_lit_alike = around(at, LIT_ALIKE_PX).all(is_alike);
        if !is_lit_alike || around(at, STILL_PX).all(is_alike) || !around(at, STILL_PX).all(is_still) {
            continue;
        }
        n_beside += 1;
        let (own, made) = (texel_of(&frame, at), run.picture.at(texel));
        worst = (0..3).map(|c| own[c].abs_diff(made[c])).fold(worst, u8::max);
    }
    assert!(n_beside > 50, "{n_beside} pixels beside a moved shadow");
    assert!(worst <= 1, "{worst} codes beside a moved shadow");
}

/// Light of a colour of its own on the table around the toy's feet, in plates.
fn red_spot(point: ReceiverPoint) -> DVec3 {
    let from_middle = point.in_plane.length();
    DVec3::new(0.8, -0.05, 0.0) * f64::from(u8::from(from_middle < 0.09))
}

/// Pixels of the receiver too near to a still part of the toy to be evidence, and their largest change.
fn changes_beside_still_toy(run: &Run, frame: &Image) -> Vec<(UVec2, u8)> {
    let is_same =
        |at: UVec2| seen(&run.stand, &run.stand.physical, at) == seen(&run.stand, &run.stand.shown, at);
    let is_free = |at: UVec2| seen(&run.stand, &run.stand.physical, at).is_none();
    let beside = texels_of(run.region.size_px).filter(|texel| {
        let at = run.plan.region.origin_px + *texel;
        run.pictures.seen.at(*texel) == 0.0 && around(at, 1).all(is_free) && around(at, STILL_PX).all(is_same)
    });
    let change = |texel: UVec2| {
        let (own, made) = (
            texel_of(frame, run.plan.region.origin_px + texel),
            run.picture.at(texel),
        );
        (0..3).map(|c| own[c].abs_diff(made[c])).fold(0, u8::max)
    };
    beside.map(|texel| (texel, change(texel))).collect()
}

/// An object that no model explains has its pixels beside a still toy, too, although the ambient light
/// there changes with the rest of the toy.
#[test]
fn an_unexplained_object_beside_a_still_toy_keeps_its_pixels() {
    let decoded = Device::shared().decoded();
    let changes = |unmodelled: fn(ReceiverPoint) -> DVec3| {
        let stand = Stand::new(SETUPS[0].twice());
        let photo = Photo {
            unmodelled,
            ..Photo::plain(stand.setup.lights.len())
        };
        let (plate, frame) = (photo.plate(&stand), photo.frame(&stand, &stand.physical));
        let run = Run::new(stand, [plate, frame.clone()], &decoded).unwrap();
        changes_beside_still_toy(&run, &frame)
    };
    let (table, object) = (changes(|_| DVec3::ZERO), changes(red_spot));
    let n_changed = table.iter().filter(|(_, change)| *change >= 2).count();
    let worst = object.iter().map(|(_, change)| *change).max().unwrap();
    eprintln!(
        "{} pixels, {n_changed} of a table change; of an object at most by {worst}",
        table.len()
    );
    assert!(n_changed > 8, "{n_changed} of {} pixels change", table.len());
    assert!(worst <= 1, "{worst} codes of an object");
}
