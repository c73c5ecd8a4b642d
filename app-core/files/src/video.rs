//! A video of what is shown: pictures go to a thread, which writes them into a file at a constant rate.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

use app_core::app::Saved;
use app_core::scene::Image;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

use crate::avi::Avi;
use crate::save::outcome;

/// Pictures a second.
const HZ: u32 = 30;
/// Pictures that wait for the thread; what comes while as many do is left out.
const N_WAITING: usize = 4;
/// Of the pictures, of 100: beyond it files grow faster than what is seen of them.
const QUALITY: u8 = 92;
/// A picture stands no longer than this, in seconds, whatever its time says.
const LONGEST_S: f64 = 2.0;

/// A video that is being made. It ends when this is dropped.
#[derive(Debug)]
pub struct Video {
    pictures: SyncSender<(Image, f64)>,
    /// No further picture is needed before.
    due_s: f64,
}

impl Video {
    /// Begins a video in `folder`; `done` is told what became of it, by the thread.
    ///
    /// # Errors
    /// When there is no thread for it.
    pub fn begin(folder: &Path, done: impl FnOnce(Saved) + Send + 'static) -> io::Result<Self> {
        let (pictures, taken) = sync_channel(N_WAITING);
        // A clock that is set before 1970 makes every video the same file.
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let path = folder.join(format!("video_{}.avi", since.as_millis()));
        thread::Builder::new().name("video".to_owned()).spawn(move || {
            let written = catch_unwind(AssertUnwindSafe(|| write(&path, &taken)));
            done(written.map_or(Saved::Failed, outcome));
        })?;
        let due_s = f64::NEG_INFINITY;
        Ok(Self { pictures, due_s })
    }

    /// Whether a picture at `time_s` would be another one of the video: a picture that is not does not have to be read.
    #[must_use]
    pub fn is_due(&self, time_s: f64) -> bool {
        time_s >= self.due_s
    }

    /// Adds the picture that is shown from `time_s` on; false where it is left out, since too many wait or the video has ended.
    pub fn add(&mut self, picture: Image, time_s: f64) -> bool {
        let is_taken = self.pictures.try_send((picture, time_s)).is_ok();
        if is_taken {
            // A little early, so that a clock that trembles loses no picture.
            self.due_s = time_s + 0.8 / f64::from(HZ);
        }
        is_taken
    }
}

/// Writes what comes until no more does. A video without a picture is no file.
fn write(path: &Path, pictures: &Receiver<(Image, f64)>) -> io::Result<()> {
    let Ok((first, begin_s)) = pictures.recv() else {
        return Ok(());
    };
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let size_px = [first.width_px, first.height_px];
    let mut avi = Avi::begin(BufWriter::new(File::create(path)?), size_px, HZ)?;
    let mut shown = jpeg(&first)?;
    for (picture, time_s) in pictures {
        if [picture.width_px, picture.height_px] != size_px {
            break;
        }
        let n_due = n_pictures_until(time_s - begin_s).min(avi.n_pictures() + n_pictures_until(LONGEST_S));
        // Of two in one period the later is shown.
        while avi.n_pictures() < n_due && avi.has_room(&shown) {
            avi.add(&shown)?;
        }
        shown = jpeg(&picture)?;
        if !avi.has_room(&shown) {
            break;
        }
    }
    avi.add(&shown)?;
    avi.finish()?;
    Ok(())
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the conversion saturates, and what is no number becomes 0"
)]
fn n_pictures_until(since_s: f64) -> usize {
    (since_s * f64::from(HZ)).round() as usize
}

