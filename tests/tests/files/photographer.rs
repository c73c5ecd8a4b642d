//! The analytic photographer compared with closed forms; each comparison finds a planted fault.

use std::f64::consts::PI;

use app_core::scene::{Light, Pose};
use app_core::session::{Capture, GroundTruth, Session};
use app_core::toy::{PosedMesh, Toy};
use desk::files::Folder;
use glam::{DMat4, DVec2, DVec3};
use harness::temporary::Temporary;
use measure::photographer::{
    CLIP, Lamp, Paint, Part, Photos, Place, Quality, Sensor, Shape, Shot, Shown, Stance, ToyFile, World,
    folder, toy_glb,
};

/// A white table under a lamp, without sky, with a box on it.
fn world(lamp: Lamp, half_m: DVec3, centre_m: DVec3) -> World {
    let mut world = World::boxes().lit_by(vec![lamp]);
    world.sky = DVec3::ZERO;
    world.bounces = false;
    world.quality = Quality {
        n_light_rays: 4096,
        n_sky_rays: 4096,
        ..Quality::default()
    };
    world.grounds[0].paint = Paint::Even(DVec3::ONE);
    world.parts = vec![Part {
        shape: Shape::cuboid(half_m),
        color: DVec3::ONE,
        rest: Stance::at(centre_m),
        keys: Vec::new(),
    }];
    world
}

/// A sun overhead, and a large thin board, one edge of which is over the line x = 0, 1 m over the
/// table.
fn under_an_edge(radius_rad: f64) -> World {
    let sun = Lamp::sun(DVec3::Y, radius_rad, 1.0);
    world(sun, DVec3::new(50.0, 1e-9, 50.0), DVec3::new(50.0, 1.0, 0.0))
}

/// Share of a disc on one side of a line `h` radii from its centre.
fn segment(h: f64) -> f64 {
    (h.acos() - h * (1.0 - h * h).sqrt()) / PI
}

