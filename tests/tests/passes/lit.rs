//! `lit` on scrambled inputs, with and without previous sums.

use glam::{DVec4, UVec2};
use reference::grid::{Taken, accumulate};
use reference::lit::pool;

use app_core::wgpu;
use app_pipeline::model::state::grids::MAX_CELLS;

use crate::alone::{check_faults, source};
use crate::device::Device;
use crate::errors::Errors;
use crate::numbers::number;
use crate::scrambled::{N_CELLS, Scrambled, buffers, views};

/// Cells of the largest grid, in workgroups of 8 x 8.
const WORKGROUPS: [u32; 3] = [8, 8, 2];

/// Limit for rounding.
const ALLOWED: f64 = 1e-5;

/// Sums of values times certainties, and of certainties: zero for some cells, and for some more
/// than is kept.
fn kept_before() -> Vec<[f32; 4]> {
    let cell = |k: u32| {
        let at = UVec2::new(k % 64, k / 64);
        let certainty = (12.0 * number(at, 70) - 3.0).max(0.0);
        let value = [71, 72, 73].map(|seed| number(at, seed));
        let sum = DVec4::from([value[0], value[1], value[2], 1.0]) * certainty;
        sum.as_vec4().to_array()
    };
    (0..u32::try_from(N_CELLS).unwrap()).map(cell).collect()
}

/// Errors of the cells and sums that `source` makes, for all points and for two quarters.
fn errors(source: &str) -> Errors {
    let taken = [Taken::All, Taken::Quarter(1, 0), Taken::Quarter(0, 1)];
    Errors::between(
        taken
            .map(|taken| pairs(source, (&Scrambled::new(), taken)))
            .concat(),
    )
}

/// The same for all points of a glossy table.
fn errors_of_glossy(source: &str) -> Errors {
    Errors::between(pairs(source, (&Scrambled::reflecting(), Taken::All)))
}

/// The shader's form of the sampled points: the step from one to the next, then the first.
fn step(taken: Taken) -> [u32; 4] {
    match taken {
        Taken::All => [1, 0, 0, 0],
        Taken::Quarter(column, row) => [2, 0, column, row],
    }
}

/// Actual and expected cells and sums.
fn pairs(source: &str, (scene, taken): (&Scrambled, Taken)) -> Vec<(f64, f64)> {
    let device = Device::shared();
    let kept_before = kept_before();
    let pools = [
        device.uniform(&scene.grids()),
        device.storage(bytemuck::cast_slice(&vec![[f32::NAN; 4]; N_CELLS])),
        device.storage(bytemuck::cast_slice(&kept_before)),
        device.uniform(&step(taken)),
    ];
    let maps = [
        device.map(&scene.validity),
        device.map(&scene.visibility),
        device.filterable(&scene.ambient),
    ];
    let linear = device.linear_sampler();
    let mut own = buffers(0, &pools);
    own.extend(views(4, &maps));
    own.push((7, wgpu::BindingResource::Sampler(&linear)));
    let seen = scene.seen(device);
    device.compute(source, "cs_pool", [&seen.bindings(), &own], WORKGROUPS);
    let [cells, accumulated] = [1, 2].map(|k: usize| device.read(&pools[k]));

    let pictures = scene.pictures(2);
    let mut pairs = Vec::new();
    for (receiver, grid) in scene.plane_grids().iter().enumerate() {
        let fresh = pool(&scene.region, &pictures, &scene.solution, (receiver, grid, taken));
        let n_some = fresh.texels().iter().filter(|cell| cell.certainty > 0.0).count();
        assert!(
            n_some > 30 && n_some < fresh.texels().len(),
            "{n_some} cells are seen"
        );
        let first = scene.grids().grids[receiver].first_cell as usize;
        for (k, fresh) in fresh.texels().iter().enumerate() {
            let slot = receiver * MAX_CELLS + k;
            let before = DVec4::from(kept_before[slot].map(f64::from));
            let (cell, sums) = accumulate(before, *fresh);
            let expected = (cell.value * cell.certainty).extend(cell.certainty);
            for channel in 0..4 {
                pairs.push((f64::from(cells[first + k][channel]), expected[channel]));
                pairs.push((f64::from(accumulated[slot][channel]), sums[channel]));
            }
        }
    }
    pairs
}

#[test]
fn lit_colours_are_pooled_onto_what_was_known() {
    // A cell's point within rounding of a border between pixels may take the other pixel, whose
    // numbers differ. Measured: none does, and 1e-6 for values up to 8.
    errors(&source("lit")).check("lit cells and sums", (ALLOWED, 0.01), 4.0);
}

#[test]
fn a_fault_in_the_pooling_is_found() {
    let faults = [
        ("LIT_POWER: f32 = 8.0", "LIT_POWER: f32 = 7.0"),
        ("(texel)).b;", "(texel)).r;"),
        ("(fit.gain.rgb * model)", "model"),
        ("= smallest(", "= largest("),
        ("FULL_SHARE: f32 = 0.25", "FULL_SHARE: f32 = 0.24"),
        ("MAX_FRAMES: f32 = 8.0", "MAX_FRAMES: f32 = 7.0"),
        (".a, 1.0)", ".a, 2.0)"),
        ("= taken.first +", "="),
        ("+ 0.5) / globals", ") / globals"),
        (") != receiver_of(", ") + 9u == receiver_of("),
    ];
    check_faults("lit", &faults, ALLOWED, errors);
}

/// No light is negative where the surroundings seem brighter than a cell's mean.
#[test]
fn lit_colours_of_a_glossy_table() {
    errors_of_glossy(&source("lit")).check("glossy lit cells", (ALLOWED, 0.01), 4.0);
    let faults = [
        ("max(sum.rgb / sum.a, vec3f(0.0))", "sum.rgb / sum.a"),
        ("* reflected(here, v)", "* reflected(here, vec4f(1.0))"),
    ];
    check_faults("lit", &faults, ALLOWED, errors_of_glossy);
}
