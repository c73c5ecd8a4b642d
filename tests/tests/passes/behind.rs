//! A receiver that is seen from behind does not count: information exists where its front is
//! visible, and where light falls on the front.

use app_core::preset::Preset;
use app_pipeline::geometry::view::View;
use glam::{DVec2, DVec3, UVec2};
use reference::model::{Region, centre_px};
use reference::raster::texels_of;

use crate::composite::shows_toy;
use crate::cores::core_on;
use crate::photo::Photo;
use crate::run::{input, plate_of, scene, texel_of};
use crate::setups::{Setup, WALL};
use crate::stand::Stand;

/// Viewpoint over the toy, and viewpoint over the wall from behind it.
const BEFORE: DVec3 = DVec3::new(0.1, 0.3, 0.4);
const BEHIND: DVec3 = DVec3::new(0.12, 0.3, -0.42);
/// Distance from the toy within which a pixel may have the toy's colour, and the table that of the
/// toy's seam.
const BESIDE_PX: f64 = 3.0;

const SETUP: Setup = WALL.of_size(195, 131);

/// Texels that show the back of the wall, away from its end and from the toy in both poses.
fn texels_of_back(stand: &Stand, region: &Region) -> Vec<UVec2> {
    let toys = [&stand.physical, &stand.shown].map(|posed| shows_toy(stand, posed, &stand.whole_image()));
    let end = region.size_px.as_dvec2() - 1.0;
    let is_back = |at: DVec2| {
        let texel = at.clamp(DVec2::ZERO, end).as_uvec2();
        let surface = region.surface_point(at);
        surface.is_some_and(|point| point.receiver == 1) && toys.iter().all(|toy| !toy.at(texel))
    };
    let steps = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y, DVec2::ZERO];
    let is_amid = |texel: &UVec2| {
        let around = steps.map(|step| centre_px(*texel) + BESIDE_PX * step);
        around.into_iter().all(is_back)
    };
    texels_of(region.size_px).filter(is_amid).collect()
}

/// The light on the wall is known from its front.
#[test]
fn nothing_moves_on_the_back_of_a_wall() {
    let before = Stand::seen_from(SETUP, BEFORE);
    let behind = Stand::seen_from(SETUP, BEHIND);
    let photo = Photo::plain(2);
    let shots = [&before, &behind].map(|stand| photo.frame(stand, &stand.physical));
    let with_plates = scene(&before, &shots[0]).with_plates(vec![
        plate_of(&before, &photo.plate(&before)),
        plate_of(&behind, &photo.plate(&behind)),
    ]);
    let back = texels_of_back(&behind, &behind.region(&behind.whole_image()));
    assert!(back.len() > 1000, "{} pixels of the back are seen", back.len());
    for preset in [Preset::Balanced, Preset::Paper, Preset::Flat] {
        let mut core = core_on(with_plates.clone(), preset).unwrap();
        core.frame(&input(&before, &shots[0])).unwrap();
        core.frame(&input(&behind, &shots[1])).unwrap();
        let picture = core.read_picture().unwrap();
        let changed = back
            .iter()
            .filter(|texel| texel_of(&picture, **texel) != texel_of(&shots[1], **texel));
        let n_changed = changed.count();
        eprintln!(
            "{preset}: {n_changed} of {} pixels of the back changed",
            back.len()
        );
        assert_eq!(n_changed, 0, "{preset}");
    }
}

#[test]
fn the_side_is_told_from_the_camera_and_from_the_homography_alike() {
    for offset in [BEHIND, BEFORE] {
        let stand = Stand::seen_from(SETUP, offset);
        let region = stand.region(&stand.whole_image());
        let view: View = stand.view();
        let told = stand
            .receivers
            .iter()
            .map(|receiver| view.sees_front_of(&receiver.world_from_plane));
        let shown = region.receivers.iter().map(|plane| plane.shows_front());
        assert!(told.clone().eq(shown), "{offset}");
        assert!(told.eq([true, offset.z > 0.0]), "{offset}");
    }
}
