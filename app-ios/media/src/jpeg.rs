//! Pictures of recordings by the phone's own JPEG encoder, which reads the camera's planes
//! directly.

use std::ptr::{self, NonNull};
use std::sync::mpsc::channel;

use app_core::camera_frame::{CameraImage, CodeRange, LumaCoefficients, PlanarImage};
use app_core::recording::PictureCodec;
use block2::RcBlock;
use objc2::rc::autoreleasepool;
use objc2_core_foundation::{CFNumber, CFRetained};
use objc2_core_media::{CMSampleBuffer, CMTime, CMTimeFlags, kCMVideoCodecType_JPEG};
use objc2_video_toolbox::{
    VTCompressionSession, VTEncodeInfoFlags, VTSessionSetProperty, kVTCompressionPropertyKey_Quality,
};

use crate::pixels;
use app_shell::guard::guarded;

/// Quality from 0 to 1, the same as that of [`PictureCodec::PHONE`].
const QUALITY: f64 = 0.95;
/// Time scale in a second: each picture has a time of its own.
const TIMESCALE: i32 = 30;

/// The encoder for a recording; pictures that it refuses are encoded as on any phone.
pub fn codec() -> PictureCodec {
    let mut encoder = Encoder::default();
    PictureCodec::Platform(Box::new(move |image| {
        autoreleasepool(|_| guarded("a thread", || encoder.encode(image)).flatten())
    }))
}

#[derive(Default)]
struct Encoder {
    /// The session for pictures of that size; `None` if the phone has none for it.
    session: Option<([usize; 2], Option<Session>)>,
    n_encoded: i64,
}

/// A session that lives on one thread at a time.
struct Session(CFRetained<VTCompressionSession>);

// SAFETY: a session may be used by any thread (Apple, Video Toolbox), and this one is used by the thread that writes the recording.
unsafe impl Send for Session {}

impl Encoder {
    fn encode(&mut self, image: &CameraImage) -> Option<Vec<u8>> {
        let CameraImage::Planes(planes) = image else {
            return None;
        };
        let size = as_jpeg_has_it(planes)?;
        if self.session.as_ref().is_none_or(|(of, _)| *of != size) {
            self.session = Some((size, session(size)));
        }
        let session = self.session.as_ref()?.1.as_ref()?;
        self.n_encoded += 1;
        let time = CMTime {
            value: self.n_encoded,
            timescale: TIMESCALE,
            flags: CMTimeFlags::Valid,
            epoch: 0,
        };
        let buffer = pixels::planes(size, [planes.luma(), planes.chroma()])?;
        let (hand_over, handed_over) = channel();
        let block = RcBlock::new(
            move |status: i32, _: VTEncodeInfoFlags, sample: *mut CMSampleBuffer| {
                let bytes = guarded("a thread", || {
                    // SAFETY: the encoder lends the sample for this call; it is null after a
                    // failure.
                    let sample = unsafe { sample.as_ref() }.filter(|_| status == 0);
                    sample.and_then(bytes_of)
                });
                // The receiver is the thread below.
                let _ = hand_over.send(bytes.flatten());
            },
        );
        // SAFETY: the session and the buffer live; the block is called at the latest by the end of the second call.
        let status = unsafe {
            let none = CMTime {
                value: 0,
                timescale: 0,
                flags: CMTimeFlags::empty(),
                epoch: 0,
            };
            let flags = ptr::null_mut();
            let handler = RcBlock::as_ptr(&block);
            match session
                .0
                .encode_frame_with_output_handler(&buffer, time, none, None, flags, handler)
            {
                0 => session.0.complete_frames(none),
                refused => refused,
            }
        };
        handed_over.try_recv().ok().flatten().filter(|_| status == 0)
    }
}

/// Columns and rows of planes whose codes are those of a JPEG file: BT.601, full range, chroma at
/// half the size.
fn as_jpeg_has_it(planes: &PlanarImage) -> Option<[usize; 2]> {
    let encoding = planes.encoding();
    let size = planes.size_px().map(|side| side as usize);
    let is_same = encoding.coefficients == LumaCoefficients::Bt601 && encoding.range == CodeRange::Full;
    (is_same && size.iter().all(|side| side % 2 == 0)).then_some(size)
}

fn session(size: [usize; 2]) -> Option<Session> {
    let [columns, rows] = [i32::try_from(size[0]).ok()?, i32::try_from(size[1]).ok()?];
    let codec = kCMVideoCodecType_JPEG;
    let mut made: *mut VTCompressionSession = ptr::null_mut();
    let out = NonNull::from(&mut made);
    // SAFETY: without a common callback each picture has its own; the created object is owned. The
    // property is a number.
    unsafe {
        let status = VTCompressionSession::create(
            None,
            columns,
            rows,
            codec,
            None,
            None,
            None,
            None,
            ptr::null_mut(),
            out,
        );
        let session = CFRetained::from_raw(NonNull::new(made).filter(|_| status == 0)?);
        let quality = CFNumber::new_f64(QUALITY);
        if VTSessionSetProperty(&session, kVTCompressionPropertyKey_Quality, Some(&quality)) != 0 {
            return None;
        }
        Some(Session(session))
    }
}

/// The file in a sample.
fn bytes_of(sample: &CMSampleBuffer) -> Option<Vec<u8>> {
    // SAFETY: the sample's own data, copied into a buffer of their length.
    unsafe {
        let data = sample.data_buffer()?;
        let mut bytes = vec![0_u8; data.data_length()];
        let to = NonNull::new(bytes.as_mut_ptr())?.cast();
        (data.copy_data_bytes(0, bytes.len(), to) == 0).then_some(bytes)
    }
}
