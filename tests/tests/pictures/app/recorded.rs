//! The app's recording contains its inputs, and is replayed like them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, mpsc};
use std::thread;

use app_core::Core;
use app_core::app::{Notice, Recorded, ShellCommand, ShellEvent, Show, Step, UserAction, WorkCommand};
use app_core::camera_frame::Tracking;
use app_core::recording::{
    Ending, Limits, PictureCodec, Recording, RecordingJob, RecordingOptions, RecordingOutcome, Topic,
};
use app_core::scene::{Pose, Scene};
use app_core::session::{
    Capture, Files, GroundTruth, Session, SessionError, SessionFrame, SessionWarning, Truth,
};
use desk::convert;
use desk::metrics::Scores;
use desk::progress::Quiet;
use desk::replay::{Options, picture_file, replay};
use desk::report::Report;
use desk::stored::Stored;
use harness::temporary::Temporary;
use harness::{bundled_session, open_core};
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

use crate::app::orders::{happen, straight};
use crate::app::way::{OFF_M, placed};
use crate::app::world;

/// The shown poses of the bundled session, by the numbers of its frames.
const POSES: [usize; 3] = [1, 2, 3];

fn options(toy: &[u8], codec: PictureCodec) -> RecordingOptions<'_> {
    RecordingOptions {
        toy,
        codec,
        device: BTreeMap::from([("model".to_owned(), "desk".to_owned())]),
        limits: Limits::APP,
    }
}

/// A sink that can still be read when its writer is gone.
#[derive(Clone, Default)]
struct Shared(Arc<std::sync::Mutex<Vec<u8>>>);

impl std::io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn written(job: RecordingJob, toy: &[u8], codec: PictureCodec) -> (Vec<u8>, RecordingOutcome) {
    let sink = Shared::default();
    let outcome = job.run(sink.clone(), options(toy, codec));
    let bytes = std::mem::take(&mut *sink.0.lock().unwrap());
    (bytes, outcome)
}

/// The inputs of the app during the recording.
struct Fed {
    scene: Scene,
    frames: Vec<SessionFrame>,
}

/// A person records three frames, each with a pose of the bundled session.
fn fed_and_recorded(codec: PictureCodec) -> (Fed, Vec<u8>) {
    let source = bundled_session();
    let mut person = placed(OFF_M);
    let toy = person.feed.toy_file();
    person.frames(1);
    assert_eq!(person.app.step(), Step::Play, "{:?}", person.app.verdict());
    person.frames(20);
    let Show::Toy { scene, .. } = person.app.show() else {
        panic!("{:?}", person.app.step());
    };
    let scene = Scene::clone(scene);
    person.act(UserAction::Play(false));
    person.act(UserAction::Record(true));
    assert!(person.app.is_recording());
    let mut frames: Vec<SessionFrame> = Vec::new();
    for pose in POSES {
        let shown_pose = source.frame(pose).unwrap().shown_pose;
        let Pose::Clip { clip, time_secs } = shown_pose else {
            panic!("{shown_pose:?}");
        };
        person.act(UserAction::Choose(Some(clip)));
        person.act(UserAction::Scrub(time_secs));
        person.frames(1);
        let fed = person.app.latest().unwrap();
        frames.push(SessionFrame {
            time_secs: 0.033 * (frames.len() + 1) as f64,
            image: Arc::clone(fed.image.rgba()),
            camera: fed.camera().unwrap(),
            world_from_object: scene.world_from_object,
            exposure: 1.0,
            light_estimate: fed.light_estimate,
            depth: None,
            people: None,
            shown_pose,
            world_from_shown: None,
            warnings: Vec::new(),
        });
    }
    person.act(UserAction::Record(false));
    assert!(!person.app.is_recording());
    let (bytes, outcome) = written(person.recordings.remove(0), &toy, codec);
    let n_frames = u32::try_from(POSES.len()).unwrap();
    let expected = RecordingOutcome {
        number: 1,
        n_frames,
        n_dropped: 0,
        ending: Ending::Asked,
    };
    assert_eq!(outcome, expected);
    person.tell(ShellEvent::Recorded(Recorded {
        file: "a.mcap".to_owned(),
        outcome,
    }));
    assert!(matches!(person.app.notice(), Some(Notice::Recorded(_))));
    (Fed { scene, frames }, bytes)
}

