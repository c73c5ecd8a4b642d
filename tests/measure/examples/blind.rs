//! Scratch.
use app_core::alignment::{ViewDirection, find_toy};
use app_core::frame::FrameInput;
use app_core::glam::{DMat4, DQuat, DVec3};
use app_core::scene::Camera;
use app_core::session::{Capture, Session};
use desk::files::Folder;

fn main() {
    let n_turns: usize = std::env::var("TURNS").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let extra: f64 = std::env::var("EXTRA").ok().and_then(|n| n.parse().ok()).unwrap_or(0.0);
    for path in std::env::args().skip(1) {
        let session = Capture::open(Folder::open(&path).unwrap()).unwrap();
        let recorded = FrameInput::from(&session.frame(0).unwrap());
        let mut scene = session.scene().clone();
        let truth = recorded.camera.world_from_camera.inverse() * recorded.world_from_object;
        let (scale, _, _) = recorded.world_from_object.to_scale_rotation_translation();
        let camera = Camera { world_from_camera: DMat4::IDENTITY, ..recorded.camera };
        if std::env::var("NOPLATE").is_ok() { scene.plates.clear(); }
        let hand = std::env::var("HAND").is_ok();
        for plate in &mut scene.plates { plate.camera = camera; }
        let pitch = 40.0_f64.to_radians();
        let table = DMat4::from_translation(DVec3::new(0.0, 0.0, -0.5)) * DMat4::from_rotation_x(pitch);
        for r in &mut scene.receivers { r.world_from_plane = table; r.half_extent_m = [10.0, 10.0].into(); }
        scene.receivers.truncate(1);
        scene.uncertainty.are_receivers_guessed = true;
        let up = std::env::var("UP").is_ok();
        let mut upright = DMat4::from_scale(scale);
        if up { upright = DMat4::from_quat(DQuat::from_rotation_arc(recorded.world_from_object.y_axis.truncate().normalize(), DVec3::Y)) * DMat4::from_scale(scale); }
        let input = recorded.clone().with_camera(camera).with_world_from_object(upright);
        let elevations = [12.0_f64, 28.0, 44.0, 62.0];
        let directions: Vec<ViewDirection> = elevations.iter().flat_map(|e| (0..n_turns).map(move |t| ViewDirection {
            turn_rad: (t as f64) * std::f64::consts::TAU / n_turns as f64 + extra, elevation_rad: e.to_radians() })).collect();
        let start = std::time::Instant::now();
        let search = find_toy(&scene, &input, &directions).unwrap(); let found = search.found; let _ = hand;
        println!("{path}: {} found in {:?}, nearest {:?}, plates moved {:?}", found.len(), start.elapsed(), search.nearest_px, search.plate_cameras.iter().map(|c| c.world_from_camera.w_axis.truncate()).collect::<Vec<_>>());
        let bounds = scene.toy.bounds_of_pose(&scene.physical_pose).unwrap();
        let mid = (0.5 * (bounds.min + bounds.max)).as_dvec3();
        for f in &found {
            let a = f.world_from_object; let b = truth;
            let d = a.transform_point3(mid).distance(b.transform_point3(mid));
            let [qa, qb] = [a, b].map(|m| m.to_scale_rotation_translation().1);
            let t = (qb * qa.inverse()).to_scaled_axis().length().to_degrees();
            println!("   off {:.3} mm {:.3} deg, outline {:.3} px, color {:.3} dev {:.3} mm {:.3} deg", 1e3 * d, t, f.outline_px, f.color_difference, 1e3 * f.deviation.depth_m, f.deviation.rotation_rad.to_degrees());
        }
    }
}
