//! The ledger compared with the work that a device gets, and the budgets on the ledger.

mod budgets;
mod leaving;
mod scaling;

use std::collections::BTreeMap;

use app_core::Core;
use app_core::camera_frame::{CameraImage, Display};
use app_core::frame::{self, FrameInput, FrameReport, PassRun};
use app_core::preset::Preset;
use app_core::session::Session;
use app_pipeline::core::inspect::Inspect;
use harness::bundled_session;
use measure::bench::{FRAME_KINDS, with_new};
use measure::planar::{BT601_FULL, planar};

use crate::trace::{Objects, Pass, Traced};

/// A report in the form of a trace.
fn counted(report: &FrameReport, given: &BTreeMap<String, Pass>) -> BTreeMap<String, Pass> {
    counted_runs(&report.ran, given)
}

fn counted_runs(ran: &[PassRun], given: &BTreeMap<String, Pass>) -> BTreeMap<String, Pass> {
    let mut passes: BTreeMap<String, Pass> = BTreeMap::new();
    for run in ran {
        let pass = passes.entry(run.pass.to_owned()).or_default();
        let work = run.work;
        pass.n_runs += run.n_runs;
        pass.n_draws += work.n_draws();
        pass.triangles += work.triangles();
        pass.vertices += work.vertices();
        pass.bytes_written += work.bytes_written();
        // The trace does not contain the draws of compute passes.
        if given
            .get(run.pass)
            .is_some_and(|given| given.bytes_read.is_some())
        {
            *pass.bytes_read.get_or_insert(0) += work.bytes_read();
        }
    }
    passes
}

#[test]
fn the_ledger_without_a_device_is_what_a_device_is_given() {
    let session = bundled_session();
    let first = FrameInput::from(&session.frame(0).unwrap());
    let mut traced = Traced::new("ledger");
    for preset in [Preset::Paper, Preset::Balanced, Preset::Best] {
        let mut without = Core::counting();
        for core in [&mut traced.core, &mut without] {
            core.set_scene(session.scene().clone(), preset).unwrap();
        }
        // The first frame estimates everything anew, the others their changes.
        let mut steady = first.clone();
        let others = FRAME_KINDS.map(|kind| {
            steady = with_new(&steady, kind);
            steady.clone()
        });
        for (index, input) in [&first].into_iter().chain(&others).enumerate() {
            let (report, given) = traced.frame(input);
            let given = given.passes;
            let what = format!("{preset}, frame {index}");
            let ledger = without.frame(input).unwrap();
            assert_eq!(
                counted(&ledger, &given),
                given,
                "{what}: by the ledger, and by the trace"
            );
            assert_eq!(ledger.ran, report.ran, "{what}");
            assert_eq!(ledger.uploaded_bytes, report.uploaded_bytes, "{what}");
        }
        assert_eq!(
            traced.core.memory().held_bytes,
            without.memory().held_bytes,
            "{preset}"
        );
        assert!(without.read_picture().is_err());
    }
}

/// Screens on which the region is the smaller part, and the larger; its effect in full, in part and
/// not at all; pixels and planes.
#[test]
fn a_screen_costs_what_a_device_is_given() {
    let session = bundled_session();
    let mut input = FrameInput::from(&session.frame(0).unwrap());
    let mut traced = Traced::new("ledger-screen");
    traced
        .core
        .set_scene(session.scene().clone(), Preset::Balanced)
        .unwrap();
    let pixels = input.image.clone();
    let planes = CameraImage::from(planar(pixels.rgba(), BT601_FULL).unwrap());
    let large = [400, 300];
    let (narrow, small) = ([90, 400], [8, 8]);
    for ([width, height], effect, image) in [
        (large, 1.0, &pixels),
        (narrow, 0.4, &pixels),
        (large, 0.0, &pixels),
        (large, 1.0, &planes),
        (narrow, 1.0, &planes),
        (narrow, 0.4, &planes),
        (small, 1.0, &planes),
    ] {
        input.image = image.clone();
        input.effect = effect;
        traced.core.frame(&input).unwrap();
        let screen = traced.core.hidden_screen([width, height]).unwrap();
        traced.given();
        traced.core.draw_on(&screen, Display::default()).unwrap();
        let given = traced.given().passes;
        let work = traced
            .core
            .count_present([width, height], Display::default())
            .unwrap();
        let on_screen = PassRun {
            path: frame::PassGroup::Frame,
            pass: "screen",
            n_runs: 1,
            work,
        };
        let expected = counted_runs(&[on_screen], &given);
        assert_eq!(expected, given, "{width} x {height}, effect {effect}");
    }
}

/// A draw, a store or a texel that the ledger does not contain is detected.
#[test]
fn what_is_planted_in_a_trace_is_found() {
    let session = bundled_session();
    let first = FrameInput::from(&session.frame(0).unwrap());
    let mut traced = Traced::new("ledger-planted");
    traced
        .core
        .set_scene(session.scene().clone(), Preset::Balanced)
        .unwrap();
    let mut report = traced.core.frame(&first).unwrap();
    let text = traced.text();
    let honest = Objects::default().take(&text).passes;
    assert_eq!(counted(&report, &honest), honest);
    for (from, to) in [
        ("instance_count: 32,", "instance_count: 31,"),
        ("store_op: discard,", "store_op: store,"),
        ("format: \"rgba16float\"", "format: \"rgba32float\""),
        ("load_op: clear((", "load_op: load,("),
        (
            "label: Some(\"coverage\"),\n            commands",
            "label: Some(\"cover\"),\n            commands",
        ),
    ] {
        let planted = text
            .replace(from, to)
            .replace("load_op: load,(", "load_op: load,\n((");
        assert_ne!(planted, text, "{from}");
        let planted = Objects::default().take(&planted).passes;
        assert_ne!(counted(&report, &planted), planted, "{from}");
    }
    report.ran.pop();
    assert_ne!(counted(&report, &honest), honest);
}