impl Session for Fed {
    fn scene(&self) -> &Scene {
        &self.scene
    }

    fn warnings(&self) -> &[SessionWarning] {
        &[]
    }

    fn n_frames(&self) -> usize {
        self.frames.len()
    }

    fn frame(&self, index: usize) -> Result<SessionFrame, SessionError> {
        Ok(self.frames[index].clone())
    }
}

/// The photographs of the toy that really had those poses.
struct Truths(Capture);

impl GroundTruth for Truths {
    fn truth(&self, index: usize) -> Result<Option<Truth>, SessionError> {
        self.0.truth(POSES[index])
    }
}

fn replayed(session: &dyn Session, core: &mut Core, out: PathBuf) -> (Report, Vec<Vec<u8>>) {
    let truths = Truths(bundled_session());
    let options = Options {
        out: Some(out.clone()),
        ..Options::default()
    };
    let mut reports = replay(session, Some(&truths), core, &options, &mut Quiet).unwrap();
    let pictures = (0..POSES.len()).map(|index| fs::read(out.join(picture_file(index))).unwrap());
    (reports.remove(0), pictures.collect())
}

/// A report without times and without everything that is named after files.
fn untimed(report: &Report) -> serde_json::Value {
    let mut report = serde_json::to_value(report).unwrap();
    strip(&mut report);
    report
}

fn strip(value: &mut serde_json::Value) {
    match value {
        serde_json::Value::Object(map) => {
            map.retain(|key, _| !key.ends_with("_ms") && key != "time_secs");
            map.values_mut().for_each(strip);
        }
        serde_json::Value::Array(all) => all.iter_mut().for_each(strip),
        _ => {}
    }
}

/// Paths at which two values differ by more than the last digits that a JSON number may lose.
fn differing(one: &serde_json::Value, other: &serde_json::Value, at: &str) -> Vec<String> {
    use serde_json::Value;
    match (one, other) {
        (Value::Object(a), Value::Object(b)) if a.len() == b.len() => {
            let pairs = a.iter().zip(b);
            pairs
                .flat_map(|((key, a), (_, b))| differing(a, b, &format!("{at}.{key}")))
                .collect()
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let pairs = a.iter().zip(b).enumerate();
            pairs
                .flat_map(|(i, (a, b))| differing(a, b, &format!("{at}[{i}]")))
                .collect()
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            let is_same = (a - b).abs() <= 1e-6 * a.abs().max(b.abs()).max(1e-3);
            (!is_same)
                .then(|| format!("{at}: {a}, {b}"))
                .into_iter()
                .collect()
        }
        (a, b) if a == b => Vec::new(),
        (a, b) => vec![format!("{at}: {a}, {b}")],
    }
}

fn scores(report: &Report) -> Scores {
    report.mean.scores.unwrap()
}

