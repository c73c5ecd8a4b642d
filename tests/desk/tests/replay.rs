//! The bundled session end to end: through the library into pictures and a report, and through the program into
//! errors that a person can act on.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::ops::{Deref, Range};
use std::path::{Path, PathBuf};
use std::process::{self, Command, Output};

use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::session::{Capture, GroundTruth, Session};
use app_core::wgpu;
use desk::files::{BUNDLED_SESSION, Folder};
use desk::frames::Frames;
use desk::metrics::{Score, Scores, score};
use desk::output::folder::{MANIFEST_FILE, OutputFolder};
use desk::page::film::{self, Film, FilmFrame};
use desk::page::{INPUTS_FOLDER, MAPS_FOLDER, PAGE_FILE, VALUES_FOLDER};
use desk::progress::Quiet;
use desk::replay::{Options, REPORT_FILE, ReplayError, picture_file, replay};
use desk::report::{Report, mean_scores};

/// The bundled session ends with a frame that shows the real toy's own pose.
const IDENTITY_FRAME: usize = 4;

fn bundled() -> Capture {
    Capture::open(Folder::open(BUNDLED_SESSION).unwrap()).unwrap()
}

/// Replays with one preset.
fn run(session: &Capture, options: &Options) -> Result<Report, ReplayError> {
    run_all(session, options).map(|mut reports| reports.remove(0))
}

fn run_all(session: &Capture, options: &Options) -> Result<Vec<Report>, ReplayError> {
    let instance = wgpu::Instance::default();
    let mut core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest)).unwrap();
    replay(session, Some(session), &mut core, options, &mut Quiet)
}

#[test]
fn the_bundled_session_becomes_pictures_and_a_report() {
    let (session, out) = (bundled(), TemporaryFolder::new("whole"));
    let options = Options {
        out: Some(out.to_owned()),
        ..Options::default()
    };
    let report = run(&session, &options).unwrap();

    assert_eq!(out.names(), names_of(0..session.n_frames()));
    for index in 0..session.n_frames() {
        let picture = image::open(out.join(picture_file(index))).unwrap().into_rgba8();
        let frame = session.frame(index).unwrap().image;
        assert_eq!(picture.dimensions(), (frame.width_px, frame.height_px));
        let is_camera_frame = picture.as_raw() == &frame.rgba8;
        assert_eq!(is_camera_frame, index == IDENTITY_FRAME, "frame {index}");
    }

    let json: serde_json::Value = serde_json::from_slice(&fs::read(out.join(REPORT_FILE)).unwrap()).unwrap();
    assert_eq!(json["session"], "llama");
    assert_eq!(json["frames"].as_array().unwrap().len(), session.n_frames());
    assert_eq!(json["frames"][0]["ran"][0]["path"], "capture");
    assert_eq!(json["frames"][1]["ran"][0]["path"], "frame");
    assert_eq!(json["frames"][IDENTITY_FRAME]["scores"]["frame"]["rmse"], 0.0);
    assert!(
        json["frames"][0]["flicker"].is_null() && json["frames"][1]["flicker"]["toy"].as_f64().unwrap() > 0.0
    );
    assert!(json["mean"]["flicker"]["shadow"].as_f64().unwrap() > 0.0);
    // The frame that passes through has no error, which must not improve the mean of those that move.
    let [all, moving] =
        [&report.mean, &report.mean_of_moving].map(|mean| (mean.n_scored, mean.scores.unwrap().shadow.rmse));
    assert_eq!((all.0, moving.0), (5, 4));
    assert!((moving.1 * 4.0 - all.1 * 5.0).abs() < 1e-9, "{all:?} {moving:?}");
    assert_eq!(json["mean_of_moving"]["n_steady"], json["mean"]["n_steady"]);
    assert_eq!(
        json["fit"]["direct_fraction"].as_array().unwrap().len(),
        session.scene().lights.len()
    );
    let [first, .., last] = [0, 1, 2, 3, 4].map(|index| report.frames[index].scores.unwrap().shadow.rmse);
    assert!(first > 0.0 && last == 0.0, "{first} {last}");
}