/// Largest error of the visibility of a sun under an edge, from the umbra to full light.
/// `radius_rad` is the radius for the closed form.
fn edge_error(world: &World, radius_rad: f64) -> f64 {
    let place = Place::new(world, Shown::Rest);
    let errors = (-9..=9).map(|step| {
        let h = 0.1 * f64::from(step);
        let at = DVec2::new(h * radius_rad.tan(), 0.0);
        (place.visibility_on(0, at, 0) - segment(h)).abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn disc_behind_an_edge() {
    let world = under_an_edge(0.01);
    let error = edge_error(&world, 0.01);
    // Measured: 1.3e-3 with 4 x 4096 rays.
    assert!(error < 2e-3, "{error:e}");
    // A sun one and a half times as large.
    assert!(edge_error(&world, 0.015) > 0.05);
    let half = Place::new(&world, Shown::Rest).visibility_on(0, DVec2::ZERO, 0);
    assert!((half - 0.5).abs() < 1e-3, "{half}");
}

/// Whether the shadow of a box from a point light ends where lines from the light through the box's
/// upper corners meet the table, within `margin_m`.
fn outline_holds(light: DVec3, half_m: DVec3, margin_m: f64) -> bool {
    let centre = DVec3::new(0.02, half_m.y, -0.01);
    let world = world(Lamp::bulb(DVec3::new(0.4, 0.5, 0.3), 0.0, 1.0), half_m, centre);
    let place = Place::new(&world, Shown::Rest);
    let project = |corner: DVec3| {
        let s = light.y / (light.y - corner.y);
        let at = light + s * (corner - light);
        DVec2::new(at.x, at.z)
    };
    let top = centre.y + half_m.y;
    // The two upper edges away from the light, which is on the side of +x and +z.
    let corner = |x: f64, z: f64| project(DVec3::new(centre.x + x * half_m.x, top, centre.z + z * half_m.z));
    let edges = [
        [corner(1.0, -1.0), corner(-1.0, -1.0)],
        [corner(-1.0, -1.0), corner(-1.0, 1.0)],
    ];
    edges.iter().all(|[from, to]| {
        // The shadow is on the side of the box.
        let inwards = {
            let across = (*to - *from).perp().normalize();
            across * (DVec2::new(centre.x, centre.z) - *from).dot(across).signum()
        };
        (1..10).all(|step| {
            let at = from.lerp(*to, 0.1 * f64::from(step));
            let is_dark = |offset_m: f64| place.visibility_on(0, at + offset_m * inwards, 0) == 0.0;
            is_dark(margin_m) && !is_dark(-margin_m)
        })
    })
}

#[test]
fn outline_of_a_box() {
    let half = DVec3::new(0.03, 0.05, 0.02);
    assert!(outline_holds(DVec3::new(0.4, 0.5, 0.3), half, 1e-9));
    // A light a tenth of a millimetre beside the true one.
    assert!(!outline_holds(DVec3::new(0.4001, 0.5, 0.3), half, 1e-9));
}

/// Largest relative error of the light below a bulb, for a falloff of that power and the cosine.
fn falloff_error(radius_m: f64, power: f64) -> f64 {
    let away = DVec3::new(0.0, -5.0, 0.0);
    let errors = [0.3, 0.7, 1.5, 4.0].into_iter().flat_map(|height_m| {
        let bulb = Lamp::bulb(DVec3::new(0.0, height_m, 0.0), radius_m, 0.8);
        let world = world(bulb, DVec3::splat(0.01), away);
        let light = |x: f64| Place::new(&world, Shown::Rest).light_on(0, DVec2::new(x, 0.0)).x;
        [0.0, 0.2, 0.9, 1.4].map(|x: f64| {
            let distance = height_m.hypot(x);
            let expected = 0.8 * height_m / distance / distance.powf(power);
            (light(x) / expected - 1.0).abs()
        })
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn inverse_square_and_cosine() {
    // A sphere that is wholly above the horizon lights as if from its centre. Measured: 6.5e-6 with
    // the 4 x 4096 rays of this test.
    for (radius_m, bound) in [(0.0, 1e-12), (0.02, 2e-5)] {
        let error = falloff_error(radius_m, 2.0);
        assert!(error < bound, "{radius_m} m: {error:e}");
        assert!(falloff_error(radius_m, 1.9) > 0.01);
    }
}

/// Light of a sky at the foot of an infinite wall on the side of +x, at a distance relative to the
/// wall's height.
fn sky_at(distance: f64) -> f64 {
    let mut world = world(
        Lamp::bulb(DVec3::Y, 0.0, 0.0),
        DVec3::new(1.0, 1.0, 1e6),
        DVec3::new(1.0, 0.0, 0.0),
    );
    world.sky = DVec3::ONE;
    Place::new(&world, Shown::Rest)
        .light_on(0, DVec2::new(-distance, 0.0))
        .x
}

#[test]
fn sky_beside_a_wall() {
    for distance in [0.1, 0.5, 1.0] {
        // (1 + sin) / 2 of the angle of the wall's upper edge from the zenith.
        let expected = 0.5 * (1.0 + distance / f64::hypot(distance, 1.0));
        let error = (sky_at(distance) - expected).abs();
        assert!(error < 2e-3, "{distance}: {error:e}");
        assert!((sky_at(1.3 * distance) - expected).abs() > 0.01);
    }
}

#[test]
fn core_poses_the_toy_as_photographed() {
    let world = World::boxes();
    let toy = Toy::from_glb("toy.glb", &toy_glb(&world, &ToyFile::default())).unwrap();
    let pose = Pose::Clip {
        clip: toy.find_clip(CLIP).unwrap(),
        time_secs: 0.3,
    };
    let mut posed = PosedMesh::default();
    toy.pose(&pose, &DMat4::IDENTITY, &mut posed).unwrap();
    // Each corner is on the surface of its part: a ray to it from outside ends there.
    let farthest = |time_secs| {
        let place = Place::new(&world, Shown::At { time_secs });
        let distances = posed
            .positions
            .iter()
            .map(|at| place.distance_to_surface(at.as_dvec3()));
        distances.fold(0.0, f64::max)
    };
    assert!(farthest(0.3) < 1e-7, "{:e}", farthest(0.3));
    assert!(farthest(0.31) > 1e-5);
}

#[test]
fn noise_and_exposure_are_as_asked_for() {
    let mut world = World::boxes().resized([64, 36]);
    world.sensor = Sensor {
        plate_gain: DVec3::splat(0.5),
        noise_codes: 4.0,
        ..Sensor::default()
    };
    let quiet = Photos::of(&World {
        sensor: Sensor {
            noise_codes: 0.0,
            ..world.sensor
        },
        ..world.clone()
    });
    let noisy = Photos::of(&world);
    let pairs = noisy.frame.rgba8.iter().zip(&quiet.frame.rgba8);
    let squares = pairs.map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum::<f64>();
    let deviation = (squares / (3.0 * 64.0 * 36.0)).sqrt();
    assert!((deviation - 4.0).abs() < 0.15, "{deviation}");
    assert!(noisy.frame == Photos::of(&world).frame, "another noise");
    let mean = |rgba8: &[u8]| rgba8.iter().map(|code| f64::from(*code)).sum::<f64>();
    assert!(mean(&quiet.plate.rgba8) < 0.85 * mean(&quiet.frame.rgba8));
}

#[test]
fn a_folder_is_read_back_as_it_was() {
    let world = World::boxes().resized([64, 36]);
    let shot = Shot::of(&world).unwrap();
    let path = Temporary::new("photographer");
    folder::write(&path.0, &shot).unwrap();
    let session = Capture::open(Folder::open(&path.0).unwrap()).unwrap();
    let frame = session.frame(0).unwrap();
    let truth = session.truth(0).unwrap().unwrap();
    assert!(session.warnings().is_empty(), "{:?}", session.warnings());
    assert!(*frame.image == **shot.input.image.rgba());
    assert!(truth.image == shot.truth.image && truth.mask == shot.truth.mask);
    assert_eq!(session.scene().lights, shot.scene.lights);
    let [read, written] = [frame.camera, shot.input.camera];
    assert_eq!(read.intrinsics, written.intrinsics);
    // A number is read from its digits to within its last bit.
    assert!(
        read.world_from_camera
            .abs_diff_eq(written.world_from_camera, 1e-15)
    );
    assert_eq!(frame.shown_pose, shot.input.shown_pose);
    assert!(matches!(session.scene().lights[0], Light::Sphere { .. }));
}
