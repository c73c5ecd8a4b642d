//! From a scene to the records of `capture.json`: the inverse of reading.

use super::record::{
    BackgroundRecord, CaptureRecord, Encoding, FacetRecord, IntrinsicsRecord, LensRecord,
    LightEstimateRecord, LightKind, LightRecord, LightUncertaintyRecord, PlaceMeshRecord, PoseRecord,
    PoseUncertaintyRecord, ProbeKind, ProbePictureRecord, ProbeRecord, ReceiverRecord, SurfaceRecord,
    ToyRecord, UncertaintyRecord,
};
use app_scene::lens::Distortion;
use app_scene::scene::{
    Facet, FacetSlope, Intrinsics, Light, LightEstimate, Pose, PoseUncertainty, Probe, ProbeShape, Receiver,
    Scene, Surface, Uncertainty,
};
use app_scene::toy::Toy;

/// Paths of the files of a scene's record, relative to the session.
#[derive(Clone, Copy, Debug)]
pub struct ScenePaths<'a> {
    /// The toy's file.
    pub toy: &'a str,
    /// Pictures of the plates, in their order.
    pub plates: &'a [String],
    /// Pictures of the probe, in their order.
    pub probe: &'a [String],
    /// The mesh of the place; `None` to leave it out.
    pub place_mesh: Option<&'a str>,
}

impl CaptureRecord {
    /// A scene without frames, whose cameras have these `intrinsics` unless they have their own.
    /// Plates and pictures of the probe without a path are left out.
    #[must_use]
    pub fn new(scene: &Scene, intrinsics: &Intrinsics, paths: ScenePaths) -> Self {
        let plates = scene.plates.iter().zip(paths.plates);
        let uncertainty =
            Some(&scene.uncertainty).filter(|uncertainty| **uncertainty != Uncertainty::default());
        Self {
            name: scene.name.clone(),
            width: scene.width_px,
            height: scene.height_px,
            encoding: Encoding::Srgb,
            intrinsics: intrinsics.into(),
            lens: None,
            toy: ToyRecord {
                file: paths.toy.to_owned(),
                world_from_object: scene.world_from_object.to_cols_array(),
                physical_pose: PoseRecord::new(&scene.physical_pose, &scene.toy),
                resting: scene.resting,
            },
            receivers: scene.receivers.iter().map(ReceiverRecord::from).collect(),
            lights: scene.lights.iter().map(LightRecord::from).collect(),
            backgrounds: plates
                .map(|(plate, path)| BackgroundRecord {
                    image: path.clone(),
                    intrinsics: Some((&plate.camera.intrinsics).into()),
                    world_from_camera: plate.camera.world_from_camera.to_cols_array(),
                })
                .collect(),
            frames: Vec::new(),
            probe: scene
                .probe
                .as_ref()
                .and_then(|probe| ProbeRecord::new(probe, paths.probe)),
            place_mesh: scene
                .place_mesh
                .as_ref()
                .zip(paths.place_mesh)
                .map(|(mesh, file)| PlaceMeshRecord {
                    file: file.to_owned(),
                    deviation: mesh.deviation_m(),
                }),
            uncertainty: uncertainty.map(UncertaintyRecord::from),
        }
    }
}

impl PoseRecord {
    /// A clip by its name, or by its number if an earlier clip has the same name. Poses of single
    /// nodes cannot be expressed: they become the authored pose.
    #[must_use]
    pub fn new(pose: &Pose, toy: &Toy) -> Self {
        let Pose::Clip { clip, time_secs } = pose else {
            return Self::default();
        };
        let name = toy.clip_names().into_iter().nth(clip.index());
        let name = name.filter(|name| toy.find_clip(name).ok() == Some(*clip));
        Self {
            clip: Some(name.unwrap_or_else(|| format!("#{}", clip.index()))),
            time: *time_secs,
        }
    }
}

