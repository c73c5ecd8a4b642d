//! What alignment found, as it stands in `report.json`: in millimetres and degrees.

use app_core::alignment::{
    CameraAlignment, DiscoveredLight, LensAlignment, LightAlignment, PoseAlignment, RatioAlignment,
};
use app_core::probe::{ProbeReport, TrackedLight};
use app_core::scene::Light;
use serde::Serialize;

use crate::alignment::{Aligned, SeenLight};

/// Of one frame.
#[derive(Clone, Debug, Serialize)]
pub struct AlignmentEntry {
    /// Time that it took on the processor.
    pub cpu_ms: f64,
    /// The focal length; none where nobody asked for it.
    pub focal_length: Option<RatioEntry>,
    /// Lengths of the world over what they are by the toy's model; none where nobody asked for it.
    pub world_scale: Option<RatioEntry>,
    /// The camera; none where there is no plate or too little texture.
    pub camera: Option<CameraEntry>,
    /// The toy's pose; none where too little of its outline is seen.
    pub pose: Option<PoseEntry>,
    /// The lights, in the order of the list; empty where their shadows were not looked at.
    pub lights: Vec<LightEntry>,
    /// Error of the predicted shadows over what noise and model are expected to leave, with the given lights and with those found.
    pub light_errors: Option<[f64; 2]>,
    /// Lights that a probe tells, strongest first; none where it was not asked.
    pub probe: Option<ProbeEntry>,
    /// Lights that nobody lists as their shadows tell them, strongest first.
    pub discovered: Vec<DiscoveredEntry>,
    /// Why none was.
    pub no_light: Option<String>,
    /// Part of the shadows in the picture that the lights in use leave unexplained.
    pub unexplained: Option<f64>,
    /// Whether the plates are taken in another light than they were photographed in.
    pub is_relit: bool,
    /// Lights on the session's list, where that was put aside.
    pub n_listed: usize,
}

/// What a probe tells.
#[derive(Clone, Debug, Serialize)]
pub struct ProbeEntry {
    /// Lights, strongest first.
    pub lights: Vec<ProbeLightEntry>,
    /// Bright regions that are none, and why.
    pub rejected: Vec<RejectedEntry>,
    /// Lights in the published form, which preset `paper` is given.
    pub n_published: usize,
    /// Last pictures that do not show the probe.
    pub n_unseen: usize,
}

/// A light that a probe tells.
#[derive(Clone, Debug, Serialize)]
pub struct ProbeLightEntry {
    /// Unit vector from the probe, in the world.
    pub direction: [f64; 3],
    /// One deviation of it.
    pub direction_deviation_deg: f64,
    /// From the probe; none where it is not told.
    pub distance_m: Option<f64>,
    /// Half the angle that it fills, as its highlight tells.
    pub angular_radius_deg: f64,
    /// Views that show it.
    pub n_views: usize,
    /// Middle of its highlight in the latest of them.
    pub at_px: [f64; 2],
    /// Against the nearest light of the session's list, as seen from the probe, where that was put aside.
    pub against_listed: Option<ErrorEntry>,
}

/// A bright region that is no light's.
#[derive(Clone, Debug, Serialize)]
pub struct RejectedEntry {
    /// Its middle.
    pub at_px: [f64; 2],
    /// Why.
    pub reason: String,
}

/// A light that was found.
#[derive(Clone, Debug, Serialize)]
pub struct DiscoveredEntry {
    /// Unit vector from the toy's middle, in the world.
    pub direction: [f64; 3],
    /// None where it is too far away to be told.
    pub distance_m: Option<f64>,
    /// Half the angle that it fills.
    pub angular_radius_deg: f64,
    /// Its part of the light at the toy's foot.
    pub share: f64,
    /// One deviation of the direction; none where nothing tells it, as for those below.
    pub direction_deviation_deg: Option<f64>,
    /// One deviation of one over the distance.
    pub nearness_deviation_per_m: Option<f64>,
    /// One deviation of the angular radius.
    pub angular_radius_deviation_deg: Option<f64>,
    /// Against the nearest light of the session's list, where that was put aside.
    pub against_listed: Option<ErrorEntry>,
}

/// Error of a light that was found.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorEntry {
    /// Its place in the list.
    pub index: usize,
    /// Between the directions.
    pub direction_deg: f64,
    /// Found distance over the listed; none where one of them has none.
    pub distance_ratio: Option<f64>,
    /// Found angular radius over the listed; none for a point light.
    pub size_ratio: Option<f64>,
}

