//! Which passes a plan runs on which path, with which sizes and formats.

use app_core::frame::Path;
use app_core::preset::BALANCED;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::model::plan::Plan;
use app_pipeline::model::planned as planned_by_model;
use app_pipeline::plan::{Change, SceneFacts};
use glam::UVec2;

/// Sizes of regions, from a pixel to more than any camera.
const SIZES_PX: [[u32; 2]; 12] = [
    [1, 1],
    [1, 2],
    [2, 1],
    [63, 65],
    [64, 64],
    [65, 64],
    [641, 359],
    [1125, 2436],
    [8000, 6000],
    [8192, 8192],
    [8192, 1],
    [15, 8191],
];

fn plan(size_px: [u32; 2], n_lights: usize) -> Plan {
    plan_with(size_px, vec![0.0; n_lights])
}

fn plan_with(size_px: [u32; 2], penumbrae_px: Vec<f64>) -> Plan {
    Plan::new(&facts_with(size_px, penumbrae_px), &BALANCED)
}

fn facts_with(size_px: [u32; 2], penumbrae_px: Vec<f64>) -> SceneFacts {
    let region = PixelRect {
        origin_px: UVec2::new(3, 7),
        size_px: size_px.into(),
    };
    SceneFacts {
        region,
        physical_toy: Some(region),
        toy_box: Some(region),
        physical_box: Some(region),
        pixel_in_object: 0.0,
        penumbrae_px,
        n_receivers: 2,
        is_plate_complete: false,
        are_plates_scaled: false,
    }
}

fn leaves_out(plan: &Plan, what: &str) -> bool {
    assert!(plan.left_out.iter().all(|left_out| !left_out.why.is_empty()));
    plan.left_out.iter().any(|left_out| left_out.what == what)
}

#[test]
fn a_new_pose_costs_the_frame_path_alone() {
    let plan = plan([640, 360], 2);
    // Both lights at once, and the ambient light.
    let light = ["occlusion"; 2];
    let drawn = ["self_shadow", "moved_mask", "toy", "coverage", "composite"];
    let frame = light.into_iter().chain(drawn);
    let frame: Vec<_> = frame.map(|pass| (Path::Frame, pass)).collect();
    assert_eq!(planned_by_model(&plan, Change::Pose, 0), frame);
    for change in Change::ALL {
        let planned = planned_by_model(&plan, change, 0);
        assert!(planned.ends_with(&frame), "{change:?}: {planned:?}");
        let before = &planned[..planned.len() - frame.len()];
        assert!(
            before
                .iter()
                .all(|(path, _)| (*path == Path::Capture) == (change >= Change::View))
        );
    }
}

/// Each pass comes after those whose results it reads.
#[test]
fn the_capture_path_reads_what_was_made_before() {
    let plan = plan([640, 360], 1);
    for change in [Change::View, Change::Scene] {
        let planned = planned_by_model(&plan, change, 0);
        let place = |name: &str| planned.iter().position(|(_, pass)| *pass == name).unwrap();
        for order in [
            &[
                "self_shadow",
                "gbuffer",
                "validity",
                "fit",
                "fit_solve",
                "appearance",
            ][..],
            &["occlusion", "fit", "fit_solve", "residual", "tint"],
            &["plate", "lit", "fill", "estimate", "residual"],
            &["plate", "lit"],
            &["tint", "tint_fill"],
        ] {
            assert!(
                order.is_sorted_by_key(|name| place(name)),
                "{order:?} in {planned:?}"
            );
        }
    }
}

#[test]
fn further_lights_are_left_out() {
    for n_lights in 1..=6 {
        let plan = plan([640, 360], n_lights);
        assert_eq!(plan.n_lights, n_lights.min(4), "the fifth is left out");
        assert_eq!(leaves_out(&plan, "overlap of shadows"), n_lights == 1);
    }
}

#[test]
fn a_wide_penumbra_and_a_hard_edge_are_drawn_from_more_points() {
    let plan = plan_with([640, 360], vec![4.0, 4.1, 32.0, 32.1]);
    assert_eq!(plan.n_light_points, [64, 32, 32, 64]);
    let plan = plan_with([640, 360], vec![0.0, f64::INFINITY]);
    assert_eq!(plan.n_light_points, [64, 64]);
}

/// A camera that sways about a threshold leaves a light as many points as it had.
#[test]
fn a_penumbra_that_is_nearly_as_wide_counts_as_it_was() {
    let facts = |width_px| facts_with([640, 360], vec![width_px]);
    let n_points = |known_px: f64, width_px| {
        let steadied = facts(width_px).steadied(&[known_px]);
        Plan::new(&steadied, &BALANCED).n_light_points[0]
    };
    assert_eq!([n_points(31.0, 33.0), n_points(33.0, 31.0)], [32, 64]);
    assert_eq!([n_points(31.0, 40.0), n_points(33.0, 26.0)], [64, 32]);
    assert_eq!(
        [n_points(31.0, f64::INFINITY), n_points(f64::INFINITY, 31.0)],
        [64, 32]
    );
    assert_eq!([n_points(0.0, 5.0), n_points(5.0, 0.0)], [32, 64]);
    // And if not, nothing is made anew for it.
    let [few, many] = [8.0, 80.0].map(|width_px| plan_with([640, 360], vec![width_px]));
    assert!(few.has_sizes_of(&many));
}

#[test]
fn a_scene_without_lights_has_nothing_to_overlap() {
    let plan = plan([640, 360], 0);
    assert!(plan.n_lights == 0 && leaves_out(&plan, "overlap of shadows"));
}

#[test]
fn ambient_maps_cover_the_region() {
    let divisor = BALANCED.ambient_divisor;
    for size_px in SIZES_PX {
        let plan = plan(size_px, 1);
        assert_eq!(plan.region.size_px.to_array(), size_px);
        for (n_texels, side_px) in plan.ambient_px.to_array().into_iter().zip(size_px) {
            let covered = n_texels * divisor;
            assert!(
                covered >= side_px && covered < side_px + divisor,
                "{size_px:?}: {n_texels} of {divisor}"
            );
        }
    }
}

#[test]
fn the_fit_takes_enough_pixels_and_not_many() {
    for size_px in SIZES_PX {
        let plan = plan(size_px, 1);
        let [width, height] = size_px.map(|side_px| u64::from(side_px / plan.fit_stride_px));
        let (n_taken, n_pixels) = (width * height, u64::from(size_px[0]) * u64::from(size_px[1]));
        // The next smaller stride would be too many: at most one in four is lost by that, and as much by rounding.
        assert!(n_taken <= 1 << 16, "{size_px:?}: {n_taken}");
        assert!(n_taken >= n_pixels.min(1 << 16) / 8, "{size_px:?}: {n_taken}");
        let n_rows = plan.n_fit_rows(plan.fit_stride_px);
        assert!((1..=16).contains(&n_rows));
        assert!(
            u64::from(n_rows - 1) * 16 * 256 < n_taken,
            "{size_px:?}: a workgroup without work"
        );
        // For gain and intensities a quarter of them, but not of a small region.
        let [width, height] = size_px.map(|side_px| u64::from(side_px / plan.intensity_fit_stride_px));
        let n_for_gain = width * height;
        assert!(n_for_gain <= 1 << 14, "{size_px:?}: {n_for_gain}");
        assert!(
            n_for_gain >= n_pixels.min(1 << 14) / 8,
            "{size_px:?}: {n_for_gain}"
        );
        assert!(plan.n_fit_steps >= 2, "one to start from, one to reweight");
    }
}
