//! A camera: every transform between image, anchor and plane spaces, composed in f64.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, UVec2};

use crate::geometry::extent::{Extent, NEAR_M};
use crate::geometry::rect::PixelRect;
use app_scene::scene::{Camera, Intrinsics};

/// A camera in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Size of the camera image.
    pub image_px: UVec2,
    intrinsics: Intrinsics,
    camera_from_world: DMat4,
}

impl View {
    /// The view of a camera.
    #[must_use]
    pub fn new(image_px: UVec2, camera: &Camera) -> Self {
        Self {
            image_px,
            intrinsics: camera.intrinsics,
            camera_from_world: camera.world_from_camera.inverse(),
        }
    }

    /// The camera's centre, in the space from which `world_from_space` transforms.
    #[must_use]
    pub fn camera_in(&self, world_from_space: &DMat4) -> DVec3 {
        (self.camera_from_world * *world_from_space)
            .inverse()
            .w_axis
            .truncate()
    }

    /// Smallest width of a pixel at a distance, in metres.
    #[must_use]
    pub fn pixel_m(&self, distance_m: f64) -> f64 {
        distance_m / self.intrinsics.fx_px.max(self.intrinsics.fy_px)
    }

    /// Whether the camera's centre is in front of a receiver, so that it shows the receiver's
    /// front.
    #[must_use]
    pub fn sees_front_of(&self, world_from_plane: &DMat4) -> bool {
        self.camera_in(world_from_plane).y > 0.0
    }

    /// Image position of a homogeneous point, as (u w, v w, w) with w its depth in metres.
    pub(crate) fn image_px_from(&self, world_from_space: &DMat4, point: DVec4) -> DVec3 {
        let at = self.camera_from_world * (*world_from_space * point);
        let depth = -at.z;
        let k = &self.intrinsics;
        DVec3::new(
            k.fx_px * at.x + k.cx_px * depth,
            -k.fy_px * at.y + k.cy_px * depth,
            depth,
        )
    }

    /// The pixels of the image that can show anything between `points`; all of them if a point is
    /// behind the camera, `None` if the points are outside the picture.
    #[must_use]
    pub fn image_rect(
        &self,
        world_from_space: &DMat4,
        points: impl Iterator<Item = DVec3>,
    ) -> Option<PixelRect> {
        let mut extent = Extent::EMPTY;
        points.for_each(|point| extent.include(self.image_px_from(world_from_space, point.extend(1.0))));
        extent.rect(self.image_px)
    }

    /// Homography from (x, z, 1) of a receiver to (u w, v w, w) in the image; w is the depth in metres.
    #[must_use]
    pub fn image_px_from_plane(&self, world_from_plane: &DMat4) -> DMat3 {
        let column = |axis| self.image_px_from(world_from_plane, axis);
        DMat3::from_cols(column(DVec4::X), column(DVec4::Z), column(DVec4::W))
    }

    /// Transform to clip space of `rect` from the space from which `world_from_space` transforms;
    /// depth is reversed, with the far plane at infinity.
    #[must_use]
    pub fn clip_from(&self, rect: &PixelRect, world_from_space: &DMat4) -> DMat4 {
        let k = &self.intrinsics;
        let size = rect.size_px.as_dvec2();
        let centre = DVec2::new(k.cx_px, k.cy_px) - rect.origin_px.as_dvec2();
        let clip_from_camera = DMat4::from_cols(
            DVec4::new(2.0 * k.fx_px / size.x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 2.0 * k.fy_px / size.y, 0.0, 0.0),
            DVec4::new(
                1.0 - 2.0 * centre.x / size.x,
                2.0 * centre.y / size.y - 1.0,
                0.0,
                -1.0,
            ),
            DVec4::new(0.0, 0.0, NEAR_M, 0.0),
        );
        clip_from_camera * self.camera_from_world * *world_from_space
    }

    /// Homography from (x, z, 1) of a receiver to clip (x, y, w) of `rect`; w is the depth in metres.
    #[must_use]
    pub fn clip_from_plane(&self, rect: &PixelRect, world_from_plane: &DMat4) -> DMat3 {
        let clip = self.clip_from(rect, world_from_plane);
        let column = |axis: DVec4| DVec3::new(axis.x, axis.y, axis.w);
        DMat3::from_cols(column(clip.x_axis), column(clip.z_axis), column(clip.w_axis))
    }

    /// Homography from (u, v, 1) in pixels of `rect` to (x, z, w) on a receiver; w is 1 / depth.
    ///
    /// Not finite for a camera whose centre lies in the receiver's plane, which sees it as a line.
    #[must_use]
    pub fn plane_from_region_px(&self, rect: &PixelRect, world_from_plane: &DMat4) -> DMat3 {
        let origin_px = rect.origin_px.as_dvec2();
        let region_px_from_image_px = DMat3::from_translation(-origin_px);
        (region_px_from_image_px * self.image_px_from_plane(world_from_plane)).inverse()
    }
}
