//! Videos by the phone's own encoder: H.264 in an MP4 file, which every player supports.

use std::fs::File;
use std::io;
use std::os::fd::AsRawFd;
use std::path::Path;
use std::ptr::NonNull;
use std::time::Duration;

use app_core::scene::Image;
use app_shell::video::{HZ, VideoEncoder, VideoFormat, even};
use ndk::media::media_codec::{
    DequeuedInputBufferResult, DequeuedOutputBufferInfoResult, MediaCodec, MediaCodecDirection,
};
use ndk::media::media_format::MediaFormat;
use ndk::media_error::MediaError;
use ndk_sys::{
    AMEDIACODEC_BUFFER_FLAG_CODEC_CONFIG, AMEDIACODEC_BUFFER_FLAG_END_OF_STREAM, AMediaCodecBufferInfo,
    AMediaMuxer, AMediaMuxer_addTrack, AMediaMuxer_delete, AMediaMuxer_new, AMediaMuxer_start,
    AMediaMuxer_stop, AMediaMuxer_writeSampleData, OutputFormat, media_status_t,
};

use crate::yuv::Layout;

/// The format of the encoder that is tried first.
pub const H264: VideoFormat = VideoFormat {
    extension: "mp4",
    begin,
};

const AVC: &str = "video/avc";
/// `COLOR_FormatYUV420SemiPlanar` and `COLOR_FormatYUV420Planar`: each phone supports at least one
/// of them.
const COLOURS: [i32; 2] = [21, 19];
/// `COLOR_STANDARD_BT709`, `COLOR_RANGE_LIMITED`, `COLOR_TRANSFER_SDR_VIDEO`.
const BT709: i32 = 1;
const LIMITED: i32 = 2;
const SDR: i32 = 3;
/// Bits per second for a pixel.
const BITS_PER_PIXEL: i32 = 4;
/// Seconds between key frames.
const KEY_INTERVAL_S: i32 = 1;
/// Time after which a busy encoder is given up.
const PATIENCE: Duration = Duration::from_secs(5);

fn begin(path: &Path, size_px: [u32; 2]) -> io::Result<Box<dyn VideoEncoder>> {
    let size_px = even(size_px).ok_or(io::ErrorKind::Unsupported)?;
    let (codec, layout) = COLOURS
        .iter()
        .find_map(|colour| started(*colour, size_px))
        .ok_or(io::ErrorKind::Unsupported)?;
    let muxer = Muxer::begin(File::create(path)?)?;
    Ok(Box::new(Encoder { codec, layout, muxer }))
}

/// A running encoder for pictures in a colour format, with its layout for them; `None` if the phone
/// has none.
fn started(colour: i32, size_px: [usize; 2]) -> Option<(MediaCodec, Layout)> {
    let [columns, rows] = [i32::try_from(size_px[0]).ok()?, i32::try_from(size_px[1]).ok()?];
    let mut format = MediaFormat::new();
    format.set_str("mime", AVC);
    format.set_i32("width", columns);
    format.set_i32("height", rows);
    format.set_i32("color-format", colour);
    format.set_i32("color-standard", BT709);
    format.set_i32("color-range", LIMITED);
    format.set_i32("color-transfer", SDR);
    format.set_i32("frame-rate", i32::try_from(HZ).ok()?);
    format.set_i32("i-frame-interval", KEY_INTERVAL_S);
    format.set_i32(
        "bitrate",
        columns.saturating_mul(rows).saturating_mul(BITS_PER_PIXEL),
    );
    let codec = MediaCodec::from_encoder_type(AVC)?;
    codec
        .configure(&format, None, MediaCodecDirection::Encoder)
        .ok()?;
    let wanted = codec.input_format();
    let at_least = |key, least: usize| {
        let told = wanted.i32(key).and_then(|told| usize::try_from(told).ok());
        told.unwrap_or(0).max(least)
    };
    let layout = Layout {
        size_px,
        stride: at_least("stride", size_px[0]),
        slice_height: at_least("slice-height", size_px[1]),
        is_interleaved: colour == COLOURS[0],
    };
    codec.start().ok()?;
    Some((codec, layout))
}

struct Encoder {
    codec: MediaCodec,
    layout: Layout,
    muxer: Muxer,
}