impl ProbeRecord {
    /// A probe whose pictures are at `paths`, in their order; `None` without any.
    #[must_use]
    pub fn new(probe: &Probe, paths: &[String]) -> Option<Self> {
        let pictures = probe.pictures.iter().zip(paths);
        let mut pictures = pictures.map(|(picture, path)| ProbePictureRecord {
            image: path.clone(),
            exposure_ratio: Some(picture.exposure_ratio),
            intrinsics: Some((&picture.camera.intrinsics).into()),
            world_from_camera: picture.camera.world_from_camera.to_cols_array(),
            world_from_lens: Some(picture.world_from_probe.to_cols_array()),
        });
        let first = pictures.next()?;
        let (kind, slope) = match &probe.shape {
            ProbeShape::FresnelLens { slope, .. } => (ProbeKind::FresnelLens, slope),
            ProbeShape::MirrorBall { .. } => (ProbeKind::MirrorBall, &FacetSlope::Hemisphere),
        };
        let (focal_length, facets) = match slope {
            FacetSlope::Hemisphere => (None, &[][..]),
            FacetSlope::Focal { focal_m } => (Some(*focal_m), &[][..]),
            FacetSlope::Table(facets) => (None, &facets[..]),
        };
        Some(Self {
            kind,
            world_from_lens: first.world_from_lens?,
            radius: probe.shape.radius_m(),
            focal_length,
            facets: facets.iter().map(FacetRecord::from).collect(),
            image: first.image,
            exposure_ratio: first.exposure_ratio?,
            intrinsics: first.intrinsics,
            world_from_camera: Some(first.world_from_camera),
            pictures: pictures.collect(),
        })
    }
}

impl From<&Facet> for FacetRecord {
    fn from(facet: &Facet) -> Self {
        Self {
            at: facet.at,
            slope_deg: facet.slope_rad.to_degrees(),
        }
    }
}

impl From<&Intrinsics> for IntrinsicsRecord {
    fn from(intrinsics: &Intrinsics) -> Self {
        Self {
            fx: intrinsics.fx_px,
            fy: intrinsics.fy_px,
            cx: intrinsics.cx_px,
            cy: intrinsics.cy_px,
        }
    }
}

impl From<&Distortion> for LensRecord {
    fn from(distortion: &Distortion) -> Self {
        Self {
            k1: distortion.k1,
            k2: Some(distortion.k2),
        }
    }
}

impl From<&Receiver> for ReceiverRecord {
    fn from(receiver: &Receiver) -> Self {
        Self {
            name: receiver.name.clone(),
            world_from_plane: receiver.world_from_plane.to_cols_array(),
            half_extent: receiver.half_extent_m.to_array(),
            surface: match receiver.surface {
                Surface::Uniform => SurfaceRecord::Uniform,
                Surface::Textured => SurfaceRecord::Textured,
            },
        }
    }
}

impl From<&Light> for LightRecord {
    fn from(light: &Light) -> Self {
        match *light {
            Light::Sphere {
                position_in_world,
                radius_m,
            } => Self {
                kind: LightKind::Sphere,
                position: Some(position_in_world.to_array()),
                radius: Some(radius_m),
                ..Self::default()
            },
            Light::Directional {
                direction_to_light_in_world,
                angular_radius_rad,
            } => Self {
                kind: LightKind::Directional,
                direction_to_light: Some(direction_to_light_in_world.to_array()),
                angular_radius_deg: Some(angular_radius_rad.to_degrees()),
                ..Self::default()
            },
        }
    }
}

impl From<&LightEstimate> for LightEstimateRecord {
    fn from(estimate: &LightEstimate) -> Self {
        let direction = estimate.direction_to_light_in_world;
        Self {
            direction_to_light: direction.map(|direction| direction.to_array()),
            intensity: estimate.intensity,
            ambient_intensity: estimate.ambient_intensity,
            color_temperature: estimate.color_temperature_k,
            spherical_harmonics: estimate.spherical_harmonics,
        }
    }
}

impl From<&Uncertainty> for UncertaintyRecord {
    fn from(uncertainty: &Uncertainty) -> Self {
        let pose = |pose: &PoseUncertainty| PoseUncertaintyRecord {
            position: pose.position_m,
            rotation_deg: pose.rotation_rad.map(f64::to_degrees),
        };
        Self {
            toy: Some(pose(&uncertainty.toy)),
            camera: Some(pose(&uncertainty.camera)),
            lights: Some(LightUncertaintyRecord {
                direction_deg: uncertainty.lights.direction_rad.map(f64::to_degrees),
                distance_ratio: uncertainty.lights.distance_ratio,
                size_ratio: uncertainty.lights.size_ratio,
            }),
            receivers_guessed: uncertainty.are_receivers_guessed.then_some(true),
        }
    }
}