#[test]
fn only_the_frames_asked_for_are_written_and_an_old_replay_goes_first() {
    let (session, out) = (bundled(), TemporaryFolder::new("some"));
    let options = |frames| Options {
        frames: Frames::from(frames),
        out: Some(out.to_owned()),
        ..Options::default()
    };

    // A folder that is not empty, so that no file can replace it.
    let obstacle = out.join(picture_file(4));
    fs::create_dir_all(obstacle.join("full")).unwrap();
    let error = run(&session, &options(3..5)).unwrap_err().to_string();
    assert!(error.contains(obstacle.to_str().unwrap()), "{error}");
    let whole = [picture_file(3), picture_file(4)];
    let whole = [
        &[MANIFEST_FILE.to_owned()],
        &whole[..],
        &[PAGE_FILE, INPUTS_FOLDER, MAPS_FOLDER, REPORT_FILE, VALUES_FOLDER].map(str::to_owned),
    ];
    assert_eq!(
        out.names(),
        whole.concat(),
        "what was whole stays, with its report and page, and no remnants"
    );

    fs::remove_dir_all(&obstacle).unwrap();
    let report = run(&session, &options(4..5)).unwrap();
    let indices: Vec<usize> = report.frames.iter().map(|frame| frame.index).collect();
    assert_eq!(indices, [4]);
    assert_eq!(out.names(), names_of(4..5), "nothing of the run before");
}

#[test]
fn a_folder_loses_only_what_a_run_wrote_and_takes_one_run_at_a_time() {
    let out = TemporaryFolder::new("owned");
    let refusal = || OutputFolder::take(&out).unwrap_err().to_string();
    let own = out.join("holiday.png");
    fs::write(&own, "a user's").unwrap();
    assert!(refusal().contains("holiday.png was not written by an earlier run"));
    assert_eq!(out.names(), ["holiday.png"]);
    fs::remove_file(&own).unwrap();

    let folder = OutputFolder::take(&out).unwrap();
    folder.write("flat/frame_0099.png", b"ours").unwrap();
    folder.write("report.json", b"ours").unwrap();
    assert!(refusal().contains("another run is writing"), "{}", refusal());
    assert!(out.join("report.json").exists());
    drop(folder);

    // Remnants of a killed run and files of a desktop are ignored.
    fs::write(out.join("report.json.4711.partial"), "half").unwrap();
    fs::write(out.join(".DS_Store"), "of a desktop").unwrap();
    fs::write(out.join("report.json"), "a user's notes").unwrap();
    assert!(refusal().contains("report.json was changed"), "{}", refusal());
    assert!(
        out.join("flat/frame_0099.png").exists(),
        "a refusal removes nothing"
    );
    fs::write(out.join("report.json"), "ours").unwrap();
    // A list that someone edited cannot reach beyond its folder.
    let list = fs::read_to_string(out.join(MANIFEST_FILE)).unwrap();
    fs::write(out.join(MANIFEST_FILE), format!("{list}00000000 ../outside\n")).unwrap();
    drop(OutputFolder::take(&out).unwrap());
    assert_eq!(out.names(), [".DS_Store", MANIFEST_FILE]);
}

#[test]
fn frames_are_named_by_one_number_or_by_a_range_that_may_be_open() {
    let named = |text: &str| text.parse::<Frames>().map(|frames| frames.within(5));
    for (text, range) in [("3", 3..4), ("3..", 3..5), ("..2", 0..2), ("1..5", 1..5)] {
        assert_eq!(named(text).unwrap().unwrap(), range, "{text}");
    }
    for text in [
        "",
        "..",
        "3..3",
        "4..2",
        "-1",
        "1..2..3",
        "a",
        "18446744073709551615",
    ] {
        assert!(named(text).is_err(), "{text}");
    }
    for text in ["5", "5..", "..6", "4..6"] {
        let error = named(text).unwrap().unwrap_err().to_string();
        assert_eq!(
            error,
            format!("frames {text} are asked for, but the session has 5, counted from 0")
        );
    }
}