#[test]
fn a_recording_is_replayed_as_what_was_fed() {
    let folder = Temporary::new("app-recorded");
    let mut core = open_core();
    let (fed, bytes) = fed_and_recorded(PictureCodec::Lossless);
    let path = folder.0.join("a.mcap");
    fs::write(&path, &bytes).unwrap();
    let stored = Stored::open(&path).unwrap();
    assert!(stored.losses().is_empty());
    let recorded = Capture::open(stored).unwrap();
    compare_scenes(&fed.scene, recorded.scene());
    compare_frames(&fed, &recorded);
    let (of_fed, fed_pictures) = replayed(&fed, &mut core, folder.0.join("fed"));
    let (of_recorded, pictures) = replayed(&recorded, &mut core, folder.0.join("recorded"));
    let found = differing(&untimed(&of_fed), &untimed(&of_recorded), "report");
    assert!(found.is_empty(), "{found:#?}");
    assert!(fed_pictures == pictures, "pictures differ");
    // A frame of another pose would be detected.
    let mut planted = Fed {
        scene: fed.scene.clone(),
        frames: fed.frames.clone(),
    };
    planted.frames[1].shown_pose = planted.frames[0].shown_pose.clone();
    let (of_planted, _) = replayed(&planted, &mut core, folder.0.join("planted"));
    assert!(!differing(&untimed(&of_fed), &untimed(&of_planted), "report").is_empty());

    // JPEG has the size that the page on recordings states for quality 90 without the plate, and no
    // more.
    let (_, bytes) = fed_and_recorded(PictureCodec::Jpeg { quality: 90 });
    let lossy = Capture::open(Recording::open(bytes).unwrap()).unwrap();
    let (of_lossy, _) = replayed(&lossy, &mut core, folder.0.join("lossy"));
    let (exact, lossy) = (scores(&of_fed), scores(&of_lossy));
    println!("{exact:?}\n{lossy:?}");
    let regions = [
        (exact.shadow, lossy.shadow, 0.6),
        (exact.toy, lossy.toy, 0.8),
        (exact.edge, lossy.edge, 1.0),
    ];
    for (exact, lossy, more) in regions {
        let (exact, lossy) = (exact.rmse, lossy.rmse);
        assert!(lossy > exact && lossy < exact + more, "{exact}, {lossy}");
    }
    compare_converted(&folder.0, &path);
}

#[test]
fn what_a_platform_cannot_encode_is_encoded_all_the_same() {
    // Mean absolute difference of the first picture from the input, in codes.
    let off = |encode: fn([u32; 2]) -> Option<Vec<u8>>| {
        let codec = PictureCodec::Platform(Box::new(move |image| encode(image.size_px())));
        let (fed, bytes) = fed_and_recorded(codec);
        let recorded = Capture::open(Recording::open(bytes).unwrap()).unwrap();
        let pair = [Arc::clone(&fed.frames[0].image), recorded.frame(0).unwrap().image];
        let codes = pair[0].rgba8.iter().zip(&pair[1].rgba8);
        let sum: u64 = codes.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        sum as f64 / pair[0].rgba8.len() as f64
    };
    let own = off(|size_px| Some(dark_jpeg(size_px)));
    assert!(own > 50.0, "the platform's file is kept: {own}");
    let (refused, no_picture) = (off(|_| None), off(|_| Some(b"no picture".to_vec())));
    assert!(refused < 2.0 && no_picture < 2.0, "{refused}, {no_picture}");
}

fn dark_jpeg([width, height]: [u32; 2]) -> Vec<u8> {
    let codes = vec![7; 3 * (width * height) as usize];
    let mut file = Vec::new();
    JpegEncoder::new(&mut file)
        .encode(&codes, width, height, ExtendedColorType::Rgb8)
        .unwrap();
    file
}

/// A recording's folder, and that folder's recording, are the same session.
fn compare_converted(folder: &Path, path: &Path) {
    let (out, again) = (folder.join("folder"), folder.join("again.mcap"));
    convert::write(&Stored::open(path).unwrap(), None, &out).unwrap();
    convert::write(&Stored::open(&out).unwrap(), None, &again).unwrap();
    let again = Stored::open(&again).unwrap();
    let first = Stored::open(path).unwrap();
    assert_eq!(again.paths().unwrap(), first.paths().unwrap());
    for path in first.paths().unwrap() {
        assert!(again.read(&path, 1 << 28).unwrap() == first.read(&path, 1 << 28).unwrap());
    }
}

