//! Videos by the phone's own encoder: H.264 in an MP4 file, which Photos accepts.

use std::io;
use std::path::Path;
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use app_core::scene::Image;
use app_shell::video::{self, VideoEncoder, VideoFormat};
use block2::RcBlock;
use objc2::rc::{Retained, autoreleasepool};
use objc2::runtime::AnyObject;
use objc2_av_foundation::{
    AVAssetWriter, AVAssetWriterInput, AVAssetWriterInputPixelBufferAdaptor, AVAssetWriterStatus,
    AVFileTypeMPEG4, AVMediaTypeVideo, AVVideoCodecKey, AVVideoCodecTypeH264,
    AVVideoColorPrimaries_ITU_R_709_2, AVVideoColorPrimariesKey, AVVideoColorPropertiesKey, AVVideoHeightKey,
    AVVideoTransferFunction_ITU_R_709_2, AVVideoTransferFunctionKey, AVVideoWidthKey,
    AVVideoYCbCrMatrix_ITU_R_709_2, AVVideoYCbCrMatrixKey,
};
use objc2_core_media::{CMTime, CMTimeFlags};
use objc2_foundation::{NSDictionary, NSError, NSNumber, NSString, NSURL};

use crate::order::to_bgra;
use crate::pixels;
use app_shell::guard::guarded;

/// The format of the encoder that is tried first.
pub const H264: VideoFormat = VideoFormat {
    extension: "mp4",
    begin,
};
/// Time scale in a second: that of Apple's own videos, a multiple of all usual rates.
const TIMESCALE: i32 = 600;
/// Time after which a busy encoder is given up.
const PATIENCE: Duration = Duration::from_secs(5);
const LOOK: Duration = Duration::from_millis(2);

type Settings = NSDictionary<NSString, AnyObject>;

struct Encoder {
    writer: Retained<AVAssetWriter>,
    input: Retained<AVAssetWriterInput>,
    adaptor: Retained<AVAssetWriterInputPixelBufferAdaptor>,
    /// Columns and rows, both even.
    size_px: [usize; 2],
}

fn begin(path: &Path, size_px: [u32; 2]) -> io::Result<Box<dyn VideoEncoder>> {
    let size_px = video::even(size_px).ok_or(io::ErrorKind::Unsupported)?;
    let path = path.to_str().ok_or(io::ErrorKind::InvalidInput)?;
    let url = NSURL::fileURLWithPath(&NSString::from_str(path));
    // SAFETY: constants of AVFoundation, with the documented types of the keys; the settings are
    // checked before they are applied, and the input before it is added.
    unsafe {
        let (Some(video), Some(mp4)) = (AVMediaTypeVideo, AVFileTypeMPEG4) else {
            return Err(io::ErrorKind::Unsupported.into());
        };
        let settings = settings(size_px).ok_or(io::ErrorKind::Unsupported)?;
        let writer =
            AVAssetWriter::assetWriterWithURL_fileType_error(&url, mp4).map_err(|error| io_error(&error))?;
        if !writer.canApplyOutputSettings_forMediaType(Some(&settings), video) {
            return Err(io::ErrorKind::Unsupported.into());
        }
        let input = AVAssetWriterInput::assetWriterInputWithMediaType_outputSettings(video, Some(&settings));
        input.setExpectsMediaDataInRealTime(true);
        let adaptor = AVAssetWriterInputPixelBufferAdaptor::assetWriterInputPixelBufferAdaptorWithAssetWriterInput_sourcePixelBufferAttributes(&input, None);
        if !writer.canAddInput(&input) {
            return Err(io::ErrorKind::Unsupported.into());
        }
        writer.addInput(&input);
        if !writer.startWriting() {
            return Err(failure(&writer));
        }
        writer.startSessionAtSourceTime(at(0.0));
        Ok(Box::new(Encoder {
            writer,
            input,
            adaptor,
            size_px,
        }))
    }
}

