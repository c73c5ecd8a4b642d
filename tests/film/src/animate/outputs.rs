//! Lists and previews of a film beside its pictures: the exposure sheet, a contact sheet, and
//! previews that play.

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::{fs, io};

use anyhow::{Context, ensure};
use desk::output::write_whole;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, RgbImage};

use super::folder::{Film, FilmFrame};
use super::grammar::ClipFacts;
use super::run::picture;
use crate::small::{sheet, shrunk};

const XSHEET_FILE: &str = "xsheet.csv";
const CONTACT_FILE: &str = "contact.png";
const APNG_FILE: &str = "preview.apng";
const GIF_FILE: &str = "preview.gif";
const MP4_FILE: &str = "preview.mp4";
/// Longer side of a preview.
const PREVIEW_PX: u32 = 640;
/// Longer side of a picture of the contact sheet.
const CONTACT_PX: u32 = 240;
/// Largest number of pictures on the contact sheet, evenly spread over the film.
const N_CONTACTS: usize = 48;
const N_COLUMNS: u32 = 8;
const GAP_PX: u32 = 4;
/// Shortest display time of a GIF's picture, in hundredths of a second: players show shorter ones
/// for a tenth.
const LEAST_GIF_DELAY: f64 = 2.0;
/// Effort of the colour search for a GIF, from 1, the most, to 30.
const GIF_SPEED: i32 = 10;

/// Writes one line per frame with its clip, time and pose.
///
/// # Errors
/// When it cannot be written.
pub fn write_xsheet(folder: &Path, film: &Film, clips: &[ClipFacts]) -> anyhow::Result<()> {
    let quoted = |clip: usize| {
        let name = clips.get(clip).map_or("", |clip| clip.name.as_str());
        format!("\"{}\"", name.replace('"', "\"\""))
    };
    let mut text =
        "frame,file,time_secs,photograph,clip,clip_time_secs,is_held,blend_from_clip,blend_from_time_secs,blend_share\n"
            .to_owned();
    for (index, frame) in film.frames.iter().enumerate() {
        let FilmFrame {
            number,
            file,
            photograph,
            pose,
        } = frame;
        let time_secs = index as f64 / film.timing.fps;
        let clip = quoted(pose.moment.clip);
        let blend = pose.after.map_or_else(
            || ",,".to_owned(),
            |after| {
                let from = quoted(after.from.clip);
                format!("{from},{:.6},{:.4}", after.from.time_secs, after.share)
            },
        );
        writeln!(
            text,
            "{number},{file},{time_secs:.6},{photograph},{clip},{:.6},{},{blend}",
            pose.moment.time_secs,
            u8::from(pose.is_held)
        )?;
    }
    Ok(write_whole(&folder.join(XSHEET_FILE), text.as_bytes())?)
}

/// Writes a contact sheet and the playable previews, and returns a text about them. Only one
/// picture at a time is in memory.
///
/// # Errors
/// When a picture cannot be read, or a file cannot be written.
pub fn write_previews(folder: &Path, film: &Film) -> anyhow::Result<String> {
    write_contact(folder, film)?;
    write_apng(folder, film)?;
    write_gif(folder, film)?;
    let files = format!("{CONTACT_FILE}, {APNG_FILE}, {GIF_FILE}");
    let mut said = if write_mp4(folder, film)? {
        format!("{files} and {MP4_FILE} show them all\n")
    } else {
        format!("{files} show them all; {MP4_FILE} is made if ffmpeg is installed\n")
    };
    if film.timing.fps > 100.0 / LEAST_GIF_DELAY {
        said += &format!("{GIF_FILE} skips some: it can show at most 50 a second\n");
    }
    Ok(said)
}

fn write_contact(folder: &Path, film: &Film) -> anyhow::Result<()> {
    let n_frames = film.frames.len();
    let n_shown = n_frames.min(N_CONTACTS);
    let chosen = (0..n_shown).map(|k| &film.frames[k * n_frames / n_shown]);
    let small = chosen.map(|frame| Ok(shrunk(&picture(folder, frame)?, CONTACT_PX)));
    let sheet = sheet(&small.collect::<anyhow::Result<Vec<_>>>()?, N_COLUMNS, GAP_PX);
    write_rgb(&folder.join(CONTACT_FILE), &sheet)
}