/// A lens.
#[derive(Clone, Debug, Serialize)]
pub struct LensEntry {
    /// Whether photographs are freed of it.
    pub is_applied: bool,
    /// What was done with it, and why.
    pub outcome: String,
    /// Radial terms of its distortion.
    pub k1: f64,
    /// The second of them.
    pub k2: f64,
    /// Of what it adds at the farthest corner, in parts of the corner's distance from the principal point; none where nothing tells it.
    pub deviation: Option<f64>,
    /// Error of the shadows without and with it.
    pub errors: Option<[f64; 2]>,
}

/// The focal length, or the scale of the world.
#[derive(Clone, Debug, Serialize)]
pub struct RatioEntry {
    /// Whether it was corrected.
    pub is_applied: bool,
    /// What was done with it, and why.
    pub outcome: String,
    /// Found over given.
    pub ratio: f64,
    /// Of the ratio; none where nothing tells it.
    pub deviation: Option<f64>,
    /// Error of the shadows with the given and with the found one.
    pub errors: Option<[f64; 2]>,
}

/// The camera.
#[derive(Clone, Debug, Serialize)]
pub struct CameraEntry {
    /// Whether it was corrected.
    pub is_applied: bool,
    /// Root mean square that points of the receivers moved in the picture.
    pub moved_px: f64,
    /// From given to found.
    pub moved_mm: f64,
    /// From given to found.
    pub turned_deg: f64,
    /// Part of the points that the given and the found camera do not explain.
    pub errors: [f64; 2],
}

/// The toy's pose.
#[derive(Clone, Debug, Serialize)]
pub struct PoseEntry {
    /// Whether the toy is shown elsewhere than it was given.
    pub is_applied: bool,
    /// Whether it is shown where an earlier view has it.
    pub is_held: bool,
    /// From given to found.
    pub moved_mm: f64,
    /// From given to found.
    pub turned_deg: f64,
    /// Root mean square distance between the outline as given, or as held, and that in the picture.
    pub given_outline_px: f64,
    /// The same as found.
    pub outline_px: f64,
    /// One deviation across the line of sight, by noise alone.
    pub lateral_deviation_mm: f64,
    /// One deviation along it.
    pub depth_deviation_mm: f64,
    /// One deviation of the rotation.
    pub rotation_deviation_deg: f64,
}

/// A light.
#[derive(Clone, Debug, Serialize)]
pub struct LightEntry {
    /// Whether it was corrected.
    pub is_applied: bool,
    /// From given to found, at the toy.
    pub turned_deg: f64,
    /// Found distance over the given.
    pub distance_ratio: f64,
    /// Found angular size over the given; none for a point light.
    pub size_ratio: Option<f64>,
    /// One deviation of the direction, by noise alone.
    pub deviation_deg: f64,
}

impl From<&Aligned> for AlignmentEntry {
    fn from(aligned: &Aligned) -> Self {
        let report = &aligned.alignment.report;
        Self {
            cpu_ms: aligned.cpu_ms,
            focal_length: report.focal_length.as_ref().map(RatioEntry::from),
            world_scale: report.world_scale.as_ref().map(RatioEntry::from),
            camera: report.camera.as_ref().map(CameraEntry::from),
            pose: report.pose.as_ref().map(PoseEntry::from),
            lights: report.lights.iter().map(LightEntry::from).collect(),
            light_errors: report.light_errors,
            probe: report
                .probe
                .as_ref()
                .map(|probe| ProbeEntry::new(probe, &aligned.put_aside)),
            discovered: report
                .discovered
                .iter()
                .map(|light| DiscoveredEntry::new(light, &aligned.listed))
                .collect(),
            no_light: report.no_light.map(|reason| reason.to_string()),
            unexplained: report.unexplained,
            is_relit: report.is_relit,
            n_listed: aligned.listed.len(),
        }
    }
}

