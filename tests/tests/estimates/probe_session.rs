//! A session without listed lights: its probe estimates them, and the toy's shadow makes them
//! exact.

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use app_core::alignment::{Aligner, EstimatedLight};
use app_core::preset::Preset;
use app_core::scene::{Light, Probe};
use app_core::session::{Capture, Session};
use desk::alignment::{Alignments, Asked, LightError, Lights, SeenLight, Source};
use desk::check::check;
use desk::files::Folder;
use desk::report::AlignmentEntry;
use glam::{DMat4, DVec3};
use measure::photographer::world::{camera, toward};
use measure::photographer::{Exposure, Lamp, Mirror, Quality, Shot, World, folder};

const SIZE_PX: [u32; 2] = [512, 288];
/// Position of the lens beside the toy: near lights have directions there that differ by some 10
/// degrees.
const LENS: DVec3 = DVec3::new(-0.14, 0.0, 0.06);

fn lamps() -> [Lamp; 2] {
    [
        Lamp::bulb(toward(50.0, 30.0), 0.01, 0.4),
        Lamp::bulb(0.8 * toward(60.0, -70.0), 0.02, 0.16),
    ]
}

/// Boxes under two bulbs and a lens, in one picture per viewer.
fn shot(viewers: &[DVec3]) -> Shot {
    let mut world = World::boxes().resized(SIZE_PX).lit_by(lamps().to_vec());
    world.quality = Quality {
        n_across: 2,
        n_light_rays: 48,
        n_sky_rays: 32,
    };
    let mut shot = Shot::of(&world).unwrap();
    let lens = Mirror::lens(DMat4::from_translation(LENS));
    let pictures = viewers.iter().zip(1..).map(|(eye, seed)| {
        let exposure = Exposure {
            seed,
            ..Exposure::default()
        };
        lens.photograph(
            (&world.lamps, world.sky),
            (&camera(SIZE_PX, *eye, LENS), SIZE_PX),
            &exposure,
        )
    });
    shot.scene.probe = Some(Probe {
        pictures: pictures.collect(),
        shape: lens.shape,
    });
    shot
}

/// The session with the lamps listed.
static SESSION: LazyLock<(PathBuf, Shot)> = LazyLock::new(|| {
    let shot = shot(&[DVec3::new(-0.3, 0.3, 0.2), DVec3::new(0.05, 0.3, 0.2)]);
    let session = Path::new(env!("CARGO_TARGET_TMPDIR")).join("probe-session");
    folder::write(&session, &shot).unwrap();
    (session, shot)
});

fn aligned(lights: Lights) -> (Capture, Alignments) {
    let capture = Capture::open(Folder::open(&SESSION.0).unwrap()).unwrap();
    let asked = Asked {
        lights,
        ..Asked::default()
    };
    let alignments = Alignments::find(&capture, 0..1, asked).unwrap();
    (capture, alignments)
}

fn of_each(errors: Vec<Option<LightError>>) -> [f64; 2] {
    let mut deg = [f64::INFINITY; 2];
    for error in errors.into_iter().flatten() {
        deg[error.index] = deg[error.index].min(error.direction_rad.to_degrees());
    }
    deg
}

/// Within .3 degrees by the probe alone, and within .1 with the shadow.
#[test]
fn the_shadow_makes_exact_what_the_probe_tells() {
    let (_, alignments) = aligned(Lights::Probe);
    let entry = AlignmentEntry::from(alignments.of(0).unwrap());
    let probe = entry.report.probe.unwrap();
    assert_eq!(
        (
            probe.lights.len(),
            probe.rejected.len(),
            entry.report.discovered.len()
        ),
        (2, 0, 2)
    );
    let before_deg = of_each(entry.probe_against_listed);
    let after_deg = of_each(entry.discovered_against_listed);
    assert!(before_deg.iter().all(|deg| *deg < 0.3), "{before_deg:?}");
    assert!(after_deg.iter().all(|deg| *deg < 0.1), "{after_deg:?}");
}