/// Writes a picture as PNG.
///
/// # Errors
/// When the system refuses.
pub fn write_rgb(path: &Path, picture: &RgbImage) -> anyhow::Result<()> {
    let mut png = Vec::new();
    PngEncoder::new(&mut png).write_image(
        picture,
        picture.width(),
        picture.height(),
        ExtendedColorType::Rgb8,
    )?;
    Ok(write_whole(path, &png)?)
}

/// Writes a file piece by piece, under a temporary name until it is complete.
fn write_in_pieces(
    path: &Path,
    write: impl FnOnce(&mut io::BufWriter<fs::File>) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    let partial = path.with_file_name(name);
    let named = || path.display().to_string();
    let mut file = io::BufWriter::new(fs::File::create(&partial).with_context(named)?);
    write(&mut file).with_context(named)?;
    file.flush().with_context(named)?;
    fs::rename(&partial, path).with_context(named)
}

fn write_apng(folder: &Path, film: &Film) -> anyhow::Result<()> {
    write_in_pieces(&folder.join(APNG_FILE), |file| {
        let first = film.frames.first().context("a film without frames")?;
        let (width_px, height_px) = shrunk(&picture(folder, first)?, PREVIEW_PX).dimensions();
        let mut encoder = png::Encoder::new(file, width_px, height_px);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_animated(u32::try_from(film.frames.len())?, 0)?;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most 240 a second"
        )]
        let centi_fps = (100.0 * film.timing.fps).round() as u16;
        encoder.set_frame_delay(100, centi_fps)?;
        let mut writer = encoder.write_header()?;
        for frame in &film.frames {
            writer.write_image_data(&shrunk(&picture(folder, frame)?, PREVIEW_PX))?;
        }
        Ok(writer.finish()?)
    })
}

fn write_gif(folder: &Path, film: &Film) -> anyhow::Result<()> {
    write_in_pieces(&folder.join(GIF_FILE), |file| {
        let first = film.frames.first().context("a film without frames")?;
        let size = shrunk(&picture(folder, first)?, PREVIEW_PX);
        let [width_px, height_px] = [size.width(), size.height()].map(u16::try_from);
        let (width_px, height_px) = (width_px?, height_px?);
        let mut encoder = gif::Encoder::new(file, width_px, height_px, &[])?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        let mut until = 0.0;
        for (index, frame) in film.frames.iter().enumerate() {
            // Hundredths of a second, which add up to the film's length.
            let end = (100.0 * (index + 1) as f64 / film.timing.fps).round();
            if end - until < LEAST_GIF_DELAY {
                continue;
            }
            let small = shrunk(&picture(folder, frame)?, PREVIEW_PX);
            let mut encoded = gif::Frame::from_rgb_speed(width_px, height_px, &small, GIF_SPEED);
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "at most a hundred"
            )]
            {
                encoded.delay = (end - until) as u16;
            }
            until = end;
            encoder.write_frame(&encoded)?;
        }
        Ok(())
    })
}

/// Hands the pictures to ffmpeg; false if it is not installed. Without colour tags, players guess
/// by the picture's size.
fn write_mp4(folder: &Path, film: &Film) -> anyhow::Result<bool> {
    let partial = folder.join(format!("{MP4_FILE}.partial"));
    let process = Command::new("ffmpeg")
        .args(["-y", "-loglevel", "error", "-f", "image2pipe", "-framerate"])
        .arg(film.timing.fps.to_string())
        .args([
            "-i",
            "-",
            "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,\
             setparams=colorspace=bt709:color_primaries=bt709:color_trc=bt709:range=tv",
            "-pix_fmt",
            "yuv420p",
            "-f",
            "mp4",
        ])
        .arg(&partial)
        .stdin(Stdio::piped())
        .spawn();
    let mut process = match process {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
        process => process.context("ffmpeg")?,
    };
    if let Some(mut pipe) = process.stdin.take() {
        for frame in &film.frames {
            // If ffmpeg has ended, its status says why.
            if pipe.write_all(&fs::read(folder.join(&frame.file))?).is_err() {
                break;
            }
        }
    }
    let status = process.wait()?;
    ensure!(status.success(), "ffmpeg has ended with {status}");
    fs::rename(&partial, folder.join(MP4_FILE))?;
    Ok(true)
}
