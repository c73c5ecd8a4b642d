//! The lights that a probe tells, picture by picture.

use serde::Serialize;

use super::error::ProbeError;
use super::look::look;
use super::near_light::{Meeting, Ray, agree, meet};
use super::{Form, ProbeView, Rejected, SeenLight, Sighting};
use app_scene::scene::{Light, Probe};

/// Earlier views whose rays are kept.
const MOST_VIEWS: usize = 16;
/// No light is taken for wider, in radians.
const WIDEST_RAD: f64 = 1.5;

/// Follows a probe through pictures of it: the last lights stay while it is out of view, as the paper has it, and several views tell
/// how far away a light is.
///
/// Lights are those of the latest view; earlier ones only add rays to them. So a light that was moved or put out is so at once, as
/// soon as the probe is seen.
#[derive(Clone, Debug, Default)]
pub struct Track {
    form: Form,
    views: Vec<Vec<SeenLight>>,
    lights: Vec<TrackedLight>,
    rejected: Vec<Rejected>,
    n_unseen: usize,
}

/// A light that a probe tells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrackedLight {
    /// As a scene lists it: a sphere where views tell its distance, and else where the latest of them has it, since a mean of views from
    /// several places would be off for a light that is near after all.
    pub light: Light,
    /// In the latest view that shows it.
    pub seen: SeenLight,
    /// From the probe, in metres; none where it is not told.
    pub distance_m: Option<f64>,
    /// One deviation of one over the distance, in 1/m; infinite where one view alone shows it.
    pub nearness_deviation_per_m: f64,
    /// Views that show it.
    pub n_views: usize,
}

impl Track {
    /// Has seen nothing.
    #[must_use]
    pub fn new(form: Form) -> Self {
        Self {
            form,
            ..Self::default()
        }
    }

    /// Looks at one more picture. Where the probe is out of view, its lights stay.
    ///
    /// # Errors
    /// When a value of the view cannot be; nothing changes then.
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

    /// Lights of the latest view of the probe, those that give most first.
    #[must_use]
    pub fn lights(&self) -> &[TrackedLight] {
        &self.lights
    }

    /// Bright regions of that view that are no lights.
    #[must_use]
    pub fn rejected(&self) -> &[Rejected] {
        &self.rejected
    }

    /// Pictures since then, which do not show the probe.
    #[must_use]
    pub fn n_unseen(&self) -> usize {
        self.n_unseen
    }

    /// A light of the latest view with the rays of earlier ones that agree with it, one a view.
    fn tracked(&self, seen: &SeenLight) -> TrackedLight {
        let mut rays = vec![ray(seen)];
        if self.form == Form::Exact {
            for view in self.views.iter().rev() {
                let agreeing = view.iter().map(ray).filter(|earlier| agree(&rays[0], earlier));
                let nearest = agreeing.min_by(|a, b| {
                    let off = |ray: &Ray| ray.direction.angle_between(seen.direction_in_world);
                    off(a).total_cmp(&off(b))
                });
                // A light that was elsewhere before is another one.
                let Some(nearest) = nearest else { break };
                rays.push(nearest);
            }
        }
        let meeting = meet(&rays);
        let angular_radius_rad = seen.angular_radius_rad.min(WIDEST_RAD);
        let near = meeting
            .filter(Meeting::is_told)
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

/// What all pictures of a probe tell.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ProbeReport {
    /// Lights, those that give most first.
    pub lights: Vec<TrackedLight>,
    /// The same in the published form, of the latest picture that shows the probe.
    pub published: Vec<Light>,
    /// Bright regions of that picture that are no lights.
    pub rejected: Vec<Rejected>,
    /// Pictures after that one, which do not show the probe.
    pub n_unseen: usize,
}

impl ProbeReport {
    /// Looks at the pictures of a probe, one after the other.
    ///
    /// # Errors
    /// When a value of one cannot be.
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
