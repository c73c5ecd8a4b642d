//! Scratch: loss of the lights against the table's height.
use app_core::alignment::Aligner;
use app_core::frame::FrameInput;
use app_core::glam::{DMat4, DVec3};
use app_core::session::{Capture, Session};
use desk::files::Folder;
fn main() {
    for path in std::env::args().skip(1) {
        let session = Capture::open(Folder::open(&path).unwrap()).unwrap();
        let f = session.frame(0).unwrap();
        let input = FrameInput::from(&f);
        println!("{path}");
        for h in [-0.6, -0.4, -0.2, -0.1, 0.0, 0.1, 0.2, 0.4, 0.6] {
            let mut scene = session.scene().clone();
            for r in &mut scene.receivers { r.world_from_plane = DMat4::from_translation(DVec3::Y * h * 1e-3) * r.world_from_plane; }
            scene.resting = Some(false);
            let t = std::time::Instant::now();
            let a = Aligner::new(scene).align(&input).unwrap();
            println!("  {h:+.1} mm: {:?} unexpl {:?} moved {:.3} mm {:?}", a.report.light_errors, a.report.unexplained, a.report.pose.map_or(0.0, |p| 1e3*p.moved_m), t.elapsed());
        }
    }
}