#[test]
fn the_page_needs_nothing_but_its_folder_and_runs_no_text_of_a_session() {
    const NAME: &str = "</script><script>alert(1)</script>";
    let (folder, out) = (TemporaryFolder::new("named"), TemporaryFolder::new("page"));
    copy_bundled(&folder);
    let index = fs::read_to_string(folder.join("capture.json")).unwrap();
    let mut index: serde_json::Value = serde_json::from_str(&index).unwrap();
    index["name"] = NAME.into();
    fs::write(folder.join("capture.json"), index.to_string()).unwrap();
    let session = Capture::open(Folder::open(&*folder).unwrap()).unwrap();
    let options = Options {
        presets: vec![Preset::Flat, Preset::Balanced],
        frames: Frames::from(1..2),
        out: Some(out.to_owned()),
        ..Options::default()
    };
    run_all(&session, &options).unwrap();

    let page = fs::read_to_string(out.join(PAGE_FILE)).unwrap();
    assert_eq!(
        page.matches("</script>").count(),
        2,
        "one for the data, one for the script"
    );
    for remote in [
        "http:", "https:", "src=\"", "href=", "url(", "@import", "fetch(", "{{",
    ] {
        // A filter of the page's own is no remote file.
        assert!(!page.replace("url(#", "").contains(remote), "{remote}");
    }
    let data = data_of(&out);
    assert_eq!(data["session"], NAME);
    check_values(&out, "flat/frame_0001.png");
    check_values(&out, "inputs/truth_0001.png");
    let mut n_pictures = 0;
    let mut check = |folder: &serde_json::Value, file: &serde_json::Value| {
        let path = out.join(folder.as_str().unwrap()).join(file.as_str().unwrap());
        assert_eq!(
            image::image_dimensions(&path).unwrap(),
            (640, 360),
            "{}",
            path.display()
        );
        n_pictures += 1;
    };
    let (inputs, presets) = (&data["frames"][0], data["presets"].as_array().unwrap());
    check(&"".into(), &inputs["before"]);
    check(&"".into(), &inputs["truth"]);
    for preset in presets {
        let frame = &preset["report"]["frames"][0];
        check(&preset["folder"], &frame["picture"]);
        check(&preset["folder"], &frame["error"]);
        for map in frame["maps"].as_array().unwrap() {
            check(&preset["folder"], &map["file"]);
        }
    }
    // Inputs, then picture, error and maps of each preset, including the lights over the photograph.
    assert_eq!((presets.len(), n_pictures), (2, 2 + 2 + 5 + 2 + 11));
}

#[test]
fn the_page_of_a_film_says_what_each_frame_is_made_of() {
    let out = TemporaryFolder::new("film");
    let output = OutputFolder::take(&out).unwrap();
    let scores = |rmse| {
        let score = Score { rmse, ssim: 1.0 };
        Scores {
            shadow: score,
            toy: score,
            edge: score,
            frame: score,
        }
    };
    let frame = |index: usize| FilmFrame {
        index: 1001 + index,
        time_secs: index as f64 / 24.0,
        picture: picture_file(1001 + index),
        words: vec![format!("key {index} </script>")],
        scores: Some(scores(1.0 + 2.0 * index as f64)),
        ..FilmFrame::default()
    };
    let pictures = bundled().frame(0).unwrap().image;
    film::write_picture(&output, &picture_file(1001), &pictures).unwrap();
    let film = Film {
        title: "walk",
        size_px: [640, 360],
        pictures: Vec::new(),
        frames: vec![frame(0), frame(1)],
    };
    film::write(&output, &film).unwrap();
    check_values(&out, &picture_file(1001));
    let data = data_of(&out);
    assert_eq!(data["frames"][1]["index"], 1002);
    let report = &data["presets"][0]["report"];
    assert_eq!(report["frames"][1]["words"][0], "key 1 </script>");
    assert_eq!(report["mean_of_moving"]["scores"]["toy"]["rmse"], 2.0);
}