/// Codec, size, and the colours of a usual screen, which are those of video except for the foot of
/// the curve.
unsafe fn settings([columns, rows]: [usize; 2]) -> Option<Retained<Settings>> {
    // SAFETY: constants of AVFoundation.
    let (keys, values, colour) = unsafe {
        let colour = NSDictionary::<NSString, AnyObject>::from_slices(
            &[
                AVVideoColorPrimariesKey?,
                AVVideoTransferFunctionKey?,
                AVVideoYCbCrMatrixKey?,
            ],
            &[
                AVVideoColorPrimaries_ITU_R_709_2?.as_ref(),
                AVVideoTransferFunction_ITU_R_709_2?.as_ref(),
                AVVideoYCbCrMatrix_ITU_R_709_2?.as_ref(),
            ],
        );
        let keys = [
            AVVideoCodecKey?,
            AVVideoWidthKey?,
            AVVideoHeightKey?,
            AVVideoColorPropertiesKey?,
        ];
        (keys, AVVideoCodecTypeH264?, colour)
    };
    let (width, height) = (NSNumber::new_usize(columns), NSNumber::new_usize(rows));
    Some(NSDictionary::from_slices(
        &keys,
        &[values.as_ref(), width.as_ref(), height.as_ref(), colour.as_ref()],
    ))
}

impl Encoder {
    /// Waits until the encoder accepts another picture.
    fn wait(&self) -> io::Result<()> {
        let n_looks = PATIENCE.as_millis() / LOOK.as_millis();
        for _ in 0..n_looks {
            // SAFETY: properties that any thread may read.
            let (is_ready, status) = unsafe { (self.input.isReadyForMoreMediaData(), self.writer.status()) };
            if status != AVAssetWriterStatus::Writing {
                return Err(failure(&self.writer));
            }
            if is_ready {
                return Ok(());
            }
            thread::sleep(LOOK);
        }
        Err(io::ErrorKind::TimedOut.into())
    }
}

impl VideoEncoder for Encoder {
    fn add(&mut self, picture: &Image, since_s: f64) -> io::Result<bool> {
        autoreleasepool(|_| {
            self.wait()?;
            let row_bytes = 4 * picture.width_px as usize;
            let buffer = pixels::bgra(self.size_px, |row, bgra| {
                to_bgra(&picture.rgba8[row * row_bytes..], bgra);
            });
            let buffer = buffer.ok_or(io::ErrorKind::OutOfMemory)?;
            // SAFETY: a buffer of the input's size, at a time after the previous one.
            let is_taken = unsafe {
                self.adaptor
                    .appendPixelBuffer_withPresentationTime(&buffer, at(since_s))
            };
            if is_taken {
                Ok(true)
            } else {
                Err(failure(&self.writer))
            }
        })
    }

    fn finish(self: Box<Self>, until_s: f64) -> io::Result<()> {
        autoreleasepool(|_| {
            let (end, ended) = channel();
            let block = RcBlock::new(move || {
                // The waiting thread may have given up.
                let _ = guarded("a thread", || end.send(()));
            });
            // SAFETY: a session was started, and nothing is added any more; the block may be called by any thread.
            unsafe {
                self.input.markAsFinished();
                self.writer.endSessionAtSourceTime(at(until_s));
                self.writer.finishWritingWithCompletionHandler(&block);
            }
            ended.recv_timeout(PATIENCE).map_err(io::Error::other)?;
            // SAFETY: a property that any thread may read.
            match unsafe { self.writer.status() } {
                AVAssetWriterStatus::Completed => Ok(()),
                _ => Err(failure(&self.writer)),
            }
        })
    }
}

fn at(since_s: f64) -> CMTime {
    #[allow(clippy::cast_possible_truncation, reason = "some hours of six hundredths")]
    let value = (since_s * f64::from(TIMESCALE)).round() as i64;
    CMTime {
        value,
        timescale: TIMESCALE,
        flags: CMTimeFlags::Valid,
        epoch: 0,
    }
}

/// The reason why the writer has stopped.
fn failure(writer: &AVAssetWriter) -> io::Error {
    // SAFETY: a property that any thread may read.
    let error = unsafe { writer.error() };
    error.map_or_else(|| io::ErrorKind::Other.into(), |error| io_error(&error))
}

fn io_error(error: &NSError) -> io::Error {
    /// `AVErrorDiskFull`.
    const DISK_FULL: isize = -11_823;
    if error.code() == DISK_FULL {
        return io::ErrorKind::StorageFull.into();
    }
    io::Error::other(error.localizedDescription().to_string())
}
