//! Inputs for the capture passes with every combination of cases in neighbouring pixels: visible or
//! hidden, lit or unlit, photographed or estimated.

use app_core::reflection::Reflection;
use app_core::scene::{MAX_LIGHTS, MAX_RECEIVERS};
use app_core::wgpu;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::model::state::grids::{Grid, Grids, MAX_CELLS};
use app_pipeline::model::state::solution::{Fit, N_COLUMNS, ReceiverFit};
use app_pipeline::passes::globals::Globals;
use glam::{DVec3, DVec4, UVec2};
use reference::grid::PlaneGrid;
use reference::model::{Pictures, Region, Solution};
use reference::raster::Raster;

use crate::alone::Bindings;
use crate::device::Device;
use crate::numbers::{number, numbers};
use crate::photo::truth;
use crate::run::known_reflection;
use crate::setups::WALL;
use crate::stand::Stand;

/// Pixels of the region per texel of the ambient map.
const AMBIENT_DIVISOR: u32 = 5;

/// A work region within the picture of a table and a wall under two lights.
pub(crate) struct Scrambled {
    pub(crate) stand: Stand,
    pub(crate) rect: PixelRect,
    pub(crate) region: Region,
    pub(crate) solution: Solution,
    /// Its part of the camera's picture.
    pub(crate) image: Raster<DVec4>,
    /// Colours; alpha is 1, a quarter, or 0.
    pub(crate) plate: Raster<DVec4>,
    /// Each 0 or 1.
    pub(crate) validity: Raster<DVec4>,
    pub(crate) visibility: Raster<DVec4>,
    /// Values in steps of 1/256.
    pub(crate) ambient: Raster<u8>,
    /// How the table reflects; `None` if it is matt.
    reflection: Option<Reflection>,
}

impl Scrambled {
    pub(crate) fn new() -> Self {
        let stand = Stand::new(WALL.of_size(173, 131));
        let rect = PixelRect {
            origin_px: UVec2::new(21, 10),
            size_px: UVec2::new(123, 101),
        };
        let size = rect.size_px;
        let mut solution = truth(2);
        solution.intensities = vec![DVec3::new(0.7, 0.8, 0.6), DVec3::new(1.2, 1.1, 1.3)];
        // A channel may have no light at all.
        solution.receivers[1].bounce.z = 0.0;
        // A surface that faces straight down is black where no light falls on it.
        solution.toy[1] = DVec3::ZERO;
        let one_in = |n: u32, seed: u32| move |at: UVec2| number(at, seed) * f64::from(n) < 1.0;
        Self {
            region: stand.region(&rect),
            image: numbers(size, 1),
            plate: Raster::from_fn(size, |at| {
                let alpha = [1.0, 0.25, 1.0, 0.0][(at.x / 3 + at.y / 7) as usize % 4];
                // Much of it is as dark as unusable pixels.
                let color = DVec3::from([40, 41, 42].map(|seed| number(at, seed).powi(3)));
                color.as_vec3().as_dvec3().extend(alpha)
            }),
            validity: numbers(size, 3).map(|texel| texel.map(f64::round)),
            visibility: Raster::from_fn(size, |at| {
                if one_in(3, 50)(at) {
                    DVec4::ZERO
                } else {
                    DVec4::from([51, 52, 53, 54].map(|seed| number(at, seed)))
                }
            }),
            ambient: Raster::from_fn(size / AMBIENT_DIVISOR, |at| {
                // Dark blocks, whose insides are dark after filtering, too.
                let is_dark = number(at / 4, 60) < 0.3;
                let numbers = [0, 31, 64, 128, 200, 255];
                if is_dark {
                    0
                } else {
                    numbers[(at.x * 5 + at.y * 3) as usize % 6]
                }
            }),
            stand,
            rect,
            solution,
            reflection: None,
        }
    }

    /// The same over a glossy table, whose surroundings are brighter than many a pixel.
    pub(crate) fn reflecting() -> Self {
        let reflection = Reflection {
            roughness: 0.15,
            surroundings: [6.0, 2.0, 12.0],
            toy_above_surroundings: [-3.0, 1.0, -8.0],
        };
        let matt = Self::new();
        Self {
            region: Region {
                reflection: Some(known_reflection(&matt.stand, &reflection)),
                ..matt.region
            },
            reflection: Some(reflection),
            ..matt
        }
    }

    /// The inputs of the references; `seen` is a channel of the evidence.
    pub(crate) fn pictures(&self, seen: usize) -> Pictures {
        Pictures {
            frame: self.image.map(DVec4::truncate),
            plate: self.plate.map(DVec4::truncate),
            seen: self.validity.map(|texel| texel[seen]),
            visibility: self.visibility.clone(),
            ambient: self.ambient.map(|code| f64::from(code) / 256.0),
        }
    }