/// The data of a page's script.
fn data_of(out: &Path) -> serde_json::Value {
    let page = fs::read_to_string(out.join(PAGE_FILE)).unwrap();
    let (_, data) = page.split_once("id=\"data\">").unwrap();
    serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap()
}

/// The script that hands a picture's bytes to the page holds all of them.
fn check_values(out: &Path, file: &str) {
    let script = fs::read_to_string(out.join(VALUES_FOLDER).join(format!("{file}.js"))).unwrap();
    let text = script
        .strip_prefix(&format!("takeValues(\"{file}\", \""))
        .unwrap();
    let text = text.strip_suffix("\");\n").unwrap();
    let bytes = text
        .chars()
        .map(|character| u8::try_from(u32::from(character) - 0x100).unwrap());
    assert!(bytes.eq(fs::read(out.join(file)).unwrap()), "{file}");
}

#[test]
fn the_folder_of_a_session_is_never_written_to() {
    let (session, out) = (bundled(), TemporaryFolder::new("session"));
    fs::copy(
        Path::new(BUNDLED_SESSION).join("capture.json"),
        out.join("capture.json"),
    )
    .unwrap();
    let error = run(
        &session,
        &Options {
            out: Some(out.to_owned()),
            ..Options::default()
        },
    )
    .unwrap_err();
    assert!(matches!(error, ReplayError::OutIsSession { .. }), "{error}");
    assert_eq!(out.names(), ["capture.json"]);
}

/// Mean RMSE and SSIM over shadow, toy, edge and frame of the bundled session, for pictures that do not depend on this
/// project's pipeline. Recorded with a scorer in Python that shares no code with ours: scikit-image 0.26,
/// `structural_similarity` (Gaussian weights, sigma 1.5, biased covariance, data range 255) and `dilation` and
/// `erosion` by squares.
const RECORDED_FOR_INPUT: [[f64; 2]; 4] = [
    [18.8630, 0.84161],
    [27.6232, 0.67717],
    [18.5666, 0.67802],
    [9.8155, 0.95588],
];
const RECORDED_FOR_PLATE: [[f64; 2]; 4] = [
    [34.5451, 0.81998],
    [55.5540, 0.37039],
    [31.0878, 0.28529],
    [18.4957, 0.92791],
];

#[test]
fn scores_agree_with_an_independent_scorer() {
    let session = bundled();
    let plate = &session.scene().plates[0].image;
    check_recorded(
        &mean_over_truths(&session, |_| plate.as_ref().clone()),
        &RECORDED_FOR_PLATE,
    );
    let input = |index| session.frame(index).unwrap().image.as_ref().clone();
    check_recorded(&mean_over_truths(&session, input), &RECORDED_FOR_INPUT);
}

fn mean_over_truths(session: &Capture, picture: impl Fn(usize) -> Image) -> Scores {
    let score_of = |index| {
        let truth = session.truth(index).unwrap().unwrap();
        score(&picture(index), &truth).unwrap()
    };
    mean_scores(&(0..session.n_frames()).map(score_of).collect::<Vec<_>>()).unwrap()
}

fn check_recorded(actual: &Scores, recorded: &[[f64; 2]; 4]) {
    let actual: [Score; 4] = [actual.shadow, actual.toy, actual.edge, actual.frame];
    for (actual, [rmse, ssim]) in actual.iter().zip(recorded) {
        // The last digit recorded.
        assert!(
            (actual.rmse - rmse).abs() < 1e-4 && (actual.ssim - ssim).abs() < 1e-5,
            "{actual:?} {rmse} {ssim}"
        );
    }
}

