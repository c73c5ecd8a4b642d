//! The output of a measurement of the bundled session, as a program reads it.

use app_core::preset::Preset;
use desk::alignment::{Lights, Ratio};
use harness::{bundled_session, open_core};
use measure::bench::{
    Draw, FrameKind, Options, Point, PoseAndLightErrors, Pull, Row, basin, basin_csv, basin_drawing,
    basin_table, bench, claims_drawing, claims_summary, csv, front, front_drawing, json, points,
};
use serde_json::Value;

#[test]
fn rows_are_complete_and_the_published_method_is_the_unit() {
    let session = bundled_session();
    let mut core = open_core();
    let options = Options {
        presets: vec![Preset::Balanced, Preset::Paper],
        with_front: true,
        n_repeats: 1,
        frames: (0..2).into(),
        size_px: None,
        as_planes: true,
        with_exact: false,
        is_aligned: true,
        ratio: Ratio::Given,
        lights: Lights::Given,
    };
    let measured = bench(&session, &mut core, &options).unwrap();
    let text = csv(&measured);
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let [header, rows @ ..] = &lines[..] else {
        panic!("{text}");
    };
    assert!(lines.iter().all(|line| line.len() == header.len()), "{text}");
    let column = |name: &str| header.iter().position(|head| *head == name).unwrap();
    let number = |line: &[&str], name: &str| line[column(name)].parse::<f64>().unwrap();
    let named: Vec<[&str; 3]> = rows
        .iter()
        .map(|line| ["session", "preset", "frame_kind"].map(|name| line[column(name)]))
        .collect();
    let presets = named_presets();
    let expected: Vec<[[&str; 3]; 3]> = presets
        .iter()
        .map(|preset| ["pose", "picture", "view"].map(|kind| ["llama", preset, kind]))
        .collect();
    assert_eq!(named, expected.as_flattened());
    for line in rows {
        assert_eq!([number(line, "width"), number(line, "height")], [640.0, 360.0]);
        for name in [
            "shadow_rmse",
            "shadow_ssim",
            "frame_rmse",
            "frame_ssim",
            "shadow_flicker",
            "frame_flicker",
            "cpu_ms_median",
            "ratio_to_paper",
        ] {
            let value = number(line, name);
            assert!(value.is_finite() && value > 0.0, "{name}: {value}");
        }
        let ratio = number(line, "ratio_to_paper") * number(line, "times_faster_than_paper");
        assert!((ratio - 1.0).abs() < 1e-3, "{text}");
    }
    for (balanced, paper) in rows[..3].iter().zip(&rows[3..6]) {
        assert_eq!(paper[column("ratio_to_paper")], "1.000000");
        // Only the published method searches, and a search tests whole rings.
        assert_eq!(balanced[column("taps_per_missing_texel")], "");
        assert!(number(paper, "taps_per_missing_texel") >= 16.0, "{text}");
    }
    assert_same(&measured, header, rows);
    assert_drawn(&measured, presets.len());
    assert_stages(&measured);
    if !rows[0][column("gpu_ms_median")].is_empty() {
        let passes: Vec<&str> = rows.iter().map(|row| row[column("pass_ms")]).collect();
        assert_ran(&passes);
    }
}

/// Each kind of frame runs the passes that it needs, among those that the device timed: first three
/// rows of `balanced`, then of `paper`.
fn assert_ran(pass_ms: &[&str]) {
    let ran = |first: usize, pass: &str| {
        let start = format!("{pass}=");
        let entries = |row: &str| row.split(' ').any(|entry| entry.starts_with(&start));
        [0, 1, 2].map(|kind| entries(pass_ms[first + kind]))
    };
    for (first, pass, runs) in [
        (0, "composite", [true; 3]),
        (0, "residual", [false, true, true]),
        (0, "gbuffer", [false, false, true]),
        // The published method has planes decoded, once a picture; the model reads them directly.
        (0, "camera_planes", [false; 3]),
        (3, "camera_planes", [false, true, true]),
    ] {
        assert_eq!(ran(first, pass), runs, "{pass}: {pass_ms:?}");
    }
}

/// Number of the governor's steps that change a setting.
const N_TURNED_DOWN: usize = 6;

/// The JSON for programs has the same content as the table.
fn assert_same(rows: &[Row], header: &[&str], lines: &[Vec<&str>]) {
    let json = json(rows);
    let json = json.as_array().unwrap();
    assert_eq!(json.len(), lines.len());
    for (object, line) in json.iter().zip(lines) {
        for (head, cell) in header.iter().zip(line) {
            let is_same = match &object[*head] {
                Value::Null => cell.is_empty(),
                Value::String(text) => text == cell,
                Value::Number(number) => {
                    (number.as_f64().unwrap() - cell.parse::<f64>().unwrap()).abs() < 1e-5
                }
                Value::Object(passes) => {
                    passes.len() == cell.split(' ').filter(|entry| !entry.is_empty()).count()
                }
                _ => false,
            };
            assert!(is_same, "{head}: {} and {cell}", object[*head]);
        }
    }
}

