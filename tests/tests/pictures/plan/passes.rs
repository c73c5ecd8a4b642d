//! Passes of a plan on each path, with their sizes and formats.

use app_core::Core;
use app_core::frame::{FrameInput, PassGroup};
use app_core::gloss::Gloss;
use app_core::preset::{BALANCED, Preset};
use app_core::session::Session;
use app_core::sharpness::Sharpness;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::model::plan::Plan;
use app_pipeline::plan::{Change, SceneFacts};
use glam::UVec2;
use harness::bundled_session;
use measure::bench::{FrameKind, with_new};

/// Sizes of regions, from a pixel to more than that of any camera.
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
        has_things: false,
        has_raised_things: false,
        things_fronts: Vec::new(),
        sharpness: Sharpness::SHARP,
        is_softened: false,
        gloss: Gloss::NONE,
        angular_radii_rad: vec![0.0; penumbrae_px.len()],
        reflection: None,
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
    assert!(plan.skipped.iter().all(|skipped| !skipped.reason.is_empty()));
    plan.skipped.iter().any(|skipped| skipped.what == what)
}

/// A frame's change, and the passes of the capture path and of the frame path.
type Ran = (Option<Change>, [String; 2]);

/// The passes in the order of their first runs.
fn ran(core: &mut Core, input: &FrameInput) -> Ran {
    let report = core.frame(input).unwrap();
    let of = |path| {
        let runs = report.ran.iter().filter(|run| run.path == path);
        runs.map(|run| run.pass).collect::<Vec<_>>().join(" ")
    };
    (report.change, [PassGroup::Capture, PassGroup::Frame].map(of))
}

/// A core that counts frames of the bundled session, and the first of them.
fn counting(preset: Preset, has_plates: bool) -> (Core, FrameInput) {
    let session = bundled_session();
    let mut scene = session.scene().clone();
    if !has_plates {
        scene.plates.clear();
    }
    let mut core = Core::counting();
    core.set_scene(scene, preset).unwrap();
    (core, FrameInput::from(&session.frame(0).unwrap()))
}

/// The passes for a new scene, then for two views, a pose, two pictures and a view in sequence;
/// each pose is drawn.
fn runs(preset: Preset, has_plates: bool) -> Vec<Ran> {
    use FrameKind::{Picture, Pose, View};
    let (mut core, mut input) = counting(preset, has_plates);
    core.draw_every_pose().unwrap();
    let first = ran(&mut core, &input);
    let others = [View, View, Pose, Picture, Picture, View].map(|kind| {
        input = with_new(&input, kind);
        ran(&mut core, &input)
    });
    [first].into_iter().chain(others).collect()
}

fn expected(change: Change, capture: &str, frame: &str) -> Ran {
    (Some(change), [capture.to_owned(), frame.to_owned()])
}

/// Passes of the model for each new pose.
const DRAWN: &str = "occlusion self_shadow moved_mask toy coverage composite";

#[test]
fn the_model_runs_its_passes_in_this_order() {
    let observed = "self_shadow gbuffer validity occlusion plate";
    let means = "residual fill tint tint_fill appearance";
    let scene = format!("{observed} lit fill fit fit_solve estimate residual tint tint_fill appearance");
    let view = format!("{observed} fit fit_solve lit fill estimate residual tint tint_fill appearance");
    let [residual, tint] =
        ["residual fill", "tint tint_fill"].map(|mean| format!("fit fit_solve {mean} {DRAWN}"));
    assert_eq!(
        runs(Preset::Balanced, false),
        [
            expected(Change::Scene, &scene, DRAWN),
            expected(Change::View, &view, DRAWN),
            expected(Change::View, &view, DRAWN),
            expected(Change::Pose, "", DRAWN),
            expected(Change::Picture, "", &tint),
            expected(Change::Picture, "", &residual),
            expected(Change::View, &view, DRAWN),
        ]
    );
    let shown = format!("{observed} fit fit_solve {means}");
    assert_eq!(
        runs(Preset::Balanced, true)[0],
        expected(Change::Scene, &shown, DRAWN)
    );
    let detailed = shown.replace("fill tint", "fill detail tint");
    assert_eq!(
        runs(Preset::Best, true)[0],
        expected(Change::Scene, &detailed, DRAWN)
    );
}

