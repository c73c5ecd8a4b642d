//! Lists the clips of a toy.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use app_core::scene::Pose;
use app_core::toy::{ClipId, Toy};
use clap::Parser;
use desk::output::make_folder;
use desk::program::{exit_code, print, repository};
use desk::toy_file::read_toy;
use film::animate::outputs::write_rgb;
use film::small::sheet;
use film::thumbnail::Stand;

/// Default folder of sheets, below the top of the repository.
const RESULTS: &str = "target/film";
const FPS: f64 = 24.0;
/// Number of thumbnails of each clip, from its start to its end.
const N_THUMBNAILS: u32 = 6;
const THUMBNAIL_PX: u32 = 160;
const GAP_PX: u32 = 4;

/// List a toy's clips with their lengths, and draw a sheet of thumbnails: a row for each clip, from its start to its end.
#[derive(Parser)]
#[command(name = "clips", bin_name = "cargo xtask clips")]
struct Args {
    /// The toy's model, a glTF binary
    toy: PathBuf,
    /// The sheet, a PNG [default: target/film/ and the toy's name]
    #[arg(long, value_name = "SHEET.png")]
    out: Option<PathBuf>,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let toy = read(&args.toy)?;
    for warning in toy.warnings() {
        eprintln!("warning: {}: {warning}", args.toy.display());
    }
    if toy.clips().is_empty() {
        return print("the toy has no clips\n");
    }
    let mut text = table(&toy);
    let out = match &args.out {
        Some(out) => out.clone(),
        None => {
            let name = args.toy.file_stem().unwrap_or("toy".as_ref());
            repository().join(RESULTS).join(name).with_extension("clips.png")
        }
    };
    if let Some(folder) = out.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        make_folder(folder)?;
    }
    draw(&toy, &out)?;
    text += &format!("a row of thumbnails for each: {}\n", out.display());
    print(&text)
}

fn read(path: &Path) -> anyhow::Result<Toy> {
    Ok(Toy::from_glb(&path.display().to_string(), &read_toy(path)?)?)
}

fn table(toy: &Toy) -> String {
    let names = toy.clip_names();
    let width = names
        .iter()
        .map(|name| name.chars().count())
        .max()
        .unwrap_or(0)
        .max(4);
    let lines = names
        .iter()
        .zip(toy.clips())
        .enumerate()
        .map(|(index, (name, clip))| {
            let secs = clip.duration_secs;
            // The first and the last pose are both shown.
            let n_frames = (secs * FPS + 1e-6).floor() + 1.0;
            format!("#{index:<4} {name:width$} {secs:>9.3} {n_frames:>10}\n")
        });
    let head = format!(
        "{:5} {:width$} {:>9} {:>10}\n",
        "", "clip", "seconds", "at 24 fps"
    );
    head + &lines.collect::<String>()
}

fn draw(toy: &Toy, out: &Path) -> anyhow::Result<()> {
    let moments = |(id, secs): (ClipId, f64)| {
        (0..N_THUMBNAILS).map(move |k| Pose::Clip {
            clip: id,
            time_secs: secs * f64::from(k) / f64::from(N_THUMBNAILS - 1),
        })
    };
    let lengths = toy.clips().iter().map(|clip| clip.duration_secs);
    let poses: Vec<Pose> = toy.clip_ids().zip(lengths).flat_map(moments).collect();
    let stand = Stand::new(toy, &poses)?;
    let drawn = poses.iter().map(|pose| stand.draw(toy, pose, THUMBNAIL_PX));
    let drawn = drawn.collect::<Result<Vec<_>, _>>()?;
    write_rgb(out, &sheet(&drawn, N_THUMBNAILS, GAP_PX))
}