/// The presets of the rows; the reduced settings come after them.
fn named_presets() -> Vec<String> {
    let quality_reductions = (1..=N_TURNED_DOWN).map(|n| format!("balanced-{n}"));
    let presets = ["balanced", "paper"].map(str::to_owned);
    presets.into_iter().chain(quality_reductions).collect()
}

/// Medians of stages need not add up to the median of their sum, but nearly do.
fn assert_stages(rows: &[Row]) {
    for kind in rows.iter().flat_map(|row| &row.times) {
        let sum: f64 = kind.stages.iter().map(|(_, ms)| ms).sum();
        let names: Vec<&str> = kind.stages.iter().map(|(name, _)| *name).collect();
        assert!(
            ["encode", "submit", "screen"]
                .iter()
                .all(|name| names.contains(name)),
            "{kind:?}"
        );
        assert!((0.5..1.5).contains(&(sum / kind.cpu_ms.unwrap())), "{kind:?}");
    }
}

/// Each setting is a point for each kind of frame, fastest first.
fn assert_drawn(rows: &[Row], n_settings: usize) {
    let of_pictures = points(rows, FrameKind::Picture);
    assert_eq!(of_pictures.len(), n_settings);
    assert!(of_pictures.is_sorted_by(|a, b| a.time <= b.time));
    let drawing = front_drawing(rows).unwrap();
    assert_eq!(drawing.matches("<circle").count(), 3 * n_settings, "{drawing}");
}

#[test]
fn the_front_is_of_what_nothing_faster_is_as_good_as() {
    let points = [
        ("a", 0.2, 3.0),
        ("b", 0.4, 3.5),
        ("c", 0.5, 2.0),
        ("d", 0.9, 2.0),
        ("e", 1.0, 1.0),
    ];
    let points = points.map(|(name, time, error)| Point {
        name: name.to_owned(),
        time,
        error,
    });
    let names: Vec<&str> = front(&points).iter().map(|point| point.name.as_str()).collect();
    assert_eq!(names, ["a", "c", "e"]);
}

#[test]
fn starts_of_the_basin_are_as_far_off_as_they_say_and_drawn_from_their_seed() {
    let session = bundled_session();
    let draws = basin(&session, 1, 2).unwrap();
    assert_eq!(draws, basin(&session, 1, 2).unwrap());
    let [half, whole] = draws[..] else {
        panic!("{draws:?}");
    };
    for (draw, part) in [(half, 0.5), (whole, 1.0)] {
        let is_close = |number: f64, expected: f64| (number - part * expected).abs() < 1e-6;
        let start = draw.start;
        assert!(
            is_close(start.pose_mm, 30.0) && is_close(start.pose_deg, 18.0),
            "{start:?}"
        );
        assert!(is_close(start.light_deg.unwrap(), 30.0), "{start:?}");
    }
    // Another seed starts elsewhere, and so ends elsewhere, if only by rounding.
    assert_ne!(draws[0].end, basin(&session, 2, 2).unwrap()[0].end);

    let csv = basin_csv(&draws);
    assert_eq!(csv.lines().count(), 3, "{csv}");
    assert!(
        csv.lines().nth(1).unwrap().starts_with("15.0000,9.0000,15.0000,"),
        "{csv}"
    );
    assert_eq!(basin_table(&draws).lines().count(), 4);
    // Pose, turn and light of each start, and three errors of each pose.
    let drawing = basin_drawing("llama", &draws).unwrap();
    assert!(
        drawing.starts_with("<svg") && drawing.matches("<circle").count() == 12,
        "{drawing}"
    );
}

#[test]
fn claims_that_are_too_small_show_in_the_table_of_the_basin() {
    let off = PoseAndLightErrors {
        pose_mm: 1.0,
        pose_deg: 1.0,
        light_deg: None,
    };
    let draw = |error: f64| Draw {
        start: off,
        end: off,
        pull: Some(Pull {
            errors: [error; 3],
            claimed: [0.1; 3],
        }),
    };
    let last_line = |draws: &[Draw]| basin_table(draws).lines().last().unwrap().to_owned();
    assert!(last_line(&[draw(0.05), draw(0.1)]).starts_with("100 % of 6 "));
    assert!(last_line(&[draw(0.05), draw(0.3)]).starts_with("50 % of 6 "));
    let unapplied = Draw {
        pull: None,
        ..draw(0.1)
    };
    assert!(!last_line(&[unapplied]).contains('%'));

    // Of several sessions together, three errors of each applied pose are drawn.
    let sessions = [vec![draw(0.05), unapplied], vec![draw(0.3)]];
    let summary = claims_summary(&sessions).unwrap();
    let expected = "2 sessions, 2 of 3 poses applied: 50 % of 6 ";
    assert!(summary.starts_with(expected), "{summary}");
    let drawing = claims_drawing(&sessions).unwrap();
    assert!(
        drawing.starts_with("<svg") && drawing.contains(expected),
        "{drawing}"
    );
    assert_eq!(drawing.matches("<circle").count(), 6, "{drawing}");
    assert_eq!(claims_summary(&[vec![unapplied]]), None);
    assert!(claims_drawing(&[vec![unapplied]]).is_ok());
}
