//! Tracks the lights of a probe, picture by picture.

use serde::Serialize;

use super::error::ProbeError;
use super::look::look;
use super::near_light::{Meeting, Ray, agree, meet};
use super::{Form, ProbeView, Rejected, SeenLight, Sighting};
use app_scene::scene::{Light, Probe};

/// Number of earlier views whose rays are kept.
const MOST_VIEWS: usize = 16;
/// Largest angular radius of a light, in radians.
const WIDEST_RAD: f64 = 1.5;

/// Tracks a probe through its pictures: the last lights stay while it is out of view, as in the
/// paper, and several views constrain the distance of a light.
///
/// Lights are those of the latest view; earlier ones only add rays to them. So a light that was
/// moved or switched off changes at once, as soon as the probe is visible.
#[derive(Clone, Debug, Default)]
pub struct Track {
    form: Form,
    views: Vec<Vec<SeenLight>>,
    lights: Vec<TrackedLight>,
    rejected: Vec<Rejected>,
    n_unseen: usize,
}

/// A light estimated from a probe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrackedLight {
    /// The light as a scene lists it: a sphere if views constrain its distance, and else a light in
    /// the direction of the latest view, since a mean over views from several places would be off
    /// for a near light.
    pub light: Light,
    /// The light in the latest view that shows it.
    pub seen: SeenLight,
    /// Distance from the probe, in metres; `None` if unconstrained.
    pub distance_m: Option<f64>,
    /// Standard deviation of the inverse distance, in 1/m; infinite for a single view.
    pub nearness_deviation_per_m: f64,
    /// Number of views that show it.
    pub n_views: usize,
}

impl Track {
    /// A track without views.
    #[must_use]
    pub fn new(form: Form) -> Self {
        Self {
            form,
            ..Self::default()
        }
    }

    /// Adds one more picture. If the probe is out of view, its lights stay.
    ///
    /// # Errors
    /// When a value of the view is invalid; nothing changes then.
    pub fn look(&mut self, view: &ProbeView<'_>) -> Result<(), ProbeError> {
        let Sighting { lights, rejected } = match look(view, self.form) {
            Err(error) if error.is_out_of_view() => {
                self.n_unseen += 1;
                return Ok(());
            }
            sighting => sighting?,
        };
        self.n_unseen = 0;
        self.rejected = rejected;
        self.lights = lights.iter().map(|seen| self.tracked(seen)).collect();
        self.views.push(lights);
        if self.views.len() > MOST_VIEWS {
            self.views.remove(0);
        }
        Ok(())
    }

    /// Lights of the latest view of the probe, the strongest first.
    #[must_use]
    pub fn lights(&self) -> &[TrackedLight] {
        &self.lights
    }

    /// Rejected bright regions of that view.
    #[must_use]
    pub fn rejected(&self) -> &[Rejected] {
        &self.rejected
    }

    /// Number of later pictures, which do not show the probe.
    #[must_use]
    pub fn n_unseen(&self) -> usize {
        self.n_unseen
    }

    /// A light of the latest view with the rays of earlier ones that agree with it, one per view.
    fn tracked(&self, seen: &SeenLight) -> TrackedLight {
        let mut rays = vec![ray(seen)];
        if self.form == Form::Exact {
            for view in self.views.iter().rev() {
                let agreeing = view.iter().map(ray).filter(|earlier| agree(&rays[0], earlier));
                let nearest = agreeing.min_by(|a, b| {
                    let off = |ray: &Ray| ray.direction.angle_between(seen.direction_in_world);
                    off(a).total_cmp(&off(b))
                });
                // A light with another earlier place is a different one.
                let Some(nearest) = nearest else { break };
                rays.push(nearest);
            }
        }
        let meeting = meet(&rays);
        let angular_radius_rad = seen.angular_radius_rad.min(WIDEST_RAD);
        let near = meeting
            .filter(Meeting::is_significant)
            .map(|meeting| Light::sphere(meeting.position, meeting.distance_m * angular_radius_rad.sin()));
        let near = near.filter(|light| light.check("light").is_ok());
        TrackedLight {
            light: near.unwrap_or(Light::directional(seen.direction_in_world, angular_radius_rad)),
            seen: *seen,
            distance_m: near.and(meeting).map(|meeting| meeting.distance_m),
            nearness_deviation_per_m: meeting
                .map_or(f64::INFINITY, |meeting| meeting.nearness_deviation_per_m),
            n_views: rays.len(),
        }
    }
}

fn ray(seen: &SeenLight) -> Ray {
    Ray {
        origin: seen.origin_in_world,
        direction: seen.direction_in_world,
        deviation_rad: seen.deviation_rad,
    }
}

/// Estimates from all pictures of a probe.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ProbeReport {
    /// Lights, the strongest first.
    pub lights: Vec<TrackedLight>,
    /// The same in the published form, from the latest picture that shows the probe.
    pub published: Vec<Light>,
    /// Rejected bright regions of that picture.
    pub rejected: Vec<Rejected>,
    /// Number of later pictures, which do not show the probe.
    pub n_unseen: usize,
}

impl ProbeReport {
    /// Evaluates the pictures of a probe, one after the other.
    ///
    /// # Errors
    /// When a value of one is invalid.
    pub fn of(probe: &Probe) -> Result<Self, ProbeError> {
        let mut tracks = [Form::Exact, Form::Published].map(Track::new);
        for picture in &probe.pictures {
            for track in &mut tracks {
                track.look(&ProbeView {
                    shape: &probe.shape,
                    picture,
                })?;
            }
        }
        let [exact, published] = tracks;
        Ok(Self {
            published: published.lights.iter().map(|light| light.light).collect(),
            lights: exact.lights,
            rejected: exact.rejected,
            n_unseen: exact.n_unseen,
        })
    }
}
