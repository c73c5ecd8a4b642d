//! A pose almost equal to the physical one shows the camera's pixels.

use app_core::preset::Preset;
use app_core::scene::Pose;
use harness::compare::Pair;

use crate::core::bundled::{core, first_input, scene};

const CLIP: &str = "Look";
/// The clip begins with the physical pose: at this time no vertex is farther from it than rounding
/// in 32 bits.
const JUST_BEGUN_SECS: f64 = 1e-9;

#[test]
fn a_clip_that_has_just_begun_is_the_camera_picture() {
    let (scene, input) = (scene(), first_input());
    let clip = scene.toy.find_clip(CLIP).unwrap();
    let at = |time_secs| input.clone().with_shown_pose(Pose::Clip { clip, time_secs });
    let mut core = core();
    // `best` removes the noise from the real shadow, whatever moves.
    core.set_scene(scene, Preset::Balanced).unwrap();
    let [just_begun, later] = [JUST_BEGUN_SECS, 0.5].map(|time_secs| {
        core.frame(&at(time_secs)).unwrap();
        let actual = core.read_picture().unwrap();
        let pair = Pair {
            expected: &**input.image.rgba(),
            actual: &actual,
        };
        pair.difference().unwrap().max_abs
    });
    // Without the same light for both poses the difference is up to 61 codes, at folds and at
    // shadows on the toy.
    assert!(just_begun <= 1.0, "{just_begun} codes");
    assert!(later > 30.0, "nothing moves: {later} codes");
}
