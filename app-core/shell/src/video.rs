//! A video of the shown pictures, which go to a thread that encodes them into a file.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use app_core::app::{Filmed, Saved, VideoEnding};
use app_core::scene::Image;

pub use crate::encoder::{BeginVideo, HZ, VideoEncoder};
use crate::guard::guarded;
use crate::motion_jpeg;
use crate::save::outcome;

/// Number of pictures that wait for the thread; further ones are left out.
const N_WAITING: usize = 4;
/// Maximum duration of a picture, in seconds, whatever its time is.
const LONGEST_S: f64 = 2.0;

/// A way to encode.
#[derive(Clone, Copy, Debug)]
pub struct VideoFormat {
    /// Extension of the file's name.
    pub extension: &'static str,
    /// Begins a file; if it fails, the next format is tried.
    pub begin: BeginVideo,
}

/// Even numbers of columns and rows, as encoders of platforms require: an odd last one is left out.
/// `None` if none is left.
#[must_use]
pub fn even(size_px: [u32; 2]) -> Option<[usize; 2]> {
    let size = size_px.map(|side| (side & !1) as usize);
    (!size.contains(&0)).then_some(size)
}

/// The format that works everywhere; its files are larger than those of a platform's own.
pub const MOTION_JPEG: VideoFormat = VideoFormat {
    extension: "avi",
    begin: motion_jpeg::begin,
};

/// A video in progress. It ends when this is dropped.
#[derive(Debug)]
pub struct Video {
    pictures: SyncSender<(Image, f64)>,
    /// Time before which no further picture is needed.
    due_s: f64,
}

impl Video {
    /// Begins a video with the first of `formats` that works, whose extension is added to `stem`;
    /// the thread passes the result to `done`, with the file if there is one. It ends by itself,
    /// too, if the file can be no larger.
    ///
    /// # Errors
    /// If there is no thread for it.
    pub fn begin(
        stem: PathBuf,
        formats: &'static [VideoFormat],
        done: impl FnOnce(Filmed, Option<PathBuf>) + Send + 'static,
    ) -> io::Result<Self> {
        let (pictures, taken) = sync_channel(N_WAITING);
        thread::Builder::new().name("video".to_owned()).spawn(move || {
            let written = guarded("the video's thread", || write(&stem, formats, &taken));
            let (saved, ending, file) = match written {
                Some(Ok(Some((file, ending)))) => (Saved::Done, ending, Some(file)),
                Some(Ok(None)) => (Saved::Failed, VideoEnding::Asked, None),
                Some(Err(error)) => (outcome(Err(error)), VideoEnding::Broken, None),
                None => (Saved::Failed, VideoEnding::Broken, None),
            };
            done(Filmed { saved, ending }, file);
        })?;
        let due_s = f64::NEG_INFINITY;
        Ok(Self { pictures, due_s })
    }

    /// Whether a picture at `time_s` would be a new one for the video: otherwise it need not be
    /// read.
    #[must_use]
    pub fn is_due(&self, time_s: f64) -> bool {
        time_s >= self.due_s
    }

    /// Adds the picture that is shown from `time_s` on; returns false if it is left out, since too
    /// many wait or the video has ended.
    pub fn add(&mut self, picture: Image, time_s: f64) -> bool {
        let is_taken = self.pictures.try_send((picture, time_s)).is_ok();
        if is_taken {
            // Slightly early, so that an unsteady clock loses no picture.
            self.due_s = time_s + 0.8 / f64::from(HZ);
        }
        is_taken
    }
}

/// Seconds since the first picture, from times that may stand still, jump, or be invalid.
struct Timeline {
    last_s: f64,
    since_s: f64,
}

impl Timeline {
    /// The next picture's time; `None` if no time has passed.
    fn advance(&mut self, time_s: f64) -> Option<f64> {
        if !time_s.is_finite() {
            return None;
        }
        let step_s = (time_s - self.last_s).clamp(0.0, LONGEST_S);
        self.last_s = time_s;
        self.since_s += step_s;
        (step_s > 0.0).then_some(self.since_s)
    }
}

