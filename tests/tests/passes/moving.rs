//! A moving camera: the estimates of the place stay, and are extended.

use std::sync::Arc;

use app_core::core::Core;
use app_core::preset::Preset;
use app_core::scene::{Image, Scene};
use app_pipeline::core::inspect::Inspect;
use glam::{DVec2, DVec3, DVec4};
use reference::grid::PlaneGrid;

use crate::cores::{SharedCore, core_on};
use crate::photo::Photo;
use crate::run::{input, plate_of, raster, scene};
use crate::setups::{SETUPS, Setup};
use crate::stand::Stand;

/// Viewpoints, as offsets from the target: two of them see the area that the toy hides from the
/// third.
const VIEWS: [DVec3; 3] = [
    DVec3::new(-0.38, 0.42, 0.05),
    DVec3::new(-0.3, 0.45, 0.2),
    DVec3::new(0.2, 0.25, 0.38),
];
/// A position on the table that the toy hides from the third camera.
const BEHIND_TOY: DVec2 = DVec2::new(-0.055, -0.07);

fn setup() -> Setup {
    Setup {
        image_px: SETUPS[0].image_px * 2,
        ..SETUPS[0]
    }
}

/// The colour of the table's reflection there.
fn reflection(point: reference::model::ReceiverPoint) -> DVec3 {
    let from_middle = point.in_plane - BEHIND_TOY;
    0.05 * (-from_middle.length_squared() / 0.0008).exp() * DVec3::new(1.0, 0.7, 0.3)
}

struct Shots {
    stands: [Stand; 3],
    frames: [Arc<Image>; 3],
    scene: Scene,
}

fn shots() -> Shots {
    let stands = VIEWS.map(|offset| Stand::seen_from(setup(), offset));
    let photo = Photo {
        unmodelled: reflection,
        ..Photo::plain(setup().lights.len())
    };
    let plates = stands.iter().map(|stand| plate_of(stand, &photo.plate(stand)));
    let frames = stands.each_ref().map(|stand| photo.frame(stand, &stand.physical));
    Shots {
        scene: scene(&stands[0], &frames[0]).with_plates(plates.collect()),
        stands,
        frames,
    }
}

impl Shots {
    /// A core that has processed some of the views.
    fn core(&self, views: &[usize]) -> SharedCore {
        let mut core = core_on(self.scene.clone(), Preset::Balanced).unwrap();
        for view in views {
            let report = core
                .frame(&input(&self.stands[*view], &self.frames[*view]))
                .unwrap();
            assert_eq!(report.warnings, [], "view {view}");
            assert!(
                report.ran.iter().any(|run| run.pass == "fit"),
                "view {view} is not learned from"
            );
        }
        core
    }
}

/// The residual on the table at a point.
fn residual_at(core: &Core, in_plane: DVec2) -> DVec3 {
    let (grid, cells) = &core.read_residuals().unwrap()[0];
    let grid = PlaneGrid::from(grid);
    grid.value_at(&raster(cells).map(DVec4::truncate), in_plane)
}

#[test]
fn what_an_earlier_view_showed_is_known_where_the_latest_does_not_show_it() {
    let shots = shots();
    let hidden = shots.stands[2].region(&shots.stands[2].whole_image()).receivers[0]
        .region_px(BEHIND_TOY)
        .unwrap();
    let (origin, direction) = shots.stands[2].camera_ray(hidden);
    let occluder = shots.stands[2].occluder(&shots.stands[2].physical);
    assert!(
        occluder.nearest(origin, direction).is_some(),
        "the third view shows it"
    );

    let expected = DVec3::new(0.05, 0.035, 0.015);
    let before = shots.core(&[0, 1]);
    let after = shots.core(&[0, 1, 2]);
    let alone = shots.core(&[2]);
    let at = [&before, &after, &alone].map(|core| residual_at(core, BEHIND_TOY));
    eprintln!("{at:?}");
    let grids = [&before, &after].map(|core| core.read_residuals().unwrap()[0].0);
    assert_eq!(grids[0], grids[1], "the place was learned from nothing");
    assert!((at[0] - expected).abs().max_element() < 0.01, "{}", at[0]);
    assert!(
        (at[1] - at[0]).abs().max_element() < 0.003,
        "{} became {}",
        at[0],
        at[1]
    );
    assert!(
        (at[2] - expected).abs().max_element() > 0.02,
        "one view alone knows it: {}",
        at[2]
    );
}

#[test]
fn the_same_frame_twice_is_the_same_picture() {
    let shots = shots();
    let mut core = shots.core(&[0, 1, 2]);
    let first = core.read_picture().unwrap();
    let report = core.frame(&input(&shots.stands[2], &shots.frames[2])).unwrap();
    assert!(
        report
            .skipped
            .iter()
            .any(|left_out| left_out.what == "capture path")
    );
    assert!(core.read_picture().unwrap() == first);
}
