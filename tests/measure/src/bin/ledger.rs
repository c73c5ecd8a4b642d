//! Prints the cost of a session's frames on any device, pass by pass. Needs no device.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use app_core::alignment::Observer;
use app_core::frame::FrameInput;
use app_core::grain::Grain;
use app_core::preset::Preset;
use app_core::scene::Scene;
use app_core::session::{Capture, Session};
use app_core::sharpness::Sharpness;
use clap::Parser;
use desk::files::BUNDLED_SESSION;
use desk::program::{exit_code, open_session, print};
use measure::count::{count, ledgers};
use measure::moved::first_moved;
use measure::scaling::{by_area, by_lights, by_picture, by_triangles};
use measure::sized::{SizePx, parse_size, sized_input, sized_scene};
use measure::stability::draw;

/// Print the cost of a session's frames on any device, pass by pass: triangles, vertices, bytes of
/// a tiler's memory traffic, copies of the screen; for a new pose, a new picture and a new view.
#[derive(Parser)]
#[command(name = "ledger", bin_name = "cargo xtask ledger")]
struct Args {
    /// Folder of the session, or a recording [default: the bundled one]
    session: Option<PathBuf>,
    /// Presets, separated by commas
    #[arg(
        long = "preset",
        alias = "presets",
        value_name = "NAME,...",
        value_delimiter = ',',
        default_value = "balanced"
    )]
    presets: Vec<Preset>,
    /// Size of the pictures, and of the screen [default: the session's]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    size: Option<SizePx>,
    /// Instead, draw how the cost of a ball grows with picture, region, lights and triangles, into this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["session", "presets", "size"])]
    scaling: Option<PathBuf>,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    if let Some(folder) = &args.scaling {
        return draw_scaling(folder);
    }
    let folder = args
        .session
        .clone()
        .unwrap_or_else(|| PathBuf::from(BUNDLED_SESSION));
    let session = Capture::open(open_session(&folder)?)?;
    let own_px = [session.scene().width_px, session.scene().height_px];
    let size_px = args.size.unwrap_or(own_px);
    let scene = sized_scene(session.scene(), size_px);
    let first =
        first_moved(&session)?.context("no frame shows the toy in another pose or at another place")?;
    let (scene, input) = observed(&scene, &sized_input(&first, size_px))?;
    let [width, height] = size_px;
    let mut text = String::new();
    for &preset in &args.presets {
        let counted = count(&scene, (preset, &[]), &input)?;
        text.push_str(&format!(
            "{} {preset} {width} x {height}{}\n{}",
            scene.name,
            in_words(&input),
            ledgers(&counted)
        ));
    }
    print(&text)
}

/// Scene and frame with what its picture shows beside toy and table, as every program gives it to the core: that costs, too.
fn observed(scene: &Scene, input: &FrameInput) -> anyhow::Result<(Scene, FrameInput)> {
    let mut observer = Observer::default();
    let observed = observer.observed(scene, input)?;
    let grain = Grain::of(scene, observed.image.rgba(), &observed.camera);
    Ok((observer.scene(scene), observed.with_grain(grain)))
}

/// The things in a picture, in words.
fn in_words(input: &FrameInput) -> String {
    let parts = [
        (input.things.is_some(), "other things"),
        (input.sharpness != Sharpness::SHARP, "softness"),
        (input.reflection.is_some(), "the toy's reflection"),
        (input.grain.is_some(), "grain"),
        (!input.gloss.is_none(), "gloss"),
    ];
    let parts = parts.into_iter().filter(|(is_there, _)| *is_there);
    let parts: Vec<&str> = parts.map(|(_, part)| part).collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!(", with {}", parts.join(" and "))
    }
}

fn draw_scaling(folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    for sweep in [by_picture()?, by_area()?, by_lights()?, by_triangles()?] {
        draw(folder, &sweep)?;
        let path = folder.join(format!("{}.svg", sweep.name));
        print(&format!("{}\n", path.display()))?;
    }
    Ok(())
}
