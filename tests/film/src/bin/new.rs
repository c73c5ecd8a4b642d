//! Makes a session from photographs.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use clap::Parser;
use desk::program::{exit_code, print};
use film::length::metres;
use film::new::{DRAWING, Key, View, Wanted, new};
use film::quoted::quoted;
use glam::DVec3;

/// Make a session from photographs: the place without the toy, then the toy on it. The toy is the
/// marker: camera, table and lights are estimated from it. If the result is uncertain, the program
/// says why and writes nothing.
#[derive(Parser)]
#[command(name = "new", bin_name = "cargo xtask new")]
struct Args {
    /// Photographs of the place without the toy, if there are any, and one of the toy last; PNG or
    /// JPEG, or a video from a camera that stands still, if ffmpeg is installed: `animate --moving`
    /// then shows each of its pictures at its time
    #[arg(required = true, value_name = "PLATE... PHOTO")]
    photographs: Vec<PathBuf>,
    /// The toy's model, a .glb
    #[arg(long, value_name = "TOY.glb")]
    toy: PathBuf,
    /// Folder of the new session
    #[arg(long, value_name = "SESSION")]
    out: PathBuf,
    /// The toy's height as it stands, such as 12cm [default: the model's, in metres]
    #[arg(long, value_name = "LENGTH", value_parser = metres)]
    height: Option<f64>,
    /// The pose of the printed toy: a clip of the model and seconds in it [default: as authored]
    #[arg(long, value_name = "CLIP@TIME", value_parser = moment)]
    pose: Option<(String, f64)>,
    /// Focal length as on 35 mm film, in millimetres [default: the photograph's, by its EXIF]
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    focal_35mm: Option<f64>,
    /// The visible side of the toy: front, left, back or right, and low or high after a comma
    /// [default: all are tried]
    #[arg(long, default_value = None, value_name = "SIDE[,HEIGHT]")]
    view: Option<View>,
    /// The model's axis that points up as it stands: +x, -x, +y, -y, +z or -z
    #[arg(long, default_value = "+y", value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    up: DVec3,
    /// The photograph of another print and its pose; one for each further key of a film, in their
    /// order. A shot for `inbetween` is then written, too
    #[arg(long, value_name = "PHOTO@CLIP@TIME", value_parser = key)]
    key: Vec<Key>,
    /// Seconds of the film between two keys
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0, value_parser = seconds)]
    apart: f64,
    /// Height of the toy's lowest points above the table, if it does not stand on it
    #[arg(long, value_name = "LENGTH", value_parser = metres)]
    lifted: Option<f64>,
}

fn main() -> ExitCode {
    exit_code(run(Args::parse()))
}

fn run(args: Args) -> anyhow::Result<()> {
    let wanted = Wanted {
        photographs: args.photographs,
        toy: args.toy,
        height_m: args.height,
        moment: args.pose,
        focal_35mm: args.focal_35mm,
        view: args.view.unwrap_or_default(),
        up: args.up,
        lifted_m: args.lifted.unwrap_or(0.0),
        keys: args.key,
        apart_secs: args.apart,
    };
    let made = new(&wanted, &args.out, &mut |step| eprintln!("{step}"))?;
    let mut lines = made.facts;
    lines.extend(made.warnings.iter().map(|warning| format!("warning: {warning}")));
    let next = if wanted.keys.is_empty() {
        format!(
            "animate {} --clips {}{}",
            quoted(&args.out.display().to_string()),
            made.clip.map_or_else(|| "CLIP".to_owned(), |clip| quoted(&clip)),
            if made.is_video { " --moving" } else { "" }
        )
    } else {
        format!("inbetween {}", quoted(&args.out.display().to_string()))
    };
    lines.push(format!(
        "look at the outlines in {}; then `cargo xtask {next}`",
        args.out.join(DRAWING).display()
    ));
    print(&(lines.join("\n") + "\n"))
}

/// `CLIP@TIME`; a clip's name may contain an @.
fn moment(text: &str) -> Result<(String, f64), String> {
    let wanted = || format!("{text:?} is not CLIP@SECONDS");
    let (clip, time) = text.rsplit_once('@').ok_or_else(wanted)?;
    let time: f64 = time.trim_end_matches('s').parse().map_err(|_| wanted())?;
    if clip.is_empty() || !time.is_finite() || time < 0.0 {
        return Err(wanted());
    }
    Ok((clip.to_owned(), time))
}

fn key(text: &str) -> Result<Key, String> {
    let wanted = || format!("{text:?} is not PHOTO@CLIP@SECONDS");
    let (rest, time) = text.rsplit_once('@').ok_or_else(wanted)?;
    let (path, clip) = rest.rsplit_once('@').ok_or_else(wanted)?;
    Ok(Key {
        path: path.into(),
        moment: moment(&format!("{clip}@{time}"))?,
    })
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.trim_end_matches('s').parse().ok();
    let seconds = seconds.filter(|seconds: &f64| (0.01..=3600.0).contains(seconds));
    seconds.ok_or_else(|| format!("{text:?} is no number of seconds from .01 to 3600"))
}

fn millimetres(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.trim_end_matches("mm").trim().parse().ok();
    number
        .filter(|mm| (1.0..=2000.0).contains(mm))
        .with_context(|| format!("{text:?} is no focal length between 1 and 2000 mm"))
        .map_err(|error| error.to_string())
}

fn axis(text: &str) -> Result<DVec3, String> {
    let axis = match text.trim_start_matches(['+', '-']) {
        "x" => DVec3::X,
        "y" => DVec3::Y,
        "z" => DVec3::Z,
        _ => return Err(format!("{text:?} is none of +x, -x, +y, -y, +z and -z")),
    };
    Ok(if text.starts_with('-') { -axis } else { axis })
}
