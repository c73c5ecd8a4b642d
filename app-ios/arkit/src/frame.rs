//! An ARKit frame in plain numbers, and its conversion.

use app_core::camera_frame::{
    Anchor, CameraFrame, CodeRange, Display, Exposure, FoundPlane, LumaCoefficients, PlanarImage, PlaneError,
    Planes, Stamp, Tracking, YcbcrEncoding,
};
use app_core::scene::{Intrinsics, LightEstimate};
use glam::{DMat4, DVec3, Vec3Swizzles};

use crate::convert;
use crate::depth::{RawDepth, depth};
use crate::map::{RawMap, RawPlane};
use crate::people::people;

/// The constant `kCVPixelFormatType_420YpCbCr8BiPlanarFullRange`.
const FULL_RANGE: u32 = u32::from_be_bytes(*b"420f");
/// The constant `kCVPixelFormatType_420YpCbCr8BiPlanarVideoRange`.
const VIDEO_RANGE: u32 = u32::from_be_bytes(*b"420v");

/// Values of `ARTrackingState`.
const NORMAL: isize = 2;
const LIMITED: isize = 1;

/// Nanoseconds in a second.
const NS: f64 = 1e9;

/// A plane that ARKit has found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawSurface {
    /// Bytes of its identifier.
    pub id: [u8; 16],
    /// `ARPlaneAnchorAlignment`: 0 is horizontal, 1 is vertical.
    pub alignment: isize,
    /// Columns of `transform`.
    pub transform: [[f32; 4]; 4],
    /// Columns of three numbers and an unused fourth, in the plane's space.
    pub boundary: Vec<[f32; 4]>,
}

/// The content of one frame of ARKit, unchanged: nothing is turned, scaled or validated.
#[derive(Clone, Debug)]
pub struct RawFrame<'a> {
    /// Seconds since the phone started.
    pub timestamp: f64,
    /// Time of delivery on the same clock.
    pub delivered: f64,
    /// `OSType` of the pixel buffer.
    pub pixel_format: u32,
    /// Width and height of the luma.
    pub size_px: [usize; 2],
    /// Luma, then interleaved chroma; empty if the picture was lent as a texture.
    pub planes: Vec<RawPlane<'a>>,
    /// Columns of `ARCamera.intrinsics`.
    pub intrinsics: [[f32; 4]; 3],
    /// Columns of `ARCamera.transform`.
    pub transform: [[f32; 4]; 4],
    /// `ARTrackingState` and `ARTrackingStateReason`.
    pub tracking: [isize; 2],
    /// Seconds and ISO speed, if both are reported.
    pub exposure: Option<[f64; 2]>,
    /// Depths, if they are measured.
    pub depth: Option<RawDepth<'a>>,
    /// Mask of the people in it, if it is asked for.
    pub people: Option<RawMap<'a>>,
    /// Lumen and kelvin, if light is estimated.
    pub light: Option<[f64; 2]>,
    /// Planes found so far.
    pub surfaces: Vec<RawSurface>,
    /// Columns of the `transform` of the card's anchor, while it is tracked.
    pub card: Option<[[f32; 4]; 4]>,
    /// The held anchor's requested number, and the columns of its `transform`.
    pub anchor: Option<(u64, [[f32; 4]; 4])>,
    /// Columns of the `transform` of the anchor of the toy's scan, once ARKit has recognised it.
    pub toy: Option<[[f32; 4]; 4]>,
    /// `UIInterfaceOrientation` of the screen.
    pub orientation: isize,
}

/// Counts of the shell for a frame, which ARKit does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Number of frames delivered before it.
    pub n_frames: u64,
    /// Number of worlds before its own.
    pub world_epoch: u32,
}

/// Reason for refusing a frame.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum FrameError {
    /// The picture does not consist of luma and chroma.
    #[error("the camera's picture has format {0:#010x}, neither 420f nor 420v")]
    Format(u32),
    /// The number of planes is wrong.
    #[error("the camera's picture has {0} planes, not 2")]
    Count(usize),
    /// The planes do not contain their picture.
    #[error(transparent)]
    Planes(#[from] PlaneError),
    /// The intrinsics are not those of a camera.
    #[error("the camera's focal length is {0} and {1} px")]
    Camera(f64, f64),
    /// The time is not a number.
    #[error("the frame's time is {0} s")]
    Time(f64),
}