fn compare_frames(fed: &Fed, recorded: &Capture) {
    for (index, given) in fed.frames.iter().enumerate() {
        let read = recorded.frame(index).unwrap();
        assert!(read.image.rgba8 == given.image.rgba8, "codes of frame {index}");
        let off = read.camera.world_from_camera - given.camera.world_from_camera;
        assert!(off.to_cols_array().iter().all(|off| off.abs() < 1e-12), "{off}");
        assert_eq!(read.camera.intrinsics, given.camera.intrinsics);
        assert_eq!(read.shown_pose, given.shown_pose);
        assert!((read.time_secs - given.time_secs).abs() < 1e-6, "{read:?}");
    }
}

fn compare_scenes(given: &Scene, read: &Scene) {
    assert_eq!((given.width_px, given.height_px), (read.width_px, read.height_px));
    assert!(given.receivers == read.receivers, "{:?}", read.receivers);
    assert!(read.lights.is_empty());
    assert_eq!((given.plates.len(), read.plates.len()), (1, 1));
    assert!(given.plates[0].image.rgba8 == read.plates[0].image.rgba8, "plate");
    let off = given.world_from_object - read.world_from_object;
    assert!(off.to_cols_array().iter().all(|off| off.abs() < 1e-12), "{off}");
    assert_eq!(given.toy.clip_names(), read.toy.clip_names());
}

/// Frames without a writer: none waits, and the loss is reported to the person and in the
/// recording.
#[test]
fn frames_never_wait_and_what_is_missing_is_told() {
    const N: u64 = 400;
    let mut app = happen(straight());
    let mut commands = app.event(ShellEvent::User(UserAction::Record(true)));
    let frame = |id: u64| {
        let time_ns = 10_000_000_000 + 33_000_000 * i64::try_from(id).unwrap();
        ShellEvent::Frame(Box::new(world::frame(1_000 + id, time_ns, 0, Tracking::Normal)))
    };
    for id in 0..N {
        commands.extend(app.event(frame(id)));
    }
    assert_eq!(app.notice(), Some(&Notice::RecordingDrops));
    let recordings = commands.into_iter().filter_map(|command| match command {
        ShellCommand::Work(WorkCommand::Record(job)) => job,
        _ => None,
    });
    let recordings: Vec<_> = recordings.collect();
    let [job] = <[Box<RecordingJob>; 1]>::try_from(recordings).unwrap();
    // The writer comes late: it writes the waiting items, and the new ones.
    let (done, is_done) = mpsc::channel();
    let writer = thread::spawn(move || {
        let toy = world::toy_file();
        let ended = written(*job, &toy, PictureCodec::Lossless);
        done.send(()).unwrap();
        ended
    });
    // Space runs short, which ends it without a request.
    while is_done.try_recv().is_err() {
        let _ = app.event(ShellEvent::FreeSpace(1 << 20));
        thread::yield_now();
    }
    let (bytes, outcome) = writer.join().unwrap();
    assert_eq!(outcome.ending, Ending::NoRoom);
    assert!(outcome.n_frames > 100, "{outcome:?}");
    assert_eq!(u64::from(outcome.n_frames) + outcome.n_dropped, N);
    let commands = app.event(ShellEvent::Recorded(Recorded {
        file: "a.mcap".to_owned(),
        outcome: outcome.clone(),
    }));
    assert!(matches!(
        commands[..],
        [ShellCommand::Work(WorkCommand::Record(None))]
    ));
    let recording = Recording::open(bytes).unwrap();
    assert!(recording.losses().is_empty());
    let notes = recording.notes();
    let told = |topic: Topic, words: &str| {
        notes
            .iter()
            .any(|note| note.topic == topic && note.message.contains(words))
    };
    assert!(told(Topic::Events, r#""event":"dropped""#));
    assert!(told(Topic::Events, r#""state":"Normal""#));
    assert!(told(Topic::Planes, r#""id":7"#));
    let capture = Capture::open(recording).unwrap();
    assert_eq!(capture.n_frames(), outcome.n_frames as usize);
}