#[test]
fn the_program_says_what_is_wrong() {
    let out = TemporaryFolder::new("program");
    let out_arg = out.to_str().unwrap();
    let missing = out.join("missing");
    let missing_arg = missing.to_str().unwrap();
    #[rustfmt::skip] // One case a line.
    let cases: [(&[&str], i32, &str); 8] = [
        (&["--preset", "dazzling"], 2, "preset \"dazzling\" does not exist; choose one of flat, paper, fast, balanced"),
        (&["--frames", "3..3"], 2, "3..3"),
        (&["--frames", "3-4"], 2, "3-4"),
        (&["--frames", "3..6"], 1, "frames 3..6 are asked for, but the session has 5"),
        (&["--adapter", "abacus"], 1, "\"abacus\""),
        (&["--adapter", "abacus"], 1, "; on Debian or Ubuntu `apt-get install mesa-vulkan-drivers`"),
        (&[missing_arg], 1, missing_arg),
        (&[out_arg], 1, "capture.json"),
    ];
    for (args, code, cause) in cases {
        let output = program(&[args, &["--out", out_arg]].concat());
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{args:?}: {stderr}");
        let mut lines = stderr.lines().filter(|line| line.starts_with("error: "));
        let error = lines.next_back().unwrap_or_default();
        assert!(error.contains(cause), "{args:?}: {stderr}");
        assert!(!stderr.contains("panicked"), "{args:?}: {stderr}");
        assert_eq!(out.names(), [""; 0], "{args:?}");
    }
}

#[test]
fn the_program_replays_quietly() {
    let out = TemporaryFolder::new("quiet");
    let args = [
        "--quiet",
        "--strict",
        "--frames",
        "4..",
        "--out",
        out.to_str().unwrap(),
    ];
    let output = program(&args);
    assert!(output.status.success() && output.stdout.is_empty(), "{output:?}");
    assert_eq!(out.names(), names_of(4..5));
}

#[test]
fn a_strict_replay_fails_by_a_warning() {
    let (folder, out) = (TemporaryFolder::new("dark"), TemporaryFolder::new("strict"));
    copy_bundled(&folder);
    let index = fs::read_to_string(folder.join("capture.json")).unwrap();
    let mut index: serde_json::Value = serde_json::from_str(&index).unwrap();
    index["backgrounds"] = serde_json::json!([]);
    fs::write(folder.join("capture.json"), index.to_string()).unwrap();
    let args = [
        "--preset",
        "flat",
        "--frames",
        "1",
        "--out",
        out.to_str().unwrap(),
    ];
    let args = [&[folder.to_str().unwrap()], &args[..]].concat();
    let lenient = program(&args);
    assert!(lenient.status.success(), "{lenient:?}");
    let said = String::from_utf8_lossy(&lenient.stdout);
    assert!(
        said.contains("0 of 1 frames retargeted; 1 passed through"),
        "{said}"
    );
    let strict = program(&[&args[..], &["--strict"]].concat());
    assert_eq!(strict.status.code(), Some(1), "{strict:?}");
    assert!(
        String::from_utf8_lossy(&strict.stderr).contains("--strict"),
        "{strict:?}"
    );
}

/// All files of a replay of these frames with one preset.
fn names_of(frames: Range<usize>) -> Vec<String> {
    let mut names = vec![MANIFEST_FILE.to_owned()];
    names.extend(frames.map(picture_file));
    names.extend([PAGE_FILE, INPUTS_FOLDER, MAPS_FOLDER, REPORT_FILE, VALUES_FOLDER].map(str::to_owned));
    names
}

fn copy_bundled(folder: &Path) {
    for entry in fs::read_dir(BUNDLED_SESSION).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
    }
}

fn program(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_replay"))
        .args(args)
        .output()
        .unwrap()
}

/// A temporary folder that is removed after its test.
struct TemporaryFolder(PathBuf);

impl TemporaryFolder {
    fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("replay-{name}-{}", process::id()));
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    /// Names in the folder, in order.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

impl Deref for TemporaryFolder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        // A remnant in the target folder does no harm.
        let _ = fs::remove_dir_all(&self.0);
    }
}