impl Encoder {
    /// Submits a picture, or the end.
    fn put(&mut self, picture: Option<&Image>, since_s: f64) -> io::Result<()> {
        let waiting = self.codec.dequeue_input_buffer(PATIENCE).map_err(io_error)?;
        let DequeuedInputBufferResult::Buffer(mut buffer) = waiting else {
            return Err(io::ErrorKind::TimedOut.into());
        };
        let (n_bytes, flags) = match picture {
            Some(picture) => {
                let bytes = buffer.buffer_mut();
                bytes.fill(std::mem::MaybeUninit::new(0));
                // SAFETY: all bytes were just written.
                let bytes = unsafe { std::slice::from_raw_parts_mut(bytes.as_mut_ptr().cast(), bytes.len()) };
                if !self.layout.fill(&picture.rgba8, picture.width_px as usize, bytes) {
                    return Err(io::ErrorKind::Unsupported.into());
                }
                (self.layout.n_bytes(), 0)
            }
            None => (0, AMEDIACODEC_BUFFER_FLAG_END_OF_STREAM),
        };
        #[allow(
            clippy::cast_possible_truncation,
            reason = "some hours of microseconds, which do not run backwards"
        )]
        let time_us = (1e6 * since_s).round() as u64;
        self.codec
            .queue_input_buffer(buffer, 0, n_bytes, time_us, flags)
            .map_err(io_error)
    }

    /// Writes the encoder's output; returns true at its end.
    fn take(&mut self, wait: Duration) -> io::Result<bool> {
        loop {
            match self.codec.dequeue_output_buffer(wait).map_err(io_error)? {
                DequeuedOutputBufferInfoResult::TryAgainLater => return Ok(false),
                DequeuedOutputBufferInfoResult::OutputBuffersChanged => {}
                DequeuedOutputBufferInfoResult::OutputFormatChanged => {
                    self.muxer.start(&self.codec.output_format())?;
                }
                DequeuedOutputBufferInfoResult::Buffer(buffer) => {
                    let info = AMediaCodecBufferInfo {
                        offset: buffer.info().offset(),
                        size: buffer.info().size(),
                        presentationTimeUs: buffer.info().presentation_time_us(),
                        flags: buffer.info().flags(),
                    };
                    let has = |flag: u32| info.flags & flag != 0;
                    // The head of the stream is in the track's format already.
                    if info.size > 0 && !has(AMEDIACODEC_BUFFER_FLAG_CODEC_CONFIG) {
                        self.muxer.write(buffer.buffer(), &info)?;
                    }
                    self.codec
                        .release_output_buffer(buffer, false)
                        .map_err(io_error)?;
                    if has(AMEDIACODEC_BUFFER_FLAG_END_OF_STREAM) {
                        return Ok(true);
                    }
                }
            }
        }
    }
}

impl VideoEncoder for Encoder {
    fn add(&mut self, picture: &Image, since_s: f64) -> io::Result<bool> {
        self.put(Some(picture), since_s)?;
        self.take(Duration::ZERO)?;
        Ok(true)
    }

    fn finish(mut self: Box<Self>, until_s: f64) -> io::Result<()> {
        self.put(None, until_s)?;
        if !self.take(PATIENCE)? {
            return Err(io::ErrorKind::TimedOut.into());
        }
        self.codec.stop().map_err(io_error)?;
        self.muxer.finish()
    }
}

/// An MP4 file with one track, which begins when the encoder reports its format.
struct Muxer {
    muxer: NonNull<AMediaMuxer>,
    track: Option<usize>,
    /// Open for as long as the muxer writes.
    _file: File,
}

impl Muxer {
    fn begin(file: File) -> io::Result<Self> {
        // SAFETY: the file is open, and stays open while the muxer exists.
        let muxer =
            unsafe { AMediaMuxer_new(file.as_raw_fd(), OutputFormat::AMEDIAMUXER_OUTPUT_FORMAT_MPEG_4) };
        let muxer = NonNull::new(muxer).ok_or(io::ErrorKind::Other)?;
        Ok(Self {
            muxer,
            track: None,
            _file: file,
        })
    }

    fn start(&mut self, format: &MediaFormat) -> io::Result<()> {
        // SAFETY: both live; a started muxer refuses another track.
        let track = unsafe { AMediaMuxer_addTrack(self.muxer.as_ptr(), format.as_ptr()) };
        self.track = Some(usize::try_from(track).map_err(io::Error::other)?);
        // SAFETY: it has its only track.
        checked(unsafe { AMediaMuxer_start(self.muxer.as_ptr()) })
    }

    fn write(&mut self, data: &[u8], info: &AMediaCodecBufferInfo) -> io::Result<()> {
        let track = self.track.ok_or(io::ErrorKind::InvalidData)?;
        let end = i64::from(info.offset) + i64::from(info.size);
        if info.offset < 0 || i64::try_from(data.len()).map_or(true, |length| end > length) {
            return Err(io::ErrorKind::InvalidData.into());
        }
        // SAFETY: it is started, with that track, and the given range lies within the data.
        checked(unsafe { AMediaMuxer_writeSampleData(self.muxer.as_ptr(), track, data.as_ptr(), info) })
    }

    fn finish(self) -> io::Result<()> {
        // SAFETY: it lives; a muxer that was not started refuses.
        checked(unsafe { AMediaMuxer_stop(self.muxer.as_ptr()) })
    }
}

impl Drop for Muxer {
    fn drop(&mut self) {
        // SAFETY: it is not used afterwards.
        unsafe { AMediaMuxer_delete(self.muxer.as_ptr()) };
    }
}

fn checked(status: media_status_t) -> io::Result<()> {
    if status == media_status_t::AMEDIA_OK {
        return Ok(());
    }
    Err(io::Error::other(format!("{status:?}")))
}

fn io_error(error: MediaError) -> io::Error {
    io::Error::other(error)
}