/// Encodes pictures until there are no more, or until the file can be no larger. A video without a
/// picture leaves no file; a failed one is removed.
fn write(
    stem: &Path,
    formats: &[VideoFormat],
    pictures: &Receiver<(Image, f64)>,
) -> io::Result<Option<(PathBuf, VideoEnding)>> {
    let Ok((first, begin_s)) = pictures.recv() else {
        return Ok(None);
    };
    if let Some(folder) = stem.parent() {
        fs::create_dir_all(folder)?;
    }
    let (file, encoder) = begin(stem, formats, [first.width_px, first.height_px])?;
    let encoded = encode(encoder, (&first, begin_s), pictures);
    if encoded.is_err() {
        // It has failed already: the first reason is the one to report.
        let _ = fs::remove_file(&file);
    }
    encoded.map(|ending| Some((file, ending)))
}

/// Begins with the first format that works; the error is the last one's.
fn begin(
    stem: &Path,
    formats: &[VideoFormat],
    size_px: [u32; 2],
) -> io::Result<(PathBuf, Box<dyn VideoEncoder>)> {
    let mut refused = io::ErrorKind::Unsupported.into();
    for format in formats {
        let file = stem.with_extension(format.extension);
        match (format.begin)(&file, size_px) {
            Ok(encoder) => return Ok((file, encoder)),
            Err(error) => {
                // A file that it may have begun.
                let _ = fs::remove_file(&file);
                refused = error;
            }
        }
    }
    Err(refused)
}

