//! Finds a plane by the toy's shadow alone, for things whose outline by colour is wrong: too small, because
//! they look like the table, or too large, because their own shadow is included.
//!
//! The first plane comes from the few pixels that are certainly of the thing. Where the
//! shadow on the plane would differ from that on the receiver, the picture shows which of both a pixel
//! has. Those on the plane have its colours, by which it is bounded, and all pixels within its bounds
//! are the next evidence.

use glam::{DVec3, IVec2, Vec3Swizzles};

use super::colored_extent::{Evidence, Surroundings};
use super::extent::{Extent, Outline};
use super::inner::certain;
use super::planes::{Candidate, FoundPlane, SHADOWED, Search};
use super::seeds::{EXPLAINED, UNEXPLAINED, is_unexplained};
use super::shadow_loss::square;
use crate::lights::Compared;
use crate::picture::{Level, brightness};
use crate::raster::Rasterizer;
use crate::receivers::SeenReceiver;

/// Rounds of bounds and plane.
const N_ROUNDS: usize = 2;

/// The plane; `None` if none is a clear improvement.
pub(super) fn found(
    mut search: Search<'_>,
    mut candidate: Candidate,
    outline: &Outline<'_>,
) -> Option<FoundPlane> {
    let raster = &mut Rasterizer::default();
    let mut bounds = None;
    let is_level = candidate.is_level;
    for _ in 0..N_ROUNDS {
        let evidence = search.evidence(raster, &candidate);
        let endless = search.plane(&candidate.heights).plane_from_camera;
        let on_table = DVec3::new(search.middle.x, 0.0, search.middle.y);
        let middle = search
            .table
            .plane_from_camera
            .inverse()
            .transform_point3(on_table);
        let surroundings = Surroundings::new(outline.level, &endless, (middle, search.reach_m))?;
        let extent = surroundings.extent(&evidence)?;
        search = search.over(&extent.plane(&endless));
        let start = candidate.heights;
        candidate = search.refined(raster, &[[start[0], 0.0, 0.0]], &[start])?;
        if !is_level {
            // With pixels beside the plane, such as those of a face below it, a descent may have ended
            // elsewhere: the search begins anew.
            let anew = search
                .best_plane(raster)
                .filter(|anew| anew.loss < candidate.loss);
            candidate = anew.unwrap_or(candidate);
        }
        if candidate.is_level != is_level {
            return None;
        }
        bounds = Some(extent);
    }
    let losses = search.significant_losses(raster, &candidate, outline.colored)?;
    let endless = search.plane(&candidate.heights).plane_from_camera;
    let bounds = search.on_edges(raster, &candidate, (&bounds?, outline.level));
    let bounds = if is_level {
        bounds
    } else {
        bounds.down_to(search.table, &endless)
    };
    Some(search.reported(&bounds, (&endless, &candidate), outline.level, losses))
}

impl Search<'_> {
    /// The plane that explains all shadows near the thing best, together with the known receivers, and the
    /// search about the shadows that these do not explain. Where both would have the same shadow, no pixel is
    /// certainly of the thing: it may have none in a shadow, or many of the table's.
    pub(super) fn best_among_shadows(&self, raster: &mut Rasterizer) -> Option<(Self, Candidate)> {
        let shadowed: Vec<&Compared> = certain(self.comparison)
            .filter(|pixel| self.is_near(pixel.at) && is_shadowed(pixel))
            .collect();
        let unexplained: Vec<&Compared> = shadowed
            .iter()
            .copied()
            .filter(|pixel| is_unexplained(pixel))
            .collect();
        let about = self.about(&unexplained)?;
        let mut among = about.clone().of_pixels(&shadowed);
        among.is_mixed = true;
        let first = among.best_plane(raster)?;
        Some((about, first))
    }

    /// Whether the table behind a pixel is within reach of the thing.
    fn is_near(&self, at: IVec2) -> bool {
        self.table.point_at(&self.intrinsics, at).is_some_and(|point| {
            let on_table = self.table.plane_from_camera.transform_point3(point).xz();
            on_table.distance(self.middle) < self.reach_m
        })
    }

    /// The pixels that show a shadow of only one of both: on a plane, or on the known receivers; and those of which
    /// neither explains the shadow. A pixel that is lit may also show a side below the plane.
    fn evidence(&self, raster: &mut Rasterizer, candidate: &Candidate) -> Vec<Evidence> {
        let plane = self.plane(&candidate.heights);
        let depth = self.depth(&self.ratios(raster, &plane));
        let pixels: Vec<&Compared> = certain(self.comparison).collect();
        // What is surely explained, and what is surely not, is as for the seeds of things.
        let [explained, unexplained] = [EXPLAINED, UNEXPLAINED].map(|away| f64::from(away).powi(2));
        let places: Vec<IVec2> = pixels.iter().map(|pixel| pixel.at).collect();
        let ratios = self.on_plane.ratios(raster, &plane, &places);
        let evidence = pixels.iter().zip(ratios).filter_map(|(pixel, of_plane)| {
            let of_plane = of_plane?;
            let seen = (pixel.ratio, pixel.noise());
            let [known, new] = [(pixel.model, 1.0), (of_plane, depth)]
                .map(|(expected, depth)| square(&seen, expected, depth));
            let is_shadowed = brightness(&of_plane) < 1.0 - SHADOWED;
            let is_on_plane = is_shadowed && new < explained && known > unexplained;
            (is_on_plane || new > unexplained).then_some(Evidence {
                at: pixel.at,
                is_on_plane,
                is_explained: known.min(new) < explained,
            })
        });
        evidence.collect()
    }

    /// A rectangle with its sides on edges of the plate. A side that moves far has been on the foot of a face
    /// if the pixels between are not on the plane; otherwise it moves to a line of a pattern, and the
    /// nearest edge is taken.
    fn on_edges(
        &self,
        raster: &mut Rasterizer,
        candidate: &Candidate,
        (bounds, level): (&Extent, &Level),
    ) -> Extent {
        let endless = self.plane(&candidate.heights).plane_from_camera;
        let (above_face, nearest) = bounds.on_near_edges(level, &endless, self.table);
        let Some(nearest) = nearest else {
            return above_face;
        };
        let [inner, outer] = [&above_face, &nearest].map(|extent| extent.plane(&endless));
        let between = self.clone().of_certain(|at| {
            let is_on = |plane: &SeenReceiver| plane.point_at(&self.intrinsics, at).is_some();
            is_on(&outer) && !is_on(&inner)
        });
        if between.is_contradicted(raster, &candidate.heights) {
            above_face
        } else {
            nearest
        }
    }

    /// The same search, with the pixels of a rectangle.
    fn over(self, plane: &SeenReceiver) -> Self {
        let intrinsics = self.intrinsics;
        self.of_certain(|at| plane.point_at(&intrinsics, at).is_some())
    }

    /// The same search, with some of the pixels with little noise.
    fn of_certain(self, is_used: impl Fn(IVec2) -> bool) -> Self {
        let pixels: Vec<&Compared> = certain(self.comparison)
            .filter(|pixel| is_used(pixel.at))
            .collect();
        self.of_pixels(&pixels)
    }
}

/// Whether a pixel is in a shadow, or should be.
fn is_shadowed(pixel: &Compared) -> bool {
    brightness(&pixel.ratio).min(brightness(&pixel.model)) < 1.0 - SHADOWED
}