/// Converts `raw` into a frame of the core; its picture is copied if it was not lent.
///
/// # Errors
///
/// Fails if its picture or its camera is invalid.
pub fn camera_frame(
    raw: &RawFrame<'_>,
    lent: Option<PlanarImage>,
    count: Count,
) -> Result<CameraFrame, FrameError> {
    let pose = (raw.tracking[0] == NORMAL).then(|| convert::world_from_camera(raw.transform));
    let exposure = raw.exposure.map(|[duration_s, iso]| Exposure { duration_s, iso });
    let toy = raw.toy.map(|transform| (Anchor::OF_TOY, transform));
    let anchors = raw.anchor.into_iter().chain(toy).filter_map(|(id, transform)| {
        Some(Anchor {
            id,
            world_from_anchor: convert::world_from_camera(transform)?,
        })
    });
    let stamp = Stamp {
        id: count.n_frames,
        time_ns: time_ns(raw.timestamp)?,
        world_epoch: count.world_epoch,
    };
    Ok(CameraFrame {
        stamp,
        age_ms: time_ns(raw.delivered)
            .ok()
            .and_then(|now_ns| stamp.age_ms(now_ns)),
        intrinsics: intrinsics(raw.intrinsics)?,
        image: lent
            .map_or_else(|| image(raw.pixel_format, raw.size_px, &raw.planes), Ok)?
            .into(),
        exposure: exposure.filter(|exposure| exposure.amount().is_some()),
        tracking: tracking(raw.tracking),
        world_from_camera: pose.flatten(),
        planes: raw.surfaces.iter().filter_map(found_plane).collect(),
        anchors: anchors.collect(),
        world_from_card: raw.card.and_then(convert::world_from_camera),
        light_estimate: raw.light.map(|[lumen, kelvin]| LightEstimate {
            ambient_intensity: Some(lumen).filter(|lumen| lumen.is_finite()),
            color_temperature_k: Some(kelvin).filter(|kelvin| kelvin.is_finite() && *kelvin > 0.0),
            ..LightEstimate::default()
        }),
        people: raw.people.as_ref().and_then(people),
        depth: raw.depth.as_ref().and_then(depth),
        display: Display {
            quarter_turns: convert::quarter_turns(raw.orientation),
            ..Display::default()
        },
    })
}

/// The encoding of a pixel buffer.
///
/// # Errors
///
/// Fails if it does not consist of luma and chroma.
pub fn encoding(pixel_format: u32) -> Result<YcbcrEncoding, FrameError> {
    let range = match pixel_format {
        FULL_RANGE => CodeRange::Full,
        VIDEO_RANGE => CodeRange::Video,
        other => return Err(FrameError::Format(other)),
    };
    Ok(YcbcrEncoding {
        coefficients: LumaCoefficients::Bt601,
        range,
    })
}

