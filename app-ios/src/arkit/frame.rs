//! An ARKit frame in plain numbers, and what becomes of it.

use app_core::camera_frame::{
    CameraImage, CodeRange, LumaCoefficients, PlanarImage, PlaneError, Planes, YcbcrEncoding,
};
use app_core::scene::LightEstimate;
use glam::{DMat3, DMat4, DVec2};

use crate::convert;

/// `kCVPixelFormatType_420YpCbCr8BiPlanarFullRange`.
const FULL_RANGE: u32 = u32::from_be_bytes(*b"420f");
/// `kCVPixelFormatType_420YpCbCr8BiPlanarVideoRange`.
const VIDEO_RANGE: u32 = u32::from_be_bytes(*b"420v");

/// `ARTrackingState`.
const NORMAL: isize = 2;
const LIMITED: isize = 1;

/// Nanoseconds in a second.
const NS: f64 = 1e9;

/// A plane of a pixel buffer, while it is locked.
#[derive(Clone, Copy, Debug)]
pub struct RawPlane<'a> {
    /// All of its rows.
    pub bytes: &'a [u8],
    /// Bytes from row to row.
    pub row_stride: usize,
}

/// A plane that ARKit has found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawSurface {
    /// Bytes of its identifier.
    pub id: [u8; 16],
    /// `ARPlaneAnchorAlignment`: 0 lies, 1 stands.
    pub alignment: isize,
    /// Columns of `transform`.
    pub transform: [[f32; 4]; 4],
    /// Columns of three numbers and a fourth that holds nothing, in the plane's space.
    pub boundary: Vec<[f32; 4]>,
}

/// What one frame of ARKit holds, as it stands there: nothing is turned, scaled or judged.
#[derive(Clone, Debug)]
pub struct RawFrame<'a> {
    /// Seconds since the phone started.
    pub timestamp: f64,
    /// `OSType` of the pixel buffer.
    pub pixel_format: u32,
    /// Width and height of the luma.
    pub size_px: [usize; 2],
    /// Luma, then both chroma components by turns.
    pub planes: Vec<RawPlane<'a>>,
    /// Columns of `ARCamera.intrinsics`.
    pub intrinsics: [[f32; 4]; 3],
    /// Columns of `ARCamera.transform`.
    pub transform: [[f32; 4]; 4],
    /// `ARTrackingState` and `ARTrackingStateReason`.
    pub tracking: [isize; 2],
    /// Seconds, and stops that the picture was meant to be brightened by.
    pub exposure: [f64; 2],
    /// Lumen and kelvin, where light is estimated.
    pub light: Option<[f64; 2]>,
    /// Planes found so far.
    pub surfaces: Vec<RawSurface>,
}

/// A camera frame with what is known of it.
#[derive(Debug)]
pub struct TrackedFrame {
    /// On the phone's own clock.
    pub time_ns: i64,
    /// Copied, so that ARKit has its buffer back.
    pub image: CameraImage,
    /// Of this very frame.
    pub sensor_px_from_camera_rdf: DMat3,
    /// None unless ARKit trusts it.
    pub world_from_camera: Option<DMat4>,
    /// What to tell while it does not.
    pub lost: Option<&'static str>,
    /// Time in which the picture was taken, seconds; none where ARKit does not tell.
    pub exposure_s: Option<f64>,
    /// As far as the phone estimates it.
    pub light: Option<LightEstimate>,
    /// Those whose numbers make sense.
    pub planes: Vec<FoundPlane>,
}

/// A plane that was found, which grows and moves as more is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundPlane {
    /// The same as long as ARKit keeps it.
    pub id: u128,
    /// As a wall, rather than a table.
    pub is_upright: bool,
    /// +Y is its normal.
    pub world_from_plane: DMat4,
    /// In x and z of the plane, metres.
    pub outline_m: Vec<DVec2>,
}

/// Why a frame could not be taken.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum FrameError {
    /// No picture of luma and chroma.
    #[error("the camera's picture has format {0:#010x}, neither 420f nor 420v")]
    Format(u32),
    /// Fewer planes, or more.
    #[error("the camera's picture has {0} planes, not 2")]
    Count(usize),
    /// Planes that do not hold their picture.
    #[error(transparent)]
    Planes(#[from] PlaneError),
    /// Numbers that no camera has.
    #[error("the camera's focal length is {0} and {1} px")]
    Camera(f64, f64),
    /// A time that is none.
    #[error("the frame's time is {0} s")]
    Time(f64),
}

