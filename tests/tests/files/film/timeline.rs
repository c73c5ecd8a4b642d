//! The pose of each frame.

use film::animate::grammar::items;
use film::animate::timeline::{End, FramePose, Timing, frames, photograph_at};
use film::ease::Ease;

use super::clips;

/// Eight frames a second, so that times are exact.
fn timing() -> Timing {
    Timing {
        fps: 8.0,
        ..Timing::default()
    }
}

fn film(text: &str, timing: &Timing) -> Vec<FramePose> {
    let clips = clips();
    frames(&items(text, &clips).unwrap(), &clips, timing).unwrap()
}

/// Clip and eighths of a second for each frame.
fn moments(text: &str, timing: &Timing) -> Vec<(usize, f64)> {
    let frames = film(text, timing).into_iter();
    frames
        .map(|frame| (frame.moment.clip, 8.0 * frame.moment.time_secs))
        .collect()
}

/// Moments of one clip.
fn of(clip: usize, eighths: &[u32]) -> Vec<(usize, f64)> {
    eighths.iter().map(|at| (clip, f64::from(*at))).collect()
}

#[test]
fn clips_follow_one_another_and_the_last_pose_is_shown() {
    let cases = [
        ("Look", of(0, &[0, 1, 2, 3, 4, 5, 6, 7, 8])),
        ("Step*2", of(1, &[0, 1, 2, 3, 0, 1, 2, 3, 4])),
        ("Step@2x", of(1, &[0, 2, 4])),
        ("Step@-1x", of(1, &[4, 3, 2, 1, 0])),
        ("Step@2x,Look@4x", [of(1, &[0, 2]), of(0, &[0, 4, 8])].concat()),
        // A hold keeps the last pose for the given time.
        ("Step@2x,hold:4", of(1, &[0, 2, 4, 4, 4, 4])),
        ("hold:2,Step@-2x", of(1, &[4, 4, 4, 2, 0])),
    ];
    for (text, expected) in cases {
        assert_eq!(moments(text, &timing()), expected, "{text}");
    }
}

#[test]
fn a_film_ends_as_it_is_told() {
    let looped = Timing {
        end: End::Loop,
        ..timing()
    };
    assert_eq!(moments("Step", &looped), of(1, &[0, 1, 2, 3]));
    let back = Timing {
        end: End::PingPong,
        ..timing()
    };
    assert_eq!(moments("Step", &back), of(1, &[0, 1, 2, 3, 4, 3, 2, 1]));
    let on_twos = Timing { on: 2, ..timing() };
    assert_eq!(moments("Step", &on_twos), of(1, &[0, 0, 2, 2, 4]));
    let cut = Timing {
        from_secs: 0.25,
        to_secs: Some(0.5),
        ..timing()
    };
    assert_eq!(moments("Look", &cut), of(0, &[2, 3]));
}

#[test]
fn an_eased_clip_is_as_long_as_another_and_slower_at_its_ends() {
    let eased = Timing {
        ease: Ease::InOut,
        ..timing()
    };
    let even = moments("Look", &timing());
    let eased = moments("Look", &eased);
    assert_eq!([eased[0], eased[4], eased[8]], [even[0], even[4], even[8]]);
    assert!(eased[1].1 < 0.5 && eased[7].1 > 7.5, "{eased:?}");
}

#[test]
fn a_start_takes_over_step_by_step_from_the_pose_before_it() {
    let blended = Timing {
        n_blend_frames: 3,
        ..timing()
    };
    let frames = film("Step,hold:1,Look", &blended);
    let shares: Vec<Option<f64>> = frames.iter().map(|frame| Some(frame.after?.share)).collect();
    // The first clip has no predecessor.
    assert!(shares[..5].iter().all(Option::is_none), "{shares:?}");
    let [Some(a), Some(b), Some(c)] = shares[5..8] else {
        panic!("{shares:?}");
    };
    assert!(0.0 < a && a < b && b < c && c < 1.0, "{shares:?}");
    assert!(shares[8..].iter().all(Option::is_none), "{shares:?}");
    let from = frames[5].after.unwrap().from;
    assert_eq!((from.clip, from.time_secs), (1, 0.5));
    // A loop's first clip follows its last.
    let looped = Timing {
        end: End::Loop,
        ..blended
    };
    assert_eq!(film("Step,Look", &looped)[0].after.unwrap().from.clip, 0);
}

#[test]
fn a_film_without_frames_or_with_too_many_is_refused() {
    let clips = clips();
    let refused = |text: &str, timing: &Timing| {
        let items = items(text, &clips).unwrap();
        frames(&items, &clips, timing).unwrap_err().to_string()
    };
    let late = Timing {
        from_secs: 9.0,
        ..timing()
    };
    assert!(refused("Look", &late).contains("last 1.000 s"));
    assert!(refused("Look*10000@0.01x", &timing()).contains("the limit is 100000"));
}

#[test]
fn a_moving_film_shows_the_photograph_that_had_been_taken_and_the_last_one_to_its_end() {
    // At 30 a second, rounded as recorders do, and with one dropped frame.
    let times_secs = [0.0, 0.033333, 0.1, 0.133333];
    let shown = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|frame| photograph_at(&times_secs, frame / 30.0));
    assert_eq!(shown, [0, 1, 1, 2, 3, 3]);
    assert_eq!(photograph_at(&times_secs, 0.02), 0);
}
