//! The people in a picture, as marks.

use glam::{DMat4, DVec3, UVec2};

use super::Stage;
use super::footprint::Footprint;
use crate::geometry::rect::PixelRect;
use crate::gpu::Gpu;
use crate::passes::thing_marks::Things;
use crate::preset::Settings;
use app_scene::frame::FrameInput;
use app_scene::people::{People, ToyInWorld};
use app_scene::scene::Camera;
use app_scene::things::{Mark, Things as GivenThings};
use app_scene::toy::PosedMesh;

/// The people in the latest picture.
#[derive(Default)]
pub(super) struct Crowd {
    /// The mask, its camera, the toy's place and the parts of the picture, from which the marks were made.
    of: Option<(People, Camera, DMat4, [PixelRect; 2])>,
    /// Corners of the physical toy in object space; empty until there is a mask.
    toy: Vec<DVec3>,
    /// `None` if nobody is near the toy.
    marks: Option<Things>,
}

impl Crowd {
    /// Marks of the people, if any are near the toy.
    pub(super) fn marks(&self) -> Option<&Things> {
        self.marks.as_ref()
    }
}

impl Stage {
    /// Sets the people in a picture. The baseline ignores them. Equal marks stay, so that nothing is
    /// learned again.
    pub(super) fn take_people(&mut self, gpu: &Gpu, input: &FrameInput, footprint: &Footprint) {
        let given = input.people.as_ref();
        let Some(people) = given.filter(|_| matches!(self.settings, Settings::Model(_))) else {
            (self.people.of, self.people.marks) = (None, None);
            return;
        };
        // What is learned and drawn so far may reach farther than this frame needs.
        let drawn = self.state.as_ref().map(|state| state.method.region());
        let parts = [footprint.region, drawn.unwrap_or(footprint.region)];
        let is_known = self
            .people
            .of
            .as_ref()
            .is_some_and(|(known, camera, toy, in_parts)| {
                let is_same_view = *camera == input.camera && *toy == input.world_from_object;
                known.is(people) && is_same_view && *in_parts == parts
            });
        if is_known {
            return;
        }
        self.people.of = Some((people.clone(), input.camera, input.world_from_object, parts));
        let marks = self.people_in(input, people);
        let size_px = self.size_px();
        let near = marks.filter(|marks| parts.iter().any(|part| is_in(marks, part, size_px)));
        let is_same = match (&self.people.marks, &near) {
            (None, None) => true,
            (Some(known), Some(near)) => known.given().is_like(near),
            _ => false,
        };
        if !is_same {
            self.people.marks = near.map(|near| Things::new(gpu, &near));
        }
    }

    fn people_in(&mut self, input: &FrameInput, people: &People) -> Option<GivenThings> {
        if self.people.toy.is_empty() {
            let mut posed = PosedMesh::default();
            let toy = &self.scene.toy;
            toy.pose(&self.scene.physical_pose, &DMat4::IDENTITY, &mut posed)
                .ok()?;
            self.people.toy = posed.points().collect();
        }
        let place = |point: &DVec3| input.world_from_object.transform_point3(*point);
        let positions: Vec<DVec3> = self.people.toy.iter().map(place).collect();
        let toy = ToyInWorld {
            positions: &positions,
            indices: self.scene.toy.indices(),
        };
        people.things(&input.camera, self.size_px(), &toy)
    }
}

/// Whether any marks are in a part of a picture.
fn is_in(marks: &GivenThings, part: &PixelRect, picture_px: UVec2) -> bool {
    let scale = marks.size_px().as_dvec2() / picture_px.as_dvec2();
    let low = (part.origin_px.as_dvec2() * scale).floor().as_uvec2();
    let high = (part.origin_px + part.size_px).as_dvec2() * scale;
    let high = high.ceil().as_uvec2().min(marks.size_px());
    let width = marks.size_px().x;
    (low.y..high.y).any(|y| {
        let row = (y * width + low.x) as usize..(y * width + high.x) as usize;
        let row = marks.marks().get(row).unwrap_or_default();
        row.iter().any(|mark| *mark != Mark::None)
    })
}