#[test]
fn the_published_method_runs_its_passes_in_this_order() {
    let learned = "plate masks warp pcss eligible census";
    let drawn = "warp pcss search box_filter retarget";
    let scaled = format!("plate {drawn}");
    assert_eq!(
        runs(Preset::Paper, true),
        [
            expected(Change::Scene, learned, drawn),
            expected(Change::View, learned, drawn),
            expected(Change::View, learned, drawn),
            expected(Change::Pose, "", drawn),
            expected(Change::Picture, "", &scaled),
            expected(Change::Picture, "", &scaled),
            expected(Change::View, learned, drawn),
        ]
    );
    let ran = runs(Preset::Flat, true);
    assert_eq!(
        ran[0],
        expected(
            Change::Scene,
            "plate masks warp pcss eligible",
            "warp pcss retarget"
        )
    );
}

#[test]
fn without_lights_no_pass_runs_for_their_shadows() {
    let session = bundled_session();
    let mut scene = session.scene().clone();
    scene.lights.clear();
    let input = FrameInput::from(&session.frame(0).unwrap());
    let passes = |preset: Preset| {
        let mut core = Core::counting();
        core.set_scene(scene.clone(), preset).unwrap();
        ran(&mut core, &input)
    };
    let learned = "gbuffer validity occlusion plate fit fit_solve residual fill tint tint_fill appearance";
    let drawn = "occlusion moved_mask toy coverage composite";
    assert_eq!(passes(Preset::Balanced), expected(Change::Scene, learned, drawn));
    let (learned, drawn) = ("plate masks pcss eligible", "pcss retarget");
    assert_eq!(passes(Preset::Paper), expected(Change::Scene, learned, drawn));
}

/// A new picture changes the colours alone; if the picture is unchanged, too, nothing runs.
#[test]
fn a_paused_toy_is_not_drawn_again() {
    let of_paper = "warp pcss search box_filter retarget";
    for (preset, colours, all) in [
        (
            Preset::Balanced,
            "fit fit_solve tint tint_fill toy composite",
            DRAWN,
        ),
        (Preset::Paper, "plate search box_filter retarget", of_paper),
    ] {
        let (mut core, input) = counting(preset, true);
        ran(&mut core, &input);
        assert_eq!(ran(&mut core, &input), expected(Change::Pose, "", ""));
        let next = with_new(&input, FrameKind::Picture);
        assert_eq!(ran(&mut core, &next), expected(Change::Picture, "", colours));
        let aside = with_new(&next, FrameKind::View);
        assert_eq!(ran(&mut core, &aside).1[1], all);
    }
}

/// Plate and light are estimated alternately three times; `fill` runs after `lit` each time, and
/// after `residual`.
#[test]
fn a_new_scene_without_plates_is_estimated_in_rounds() {
    let (mut core, input) = counting(Preset::Balanced, false);
    let [first, second] = [input.clone(), with_new(&input, FrameKind::View)].map(|input| {
        let report = core.frame(&input).unwrap();
        ["lit", "fill", "estimate", "residual"].map(|pass| {
            let runs = report.ran.iter().filter(|run| run.pass == pass);
            runs.map(|run| run.n_runs).sum::<u32>()
        })
    });
    assert_eq!([first, second], [[3, 4, 1, 1], [1, 2, 1, 1]]);
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

/// A camera that sways about a threshold does not change a light's number of points.
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
    // Another number of points does not change the allocations.
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
        // The next smaller stride would give too many pixels: at least a quarter of them remains,
        // and half of these after rounding.
        assert!(n_taken <= 1 << 16, "{size_px:?}: {n_taken}");
        assert!(n_taken >= n_pixels.min(1 << 16) / 8, "{size_px:?}: {n_taken}");
        let n_rows = plan.n_fit_rows(plan.fit_stride_px);
        assert!((1..=16).contains(&n_rows));
        assert!(
            u64::from(n_rows - 1) * 16 * 256 < n_taken,
            "{size_px:?}: a workgroup without work"
        );
        // Gain and intensities use a quarter of them, except in a small region.
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