impl TrackedFrame {
    /// What `raw` becomes.
    ///
    /// # Errors
    /// Where its picture or its camera make no sense.
    pub fn new(raw: &RawFrame<'_>) -> Result<Self, FrameError> {
        let range = match raw.pixel_format {
            FULL_RANGE => CodeRange::Full,
            VIDEO_RANGE => CodeRange::Video,
            other => return Err(FrameError::Format(other)),
        };
        let [luma, chroma] = raw.planes[..] else {
            return Err(FrameError::Count(raw.planes.len()));
        };
        let planes = Planes::nv12(
            // A side that has no room is too long for the planes, too.
            raw.size_px.map(|side| u32::try_from(side).unwrap_or(u32::MAX)),
            (luma.bytes, luma.row_stride),
            (chroma.bytes, chroma.row_stride),
            YcbcrEncoding {
                coefficients: LumaCoefficients::Bt601,
                range,
            },
        );
        let sensor_px_from_camera_rdf = convert::sensor_px_from_camera_rdf(raw.intrinsics);
        let [fx, fy] = [
            sensor_px_from_camera_rdf.x_axis.x,
            sensor_px_from_camera_rdf.y_axis.y,
        ];
        if !(fx > 0.0 && fy > 0.0 && sensor_px_from_camera_rdf.is_finite()) {
            return Err(FrameError::Camera(fx, fy));
        }
        let is_tracking = raw.tracking[0] == NORMAL;
        let pose = is_tracking.then(|| convert::world_from_camera(raw.transform));
        Ok(Self {
            time_ns: time_ns(raw.timestamp)?,
            image: PlanarImage::new(&planes)?.into(),
            sensor_px_from_camera_rdf,
            world_from_camera: pose.flatten(),
            lost: (!is_tracking).then(|| lost(raw.tracking)),
            exposure_s: Some(raw.exposure[0]).filter(|seconds| seconds.is_finite() && *seconds > 0.0),
            light: raw.light.map(|[lumen, kelvin]| LightEstimate {
                ambient_intensity: Some(lumen).filter(|lumen| lumen.is_finite()),
                color_temperature_k: Some(kelvin).filter(|kelvin| *kelvin > 0.0),
                ..LightEstimate::default()
            }),
            planes: raw.surfaces.iter().filter_map(found_plane).collect(),
        })
    }
}

fn time_ns(seconds: f64) -> Result<i64, FrameError> {
    if !(0.0..1e9).contains(&seconds) {
        return Err(FrameError::Time(seconds));
    }
    #[allow(clippy::cast_possible_truncation, reason = "below 1e18, as was just seen")]
    Ok((seconds * NS).round() as i64)
}

fn found_plane(raw: &RawSurface) -> Option<FoundPlane> {
    let is_finite = raw
        .boundary
        .iter()
        .all(|corner| corner[0].is_finite() && corner[2].is_finite());
    let outline_m = raw
        .boundary
        .iter()
        .map(|corner| DVec2::new(corner[0].into(), corner[2].into()));
    Some(FoundPlane {
        id: u128::from_be_bytes(raw.id),
        is_upright: match raw.alignment {
            0 => false,
            1 => true,
            _ => return None,
        },
        world_from_plane: convert::world_from_camera(raw.transform).filter(|_| is_finite)?,
        outline_m: outline_m.collect(),
    })
}