impl ProbeEntry {
    fn new(probe: &ProbeReport, put_aside: &[Light]) -> Self {
        let light = |light: &TrackedLight| {
            let found = SeenLight::from(light.seen.origin_in_world, &light.light);
            let listed = put_aside.iter();
            let listed: Vec<SeenLight> = listed
                .map(|listed| SeenLight::from(light.seen.origin_in_world, listed))
                .collect();
            ProbeLightEntry {
                direction: found.direction_in_world.to_array(),
                direction_deviation_deg: light.seen.deviation_rad.to_degrees(),
                distance_m: found.distance_m,
                angular_radius_deg: found.angular_radius_rad.to_degrees(),
                n_views: light.n_views,
                at_px: light.seen.at_px.to_array(),
                against_listed: ErrorEntry::nearest(&found, &listed),
            }
        };
        let rejected = probe.rejected.iter();
        Self {
            lights: probe.lights.iter().map(light).collect(),
            rejected: rejected
                .map(|rejected| RejectedEntry {
                    at_px: rejected.at_px.to_array(),
                    reason: rejected.reason.to_string(),
                })
                .collect(),
            n_published: probe.published.len(),
            n_unseen: probe.n_unseen,
        }
    }
}

impl ErrorEntry {
    /// Against the listed light in the nearest direction; none without a list.
    pub(crate) fn nearest(found: &SeenLight, listed: &[SeenLight]) -> Option<Self> {
        let off_rad = |seen: &SeenLight| found.direction_in_world.angle_between(seen.direction_in_world);
        let nearest = listed.iter().enumerate();
        let (index, seen) = nearest.min_by(|(_, a), (_, b)| off_rad(a).total_cmp(&off_rad(b)))?;
        Some(Self {
            index,
            direction_deg: off_rad(seen).to_degrees(),
            distance_ratio: found
                .distance_m
                .zip(seen.distance_m)
                .map(|(found, listed)| found / listed),
            size_ratio: (seen.angular_radius_rad > 0.0)
                .then(|| found.angular_radius_rad / seen.angular_radius_rad),
        })
    }
}

impl DiscoveredEntry {
    fn new(light: &DiscoveredLight, listed: &[SeenLight]) -> Self {
        Self {
            direction: light.direction_in_world.to_array(),
            distance_m: light.distance_m,
            angular_radius_deg: light.angular_radius_rad.to_degrees(),
            share: light.share,
            direction_deviation_deg: told(light.deviation.direction_rad.to_degrees()),
            nearness_deviation_per_m: told(light.deviation.nearness_per_m),
            angular_radius_deviation_deg: told(light.deviation.angular_radius_rad.to_degrees()),
            against_listed: ErrorEntry::nearest(&SeenLight::found(light), listed),
        }
    }
}

impl From<&LensAlignment> for LensEntry {
    fn from(found: &LensAlignment) -> Self {
        Self {
            is_applied: found.is_applied(),
            outcome: found.outcome.to_string(),
            k1: found.distortion.k1,
            k2: found.distortion.k2,
            deviation: told(found.deviation),
            errors: found.errors,
        }
    }
}

impl From<&RatioAlignment> for RatioEntry {
    fn from(found: &RatioAlignment) -> Self {
        Self {
            is_applied: found.is_applied(),
            outcome: found.outcome.to_string(),
            ratio: found.ratio,
            deviation: told(found.deviation),
            errors: found.errors,
        }
    }
}

impl From<&CameraAlignment> for CameraEntry {
    fn from(camera: &CameraAlignment) -> Self {
        Self {
            is_applied: camera.is_applied,
            moved_px: camera.moved_px,
            moved_mm: 1e3 * camera.moved_m,
            turned_deg: camera.turned_rad.to_degrees(),
            errors: camera.errors,
        }
    }
}

impl From<&PoseAlignment> for PoseEntry {
    fn from(pose: &PoseAlignment) -> Self {
        let mm = |metres: f64| 1e3 * metres;
        Self {
            is_applied: pose.is_applied,
            is_held: pose.is_held,
            moved_mm: mm(pose.moved_m),
            turned_deg: pose.turned_rad.to_degrees(),
            given_outline_px: pose.given_outline_px,
            outline_px: pose.outline_px,
            lateral_deviation_mm: mm(pose.deviation.lateral_m),
            depth_deviation_mm: mm(pose.deviation.depth_m),
            rotation_deviation_deg: pose.deviation.rotation_rad.to_degrees(),
        }
    }
}

impl From<&LightAlignment> for LightEntry {
    fn from(light: &LightAlignment) -> Self {
        Self {
            is_applied: light.is_applied,
            turned_deg: light.turned_rad.to_degrees(),
            distance_ratio: light.distance_ratio,
            size_ratio: light.size_ratio,
            deviation_deg: light.deviation_rad.to_degrees(),
        }
    }
}

/// A deviation that is not without end.
fn told(deviation: f64) -> Option<f64> {
    deviation.is_finite().then_some(deviation)
}
