//! Scratch.
use app_core::session::{Capture, Session};
use desk::files::Folder;
use app_core::glam::DVec3;
fn main() {
    for path in std::env::args().skip(1) {
        let session = Capture::open(Folder::open(&path).unwrap()).unwrap();
        let scene = session.scene();
        let b = scene.toy.bounds_of_pose(&scene.physical_pose).unwrap();
        let f = session.frame(0).unwrap();
        let input = app_core::frame::FrameInput::from(&f);
        let (s, q, _) = input.world_from_object.to_scale_rotation_translation();
        let up = q * DVec3::Y;
        println!("{path} {} {:?}", s.x * (b.max.y - b.min.y) as f64, up.to_array());
    }
}