/// One view does not constrain the distance, and the same place in the sky of the lens is 10
/// degrees off over the toy.
#[test]
fn one_view_is_enough_for_the_shadow() {
    let mut shot = shot(&[DVec3::new(-0.1, 0.3, 0.2)]);
    shot.scene.lights.clear();
    let found = Aligner::new(shot.scene.clone()).align(&shot.input).unwrap();
    let told = found.report.probe.as_ref().unwrap();
    assert!(
        told.lights.iter().all(|light| light.distance_m.is_none()),
        "{told:?}"
    );
    let bounds = shot.scene.toy.bounds_of_pose(&shot.scene.physical_pose).unwrap();
    let middle = 0.5 * (bounds.min + bounds.max).as_dvec3();
    let middle = shot.input.world_from_object.transform_point3(middle);
    assert_eq!(found.report.discovered.len(), 2, "{:#?}", found.report);
    for lamp in lamps() {
        let truth = SeenLight::from(middle, &lamp.light).direction_in_world;
        let off_deg = |direction: DVec3| direction.angle_between(truth).to_degrees();
        let told = told
            .lights
            .iter()
            .map(|light| off_deg(light.seen.direction_in_world));
        let refined = |light: &EstimatedLight| off_deg(light.direction_in_world);
        let refined = found.report.discovered.iter().map(refined);
        let [told, refined] = [told.fold(180.0, f64::min), refined.fold(180.0, f64::min)];
        assert!(told > 5.0 && refined < 0.1, "{told} and {refined} degrees off");
    }
}

/// The paper uses no shadow, and assumes the viewer on the axis.
#[test]
fn preset_paper_has_the_published_lights() {
    let (capture, alignments) = aligned(Lights::Probe);
    let frame = capture.frame(0).unwrap();
    let [paper, ours] = [Preset::Paper, Preset::Balanced].map(|preset| {
        let input = alignments.input(0, &frame, preset);
        assert_eq!(alignments.n_lights(capture.scene(), preset), 2);
        input.lights.unwrap()
    });
    let alignment = &alignments.of(0).unwrap().alignment;
    assert_eq!(Some(&ours), alignment.lights.as_ref());
    assert_eq!(paper[..], alignment.report.probe.as_ref().unwrap().published);
    assert!(
        paper
            .iter()
            .all(|light| matches!(light, Light::Directional { .. }))
    );
}

#[test]
fn listed_lights_come_before_a_probe() {
    let (capture, given) = aligned(Lights::Given);
    let report = &given.of(0).unwrap().alignment.report;
    assert_eq!(
        (report.lights.len(), &report.probe, report.discovered.len()),
        (2, &None, 0)
    );
    let frame = capture.frame(0).unwrap();
    let [paper, ours] = [Preset::Paper, Preset::Balanced].map(|preset| given.input(0, &frame, preset).lights);
    assert_eq!(paper, ours);
    let (_, found) = aligned(Lights::Found);
    let report = &found.of(0).unwrap().alignment.report;
    assert_eq!((&report.probe, report.discovered.len()), (&None, 2));
}

/// The frame shows no toy, so there is no shadow to use.
#[test]
fn without_a_shadow_the_probes_lights_stand() {
    let (_, shot) = &*SESSION;
    let (mut scene, mut input) = (shot.scene.clone(), shot.input.clone());
    scene.lights.clear();
    input.image = Arc::clone(&scene.plates[0].image).into();
    let found = Aligner::new(scene).align(&input).unwrap();
    let told = found.report.probe.unwrap();
    let lights: Vec<Light> = told.lights.iter().map(|light| light.light).collect();
    assert_eq!(found.lights.as_deref(), Some(&lights[..]));
    assert!(found.report.no_light.is_some());
}

#[test]
fn check_tells_what_the_probe_shows() {
    let (session, shot) = &*SESSION;
    let unlisted = Path::new(env!("CARGO_TARGET_TMPDIR")).join("probe-session-unlisted");
    let mut shot = shot.clone();
    shot.scene.lights.clear();
    folder::write(&unlisted, &shot).unwrap();
    let findings = check(&unlisted, &unlisted, (Asked::default(), Source::Given)).unwrap();
    let told = findings
        .facts
        .iter()
        .filter(|fact| fact.starts_with("probe: light"));
    assert_eq!(told.count(), 2, "{findings:?}");
    assert!(findings.wrong.is_empty(), "{findings:?}");
    // If lights are listed, the probe is not used.
    let listed = check(session, session, (Asked::default(), Source::Given)).unwrap();
    assert!(
        !listed.facts.iter().any(|fact| fact.starts_with("probe")),
        "{listed:?}"
    );
}