/// A copy of a pixel buffer's planes.
///
/// # Errors
///
/// Fails if they do not consist of luma and chroma.
pub fn image(
    pixel_format: u32,
    size_px: [usize; 2],
    planes: &[RawPlane<'_>],
) -> Result<PlanarImage, FrameError> {
    let encoding = encoding(pixel_format)?;
    let [luma, chroma] = planes else {
        return Err(FrameError::Count(planes.len()));
    };
    let planes = Planes::nv12(
        // A side that overflows is too long for the planes, too.
        size_px.map(|side| u32::try_from(side).unwrap_or(u32::MAX)),
        (luma.bytes, luma.row_stride),
        (chroma.bytes, chroma.row_stride),
        encoding,
    );
    Ok(PlanarImage::new(&planes)?)
}

fn intrinsics(columns: [[f32; 4]; 3]) -> Result<Intrinsics, FrameError> {
    let sensor_px_from_camera_rdf = convert::sensor_px_from_camera_rdf(columns);
    let [x, y, centre] = [0, 1, 2].map(|index| sensor_px_from_camera_rdf.col(index));
    if !(x.x > 0.0 && y.y > 0.0 && sensor_px_from_camera_rdf.is_finite()) {
        return Err(FrameError::Camera(x.x, y.y));
    }
    Ok(Intrinsics {
        fx_px: x.x,
        fy_px: y.y,
        cx_px: centre.x,
        cy_px: centre.y,
    })
}

fn time_ns(seconds: f64) -> Result<i64, FrameError> {
    if !(0.0..1e9).contains(&seconds) {
        return Err(FrameError::Time(seconds));
    }
    #[allow(clippy::cast_possible_truncation, reason = "below 1e18, as was just seen")]
    Ok((seconds * NS).round() as i64)
}

/// A level plane as the rectangle along its own axes around its boundary. `None` if it is vertical
/// or has no extent.
fn found_plane(raw: &RawSurface) -> Option<FoundPlane> {
    let corners = raw.boundary.iter();
    let corners = corners.map(|corner| DVec3::new(corner[0].into(), 0.0, corner[2].into()));
    let least = corners.clone().reduce(DVec3::min)?;
    let most = corners.clone().reduce(DVec3::max)?;
    let half_extent_m = 0.5 * (most - least);
    let is_level = raw.alignment == 0;
    let has_extent = half_extent_m.x > 0.0 && half_extent_m.z > 0.0 && corners.fold(0.0, sum).is_finite();
    let world_from_plane = convert::world_from_camera(raw.transform)?;
    (is_level && has_extent).then(|| FoundPlane {
        id: (0..8).fold(0, |id, byte| id << 8 | u64::from(raw.id[byte] ^ raw.id[byte + 8])),
        world_from_plane: world_from_plane * DMat4::from_translation(0.5 * (least + most)),
        half_extent_m: half_extent_m.xz(),
    })
}

fn sum(sum: f64, corner: DVec3) -> f64 {
    sum + corner.x + corner.z
}

fn tracking([state, reason]: [isize; 2]) -> Tracking {
    match (state, reason) {
        (NORMAL, _) => Tracking::Normal,
        (LIMITED, 2) => Tracking::TooFast,
        (LIMITED, 3) => Tracking::TooPlain,
        (LIMITED, 4) => Tracking::Relocalising,
        _ => Tracking::Starting,
    }
}

#[cfg(test)]
mod tests {
    use app_core::camera_frame::CameraImage;
    use glam::DVec2;

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
            delivered: 12.53,
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
            exposure: Some([0.01, 50.0]),
            light: Some([1000.0, 6500.0]),
            depth: None,
            people: None,
            surfaces: vec![RawSurface {
                id: [1; 16],
                alignment: 0,
                transform: UPRIGHT,
                boundary: vec![[0.5, 0.0, -0.25, f32::NAN], [-0.5, 0.0, 0.75, f32::NAN]],
            }],
            card: Some(UPRIGHT),
            anchor: Some((3, UPRIGHT)),
            toy: None,
            orientation: 4,
        }
    }

    const COUNT: Count = Count {
        n_frames: 7,
        world_epoch: 2,
    };

    #[test]
    fn a_frame_is_taken_whole() {
        let frame = camera_frame(&raw(), None, COUNT).expect("a frame");
        assert_eq!(
            (frame.stamp.id, frame.stamp.time_ns, frame.stamp.world_epoch),
            (7, 12_500_000_000, 2)
        );
        assert!(frame.age_ms.is_some_and(|age_ms| (age_ms - 30.0).abs() < 1e-6));
        let CameraImage::Planes(image) = &frame.image else {
            panic!("{:?}", frame.image);
        };
        assert_eq!(image.luma(), [1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(image.chroma(), [90, 200, 91, 201]);
        assert_eq!(frame.world_from_card, convert::world_from_camera(UPRIGHT));
        assert!(frame.world_from_card.is_some());
        assert_eq!(image.encoding().range, CodeRange::Full);
        let pose = frame.world_from_camera.expect("a pose");
        assert_eq!(pose.transform_point3(DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
        let camera = frame.intrinsics;
        assert_eq!([camera.fx_px, camera.fy_px], [500.0, 510.0]);
        assert_eq!([camera.cx_px, camera.cy_px], [2.0, 1.0]);
        let light = frame.light_estimate.expect("light");
        assert_eq!(
            (light.ambient_intensity, light.color_temperature_k),
            (Some(1000.0), Some(6500.0))
        );
        assert_eq!(frame.exposure.and_then(|exposure| exposure.amount()), Some(0.005));
        assert_eq!((frame.anchors[0].id, frame.anchors.len()), (3, 1));
        assert_eq!(
            frame.display.quarter_turns, 2,
            "the phone is held by the other hand"
        );
    }

    #[test]
    fn a_toy_that_is_recognised_is_an_anchor_of_its_own() {
        let recognised = RawFrame {
            toy: Some(UPRIGHT),
            ..raw()
        };
        let frame = camera_frame(&recognised, None, COUNT).expect("a frame");
        let ids: Vec<u64> = frame.anchors.iter().map(|anchor| anchor.id).collect();
        assert_eq!(ids, [3, Anchor::OF_TOY]);
        let at = frame.anchors[1].world_from_anchor.transform_point3(DVec3::ZERO);
        assert_eq!(at, DVec3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn a_plane_is_the_rectangle_that_its_boundary_fills() {
        let plane = found_plane(&raw().surfaces[0]).expect("a plane");
        assert_eq!(plane.half_extent_m, DVec2::new(0.5, 0.5));
        // Between (0.5, -0.25) and (-0.5, 0.75), from a plane at (1, 2, 3).
        let centre = plane.world_from_plane.transform_point3(DVec3::ZERO);
        assert_eq!(centre, DVec3::new(1.0, 2.0, 3.25));
    }

    #[test]
    fn what_is_not_tracked_has_no_pose_and_says_what_helps() {
        let told = [
            ([0, 0], Tracking::Starting),
            ([1, 0], Tracking::Starting),
            ([1, 1], Tracking::Starting),
            ([1, 2], Tracking::TooFast),
            ([1, 3], Tracking::TooPlain),
            ([1, 4], Tracking::Relocalising),
            ([1, 9], Tracking::Starting),
            ([7, 0], Tracking::Starting),
        ];
        for (tracking, expected) in told {
            let frame = camera_frame(&RawFrame { tracking, ..raw() }, None, COUNT).expect("a frame");
            assert_eq!((frame.tracking, frame.world_from_camera), (expected, None));
        }
    }

    #[test]
    fn exposures_and_anchors_that_make_no_sense_are_left_out() {
        let wrong = RawFrame {
            exposure: Some([0.01, f64::NAN]),
            anchor: Some((3, [[0.0; 4]; 4])),
            toy: Some([[f32::NAN; 4]; 4]),
            ..raw()
        };
        let frame = camera_frame(&wrong, None, COUNT).expect("a frame");
        assert_eq!((frame.exposure, frame.anchors.len()), (None, 0));
    }

    #[test]
    fn frames_that_make_no_sense_are_refused() {
        let no_focal_length = [[0.0; 4], [0.0; 4], [1.5, 0.5, 1.0, 0.0]];
        let none = RawPlane {
            bytes: &[],
            row_stride: 0,
        };
        #[rustfmt::skip] // Each case has a line of its own.
        let wrong = [
            ("format", RawFrame { pixel_format: 0, ..raw() }),
            ("1 planes", RawFrame { planes: vec![none], ..raw() }),
            ("luma: ", RawFrame { planes: vec![none; 2], ..raw() }),
            ("px; 1 to 8192", RawFrame { size_px: [usize::MAX, 2], ..raw() }),
            ("focal length", RawFrame { intrinsics: no_focal_length, ..raw() }),
            ("time", RawFrame { timestamp: f64::NAN, ..raw() }),
            ("time", RawFrame { timestamp: -1.0, ..raw() }),
        ];
        for (message, raw) in wrong {
            let error = camera_frame(&raw, None, COUNT).expect_err(message).to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn planes_that_make_no_sense_are_left_out() {
        let good = &raw().surfaces[0];
        #[rustfmt::skip] // Each case has a line of its own.
        let wrong = [
            RawSurface { alignment: 1, ..good.clone() },
            RawSurface { boundary: Vec::new(), ..good.clone() },
            RawSurface { boundary: vec![good.boundary[0]; 3], ..good.clone() },
            RawSurface {
                transform: [[0.0; 4]; 4],
                ..good.clone()
            },
            RawSurface { boundary: vec![good.boundary[0], good.boundary[1], [f32::NAN; 4]], ..good.clone() },
        ];
        assert!(found_plane(good).is_some());
        for wrong in wrong {
            assert_eq!(found_plane(&wrong), None, "{wrong:?}");
        }
    }
}