fn encode(
    mut encoder: Box<dyn VideoEncoder>,
    (first, begin_s): (&Image, f64),
    pictures: &Receiver<(Image, f64)>,
) -> io::Result<VideoEnding> {
    let size_px = [first.width_px, first.height_px];
    let mut timeline = Timeline {
        last_s: begin_s,
        since_s: 0.0,
    };
    let mut has_room = encoder.add(first, 0.0)?;
    let ending = loop {
        if !has_room {
            break VideoEnding::TooLarge;
        }
        let Ok((picture, time_s)) = pictures.recv() else {
            break VideoEnding::Asked;
        };
        if [picture.width_px, picture.height_px] != size_px {
            break VideoEnding::Broken;
        }
        if let Some(since_s) = timeline.advance(time_s) {
            has_room = encoder.add(&picture, since_s)?;
        }
    };
    encoder.finish(timeline.since_s + 1.0 / f64::from(HZ))?;
    Ok(ending)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    const DONE: Filmed = Filmed {
        saved: Saved::Done,
        ending: VideoEnding::Asked,
    };

    const fn broken(saved: Saved) -> Filmed {
        Filmed {
            saved,
            ending: VideoEnding::Broken,
        }
    }

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

    /// The grey of each picture, by the file's index, whose sizes must be consistent.
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

    /// Result for pictures with their times.
    fn video(name: &str, formats: &'static [VideoFormat], pictures: &[(u8, f64)]) -> (Filmed, Vec<Vec<u8>>) {
        let folder = std::env::temp_dir().join(format!("app-shell-{name}-{}", std::process::id()));
        let (done, saved) = channel();
        let mut video = Video::begin(folder.join("video"), formats, move |filmed, file| {
            drop(done.send((filmed, file)))
        })
        .expect("a thread");
        for (code, time_s) in pictures {
            while !video.add(picture(*code, [16, 8]), *time_s) {
                thread::yield_now();
            }
        }
        drop(video);
        let (filmed, file) = saved.recv().expect("an end");
        let entries = fs::read_dir(&folder).into_iter().flatten().flatten();
        let paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        assert_eq!(paths, Vec::from_iter(file), "what is there is what is told");
        let files = paths.iter().map(|path| fs::read(path).expect("a file")).collect();
        let _ = fs::remove_dir_all(&folder);
        (filmed, files)
    }

    #[test]
    fn pictures_stand_as_long_as_they_were_shown() {
        // The second is shown for three periods, the third is in the same one as the fourth.
        let shown = [(10, 5.0), (60, 5.033), (110, 5.13), (160, 5.135), (210, 5.166)];
        let (filmed, files) = video("video", &[MOTION_JPEG], &shown);
        assert_eq!(filmed, DONE);
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
        let (filmed, files) = video(
            "times",
            &[MOTION_JPEG],
            &[(10, 1.0), (20, 1e9), (30, f64::NAN), (40, -5.0)],
        );
        assert_eq!(filmed, DONE);
        assert_eq!(greys(&files[0]).len(), 61);
    }

    #[test]
    fn without_a_picture_there_is_no_file_and_without_a_folder_it_is_told() {
        let (filmed, files) = video("none", &[MOTION_JPEG], &[]);
        let failed = Filmed {
            saved: Saved::Failed,
            ..DONE
        };
        assert_eq!((filmed, files.len()), (failed, 0));
        let file = std::env::temp_dir().join(format!("app-shell-no-folder-{}", std::process::id()));
        fs::write(&file, b"").expect("a file");
        let (done, saved) = channel();
        let tell = move |filmed: Filmed, _| done.send(filmed.saved).expect("a receiver");
        let mut video = Video::begin(file.join("video"), &[MOTION_JPEG], tell).expect("a thread");
        assert!(video.is_due(0.0));
        assert!(video.add(picture(1, [16, 8]), 0.0));
        assert!(!video.is_due(0.016) && video.is_due(0.033));
        drop(video);
        assert_ne!(saved.recv().expect("an end"), Saved::Done);
        fs::remove_file(&file).expect("a file");
    }

    /// Accepts two pictures and fails with the third.
    struct Breaks(u32);

    impl VideoEncoder for Breaks {
        fn add(&mut self, _picture: &Image, _since_s: f64) -> io::Result<bool> {
            self.0 += 1;
            if self.0 > 2 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            Ok(true)
        }

        fn finish(self: Box<Self>, _until_s: f64) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_format_that_cannot_begin_leaves_it_to_the_next() {
        const REFUSES: VideoFormat = VideoFormat {
            extension: "mp4",
            begin: |path, _| {
                fs::write(path, b"begun")?;
                Err(io::ErrorKind::Unsupported.into())
            },
        };
        let (filmed, files) = video("refuses", &[REFUSES, MOTION_JPEG], &[(10, 0.0)]);
        assert_eq!((filmed, greys(&files[0]).len()), (DONE, 1));
        let (filmed, files) = video("none-can", &[REFUSES], &[(10, 0.0)]);
        assert_eq!((filmed, files.len()), (broken(Saved::Failed), 0));
    }

    #[test]
    fn a_video_that_breaks_off_is_told_and_leaves_no_file() {
        const BREAKS: VideoFormat = VideoFormat {
            extension: "mp4",
            begin: |path, _| {
                fs::write(path, b"begun")?;
                Ok(Box::new(Breaks(0)))
            },
        };
        let (filmed, files) = video("breaks", &[BREAKS], &[(10, 0.0), (10, 0.1), (10, 0.2)]);
        assert_eq!((filmed, files.len()), (broken(Saved::NoRoom), 0));
    }

    /// Has room for two pictures.
    struct Fills(u32);

    impl VideoEncoder for Fills {
        fn add(&mut self, _picture: &Image, _since_s: f64) -> io::Result<bool> {
            self.0 += 1;
            Ok(self.0 < 2)
        }

        fn finish(self: Box<Self>, _until_s: f64) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_video_that_can_be_no_larger_ends_by_itself_and_is_told() {
        const FILLS: VideoFormat = VideoFormat {
            extension: "mp4",
            begin: |path, _| {
                fs::write(path, b"begun")?;
                Ok(Box::new(Fills(0)))
            },
        };
        let (filmed, files) = video("fills", &[FILLS], &[(10, 0.0), (10, 0.1)]);
        let full = Filmed {
            ending: VideoEnding::TooLarge,
            ..DONE
        };
        assert_eq!((filmed, files.len()), (full, 1));
    }
}