fn jpeg(picture: &Image) -> io::Result<Vec<u8>> {
    let rgb: Vec<u8> = picture
        .rgba8
        .chunks_exact(4)
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, QUALITY)
        .encode(&rgb, picture.width_px, picture.height_px, ExtendedColorType::Rgb8)
        .map_err(io::Error::other)?;
    Ok(jpeg)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    fn picture(code: u8, size_px: [u32; 2]) -> Image {
        Image {
            width_px: size_px[0],
            height_px: size_px[1],
            rgba8: [code, code, code, 255].repeat((size_px[0] * size_px[1]) as usize),
        }
    }

    fn word(bytes: &[u8], at: usize) -> usize {
        let four = bytes[at..at + 4].try_into().expect("four bytes");
        u32::from_le_bytes(four) as usize
    }

    /// The grey of each picture, by the file's index, whose sizes must agree with each other.
    fn greys(avi: &[u8]) -> Vec<u8> {
        assert_eq!((&avi[..4], &avi[8..16]), (&b"RIFF"[..], &b"AVI LIST"[..]));
        assert_eq!(word(avi, 4) + 8, avi.len());
        let movie = 20 + word(avi, 16);
        assert_eq!(
            (&avi[movie..movie + 4], &avi[movie + 8..movie + 12]),
            (&b"LIST"[..], &b"movi"[..])
        );
        let index = movie + 8 + word(avi, movie + 4);
        assert_eq!(&avi[index..index + 4], b"idx1");
        assert_eq!(index + 8 + word(avi, index + 4), avi.len());
        let n_pictures = word(avi, index + 4) / 16;
        assert_eq!(word(avi, 48), n_pictures, "of the main head");
        let pictures = (0..n_pictures).map(|n| {
            let entry = index + 8 + 16 * n;
            let (at, n_bytes) = (movie + 8 + word(avi, entry + 8), word(avi, entry + 12));
            assert_eq!((&avi[at..at + 4], word(avi, at + 4)), (&b"00dc"[..], n_bytes));
            let decoded = image::load_from_memory(&avi[at + 8..at + 8 + n_bytes]).expect("a picture");
            decoded.to_luma8().as_raw()[0]
        });
        pictures.collect()
    }

    /// What becomes of pictures with their times.
    fn video(name: &str, pictures: &[(u8, f64)]) -> (Saved, Vec<Vec<u8>>) {
        let folder = std::env::temp_dir().join(format!("app-files-{name}-{}", std::process::id()));
        let (done, saved) = channel();
        let mut video =
            Video::begin(&folder, move |saved| done.send(saved).expect("a receiver")).expect("a thread");
        for (code, time_s) in pictures {
            while !video.add(picture(*code, [16, 8]), *time_s) {
                thread::yield_now();
            }
        }
        drop(video);
        let saved = saved.recv().expect("an end");
        let entries = fs::read_dir(&folder).into_iter().flatten().flatten();
        let files = entries
            .map(|entry| fs::read(entry.path()).expect("a file"))
            .collect();
        let _ = fs::remove_dir_all(&folder);
        (saved, files)
    }

    #[test]
    fn pictures_stand_as_long_as_they_were_shown() {
        // The second stands for three periods, the third comes in the same one as the fourth.
        let shown = [(10, 5.0), (60, 5.033), (110, 5.13), (160, 5.135), (210, 5.166)];
        let (saved, files) = video("video", &shown);
        assert_eq!(saved, Saved::Done);
        assert_eq!(files.len(), 1);
        let expected = [10, 60, 60, 60, 160, 210];
        let greys = greys(&files[0]);
        let are_close = greys.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 2);
        assert!(
            are_close && greys.len() == expected.len(),
            "{greys:?}, not {expected:?}"
        );
    }

    #[test]
    fn times_that_make_no_sense_do_not_fill_the_disc() {
        let (saved, files) = video("times", &[(10, 1.0), (20, 1e9), (30, f64::NAN), (40, -5.0)]);
        assert_eq!(saved, Saved::Done);
        assert_eq!(greys(&files[0]).len(), 61);
    }

    #[test]
    fn without_a_picture_there_is_no_file_and_without_a_folder_it_is_told() {
        let (saved, files) = video("none", &[]);
        assert_eq!((saved, files.len()), (Saved::Done, 0));
        let file = std::env::temp_dir().join(format!("app-files-no-folder-{}", std::process::id()));
        fs::write(&file, b"").expect("a file");
        let (done, saved) = channel();
        let mut video =
            Video::begin(&file, move |saved| done.send(saved).expect("a receiver")).expect("a thread");
        assert!(video.is_due(0.0));
        assert!(video.add(picture(1, [16, 8]), 0.0));
        assert!(!video.is_due(0.016) && video.is_due(0.033));
        drop(video);
        assert_ne!(saved.recv().expect("an end"), Saved::Done);
        fs::remove_file(&file).expect("a file");
    }
}