    /// Globals and fit, the resources of group 0.
    pub(crate) fn shared(&self, device: &Device) -> [wgpu::Buffer; 2] {
        let fit = device.storage(bytemuck::bytes_of(&fit(&self.solution)));
        [device.uniform(&self.globals()), fit]
    }

    pub(crate) fn globals(&self) -> Globals {
        let channel = self.stand.setup.lights.len();
        let reflection = self.reflection.as_ref().map(|known| (known, channel));
        self.stand.globals(&self.rect).with_reflection(reflection)
    }

    /// The camera's picture, the rest of group 0 for passes that read it.
    pub(crate) fn seen(&self, device: &Device) -> Seen {
        let whole = Raster::from_fn(self.stand.setup.image_px, |at| {
            let is_in = at.cmpge(self.rect.origin_px) & at.cmplt(self.rect.origin_px + self.rect.size_px);
            if is_in.all() {
                self.image.at(at - self.rect.origin_px)
            } else {
                DVec4::NAN
            }
        });
        let [globals, fit] = self.shared(device);
        // A picture has no encoding.
        Seen {
            buffers: [globals, fit, device.uniform(&[0.0_f32; 16])],
            frame: device.map(&whole),
        }
    }

    /// Grids that do not quite contain the receivers, and do not start at the first cell.
    pub(crate) fn grids(&self) -> Grids {
        let mut grids = Grids::default();
        grids.grids[0] = Grid {
            origin_in_plane: [-0.21, -0.17],
            cell_m: 0.019,
            first_cell: 3,
            size: [23, 18],
            ..Grid::default()
        };
        grids.grids[1] = Grid {
            origin_in_plane: [-0.12, -0.08],
            cell_m: 0.011,
            first_cell: 3 + 23 * 18 + 7,
            size: [21, 14],
            ..Grid::default()
        };
        grids
    }

    /// The grids in the references' form.
    pub(crate) fn plane_grids(&self) -> [PlaneGrid; 2] {
        let grids = self.grids().grids;
        [PlaneGrid::from(&grids[0]), PlaneGrid::from(&grids[1])]
    }
}

/// Globals, fit, and the camera's picture.
pub(crate) struct Seen {
    buffers: [wgpu::Buffer; 3],
    frame: wgpu::TextureView,
}

impl Seen {
    pub(crate) fn bindings(&self) -> Bindings<'_> {
        let mut bindings = buffers(0, &self.buffers);
        let frame = || wgpu::BindingResource::TextureView(&self.frame);
        bindings.extend([(3, frame()), (4, frame())]);
        bindings
    }
}

/// Maximum number of cells of all grids.
pub(crate) const N_CELLS: usize = MAX_RECEIVERS * MAX_CELLS;

/// The references' solution, in the device's form.
fn fit(solution: &Solution) -> Fit {
    let color = |value: &DVec3| value.as_vec3().extend(1.0).to_array();
    let mut fit: Fit = bytemuck::Zeroable::zeroed();
    fit.gain = color(&solution.gain);
    let slots = fit.intensity.iter_mut().zip(&solution.intensities);
    slots.for_each(|(slot, intensity)| *slot = color(intensity));
    for (slot, receiver) in fit.receivers.iter_mut().zip(&solution.receivers) {
        let mut direct_fraction = [[0.0; 4]; MAX_LIGHTS];
        let slots = direct_fraction.iter_mut().zip(&receiver.direct_fractions);
        slots.for_each(|(slot, direct_fraction)| *slot = color(direct_fraction));
        *slot = ReceiverFit {
            bounce: color(&receiver.bounce),
            direct_fraction,
            clipped: color(&receiver.clipped),
        };
    }
    let toy: &mut [[f32; 4]; N_COLUMNS] = &mut fit.toy;
    let slots = toy.iter_mut().zip(&solution.toy);
    slots.for_each(|(slot, light)| *slot = color(light));
    fit
}

/// Buffers, bound from a number on, in order.
pub(crate) fn buffers(first: u32, buffers: &[wgpu::Buffer]) -> Bindings<'_> {
    (first..)
        .zip(buffers.iter().map(wgpu::Buffer::as_entire_binding))
        .collect()
}

/// Texture views, bound from a number on, in order.
pub(crate) fn views(first: u32, views: &[wgpu::TextureView]) -> Bindings<'_> {
    (first..)
        .zip(views.iter().map(wgpu::BindingResource::TextureView))
        .collect()
}
