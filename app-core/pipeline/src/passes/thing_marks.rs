//! Marks of objects on the device: codes of the picture in which they were detected, and the
//! positions of that picture's pixels in a view.

use app_scene::things::{
    HEIGHT_STEP_M, MOST_COMPLETED, MOST_PAINTED, Mark, RaisedPoint, Things as GivenThings,
};
use bytemuck::Zeroable;
use glam::{DMat3, DMat4};
use wgpu::TextureFormat;

use crate::geometry::rect::PixelRect;
use crate::geometry::view::View;
use crate::gpu::{Buffer, Gpu, Mat3Columns, Mirrors, Resource, Texture, mirrors, shared_struct};

/// The marks, as shaders read them.
pub(crate) const THING_MARKS: Mirrors = mirrors!(
    "common/thing_marks",
    structs: [ThingsView],
    constants: [
        CODE_THING, CODE_BEFORE_TOY, CODE_WRONG_PLATE, CODE_SHADED_PLATE, CODE_HIDDEN_THING,
        CODE_PAINTED_THING, CODE_COMPLETED_PLATE, MOST_PAINTED, MOST_COMPLETED, HEIGHT_STEP_M,
    ]
);

pub(crate) const CODE_THING: u32 = 1;
pub(crate) const CODE_BEFORE_TOY: u32 = 2;
pub(crate) const CODE_WRONG_PLATE: u32 = 3;
pub(crate) const CODE_SHADED_PLATE: u32 = 4;
pub(crate) const CODE_HIDDEN_THING: u32 = 5;
pub(crate) const CODE_PAINTED_THING: u32 = 6;
pub(crate) const CODE_COMPLETED_PLATE: u32 = 7;

shared_struct! {
    /// Positions of the marks' pixels in the region.
    pub(crate) struct ThingsView {
        pub marks_px_from_region_px: Mat3Columns,
    }
}

/// Objects on the device.
pub(crate) struct Things {
    given: GivenThings,
    is_plate_wrong: bool,
    codes: Texture,
    view: Buffer,
}

impl Things {
    pub(crate) fn new(gpu: &Gpu, given: &GivenThings) -> Self {
        // Light and height are needed for some marks alone.
        let (format, n_channels) = if given.has_light() || given.has_raised() {
            (TextureFormat::Rgba8Unorm, 4)
        } else {
            (TextureFormat::R8Unorm, 1)
        };
        let codes = Texture::plane(gpu, "things", given.size_px(), format);
        let marks = given.marks().iter().enumerate();
        let texels: Vec<u8> = marks
            .flat_map(|(index, mark)| texel(*mark, given.raised(index)).into_iter().take(n_channels))
            .collect();
        codes.write(gpu, &texels);
        Self {
            is_plate_wrong: given.has_light() || given.count(Mark::WrongPlate) > 0,
            given: given.clone(),
            codes,
            view: gpu.uniform("things view", &ThingsView::zeroed()),
        }
    }

    /// The objects from which they were created.
    pub(crate) fn given(&self) -> &GivenThings {
        &self.given
    }

    /// Whether a part of the plate is wrong, or in another light than it should be.
    pub(crate) fn is_plate_wrong(&self) -> bool {
        self.is_plate_wrong
    }

    /// Whether shadows fall on them.
    pub(crate) fn has_raised(&self) -> bool {
        self.given.has_raised()
    }

    /// Adapts to a camera's view and a region of it. The objects are assumed to lie in the plane of
    /// the first receiver.
    pub(crate) fn follow(&self, gpu: &Gpu, view: &View, region: &PixelRect, world_from_plane: &DMat4) {
        let image_px_from_region_px = DMat3::from_translation(region.origin_px.as_dvec2());
        let own = View::new(self.given.size_px(), self.given.camera());
        let matrix = if own == *view {
            image_px_from_region_px
        } else {
            own.image_px_from_plane(world_from_plane) * view.plane_from_region_px(region, world_from_plane)
        };
        let columns = [0, 1, 2].map(|index| matrix.as_mat3().col(index).extend(0.0).to_array());
        gpu.write(
            &self.view,
            &[ThingsView {
                marks_px_from_region_px: columns,
            }],
        );
    }

    /// For a pass.
    pub(crate) fn resources(&self) -> [Resource<'_>; 2] {
        [(&self.view).into(), (&self.codes.view).into()]
    }
}

/// A mark's code and light, or the height of a thing's point and the lights' share there.
#[allow(clippy::cast_possible_truncation, reason = "codes below 8")]
fn texel(mark: Mark, raised: RaisedPoint) -> [u8; 4] {
    let [high, low] = raised.height().to_be_bytes();
    let of_thing = [high, low, raised.of_lights()];
    let (code, [red, green, blue]) = match mark {
        Mark::None => (0, [0; 3]),
        Mark::Thing => (CODE_THING, of_thing),
        Mark::BeforeToy => (CODE_BEFORE_TOY, of_thing),
        Mark::WrongPlate => (CODE_WRONG_PLATE, [0; 3]),
        Mark::CompletedPlate { light } => (CODE_COMPLETED_PLATE, light),
        Mark::ShadedPlate { left } => (CODE_SHADED_PLATE, left),
        Mark::HiddenThing { light } => (CODE_HIDDEN_THING, light),
        Mark::PaintedThing { light } => (CODE_PAINTED_THING, light),
    };
    [code as u8, red, green, blue]
}