/// What to tell while the camera is not tracked.
fn lost([state, reason]: [isize; 2]) -> &'static str {
    match (state, reason) {
        (LIMITED, 1) => "Move the phone slowly over the table.",
        (LIMITED, 2) => "Move the phone more slowly.",
        (LIMITED, 3) => "There is too little to see. Show more of the table and what stands on it.",
        (LIMITED, 4) => "Look where you looked before, and the phone finds its place again.",
        _ => "The phone does not know where it is.",
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const UPRIGHT: [[f32; 4]; 4] = [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [1.0, 2.0, 3.0, 1.0],
    ];

    /// Four by two pixels with a padded row.
    fn raw() -> RawFrame<'static> {
        let plane = |bytes, row_stride| RawPlane { bytes, row_stride };
        RawFrame {
            timestamp: 12.5,
            pixel_format: FULL_RANGE,
            size_px: [4, 2],
            planes: vec![
                plane(&[1, 2, 3, 4, 0, 0, 5, 6, 7, 8, 0, 0], 6),
                plane(&[90, 200, 91, 201, 0, 0], 6),
            ],
            intrinsics: [
                [500.0, 0.0, 0.0, 7.0],
                [0.0, 510.0, 0.0, 7.0],
                [1.5, 0.5, 1.0, 7.0],
            ],
            transform: UPRIGHT,
            tracking: [2, 0],
            exposure: [0.01, 0.0],
            light: Some([1000.0, 6500.0]),
            surfaces: vec![RawSurface {
                id: [1; 16],
                alignment: 0,
                transform: UPRIGHT,
                boundary: vec![[0.5, 0.0, -0.25, f32::NAN]],
            }],
        }
    }

    #[test]
    fn a_frame_is_taken_whole() {
        let frame = TrackedFrame::new(&raw()).expect("a frame");
        assert_eq!(frame.time_ns, 12_500_000_000);
        let CameraImage::Planes(image) = &frame.image else {
            panic!("{:?}", frame.image);
        };
        assert_eq!(image.luma(), [1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(image.chroma(), [90, 200, 91, 201]);
        assert_eq!(image.encoding().range, CodeRange::Full);
        let pose = frame.world_from_camera.expect("a pose");
        assert_eq!(pose.transform_point3(DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(
            frame.sensor_px_from_camera_rdf * DVec3::Z,
            DVec3::new(2.0, 1.0, 1.0)
        );
        let light = frame.light.expect("light");
        assert_eq!(
            (light.ambient_intensity, light.color_temperature_k),
            (Some(1000.0), Some(6500.0))
        );
        assert_eq!((frame.lost, frame.exposure_s), (None, Some(0.01)));
        assert_eq!(frame.planes[0].outline_m, [DVec2::new(0.5, -0.25)]);
        assert!(!frame.planes[0].is_upright);
    }

    #[test]
    fn what_is_not_tracked_has_no_pose_and_a_message() {
        for tracking in [[0, 0], [1, 0], [1, 1], [1, 2], [1, 3], [1, 4], [1, 9], [7, 0]] {
            let frame = TrackedFrame::new(&RawFrame { tracking, ..raw() }).expect("a frame");
            assert_eq!(frame.world_from_camera, None);
            assert!(
                frame.lost.is_some_and(|message| message.ends_with('.')),
                "{tracking:?}"
            );
        }
    }

    #[test]
    fn frames_that_make_no_sense_are_refused() {
        let no_focal_length = [[0.0; 4], [0.0; 4], [1.5, 0.5, 1.0, 0.0]];
        let none = RawPlane {
            bytes: &[],
            row_stride: 0,
        };
        let wrong = [
            (
                "format",
                RawFrame {
                    pixel_format: 0,
                    ..raw()
                },
            ),
            (
                "1 planes",
                RawFrame {
                    planes: vec![none],
                    ..raw()
                },
            ),
            (
                "luma: ",
                RawFrame {
                    planes: vec![none; 2],
                    ..raw()
                },
            ),
            (
                "px; 1 to 8192",
                RawFrame {
                    size_px: [usize::MAX, 2],
                    ..raw()
                },
            ),
            (
                "focal length",
                RawFrame {
                    intrinsics: no_focal_length,
                    ..raw()
                },
            ),
            (
                "time",
                RawFrame {
                    timestamp: f64::NAN,
                    ..raw()
                },
            ),
            (
                "time",
                RawFrame {
                    timestamp: -1.0,
                    ..raw()
                },
            ),
        ];
        for (message, raw) in wrong {
            let error = TrackedFrame::new(&raw).expect_err(message).to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn planes_that_make_no_sense_are_left_out() {
        let good = &raw().surfaces[0];
        let wrong = [
            RawSurface {
                alignment: 7,
                ..good.clone()
            },
            RawSurface {
                transform: [[0.0; 4]; 4],
                ..good.clone()
            },
            RawSurface {
                boundary: vec![[f32::NAN; 4]],
                ..good.clone()
            },
        ];
        assert!(found_plane(good).is_some());
        for wrong in wrong {
            assert_eq!(found_plane(&wrong), None, "{wrong:?}");
        }
    }
}
