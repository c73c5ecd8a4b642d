//! Objects beside the toy, in the validity mask.

use glam::{DMat3, DVec3, DVec4, UVec2};
use reference::raster::Raster;
use reference::things::{
    BEFORE_TOY, COMPLETED_PLATE, HIDDEN_THING, PAINTED_THING, SHADED_PLATE, THING, Things, WRONG_PLATE, mark,
    plate_factors,
};

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::numbers;
use crate::scrambled::{buffers, views};

/// Blocks of each code, in a picture other than the region's.
fn things() -> Things {
    let codes = [
        0,
        THING,
        SHADED_PLATE,
        PAINTED_THING,
        BEFORE_TOY,
        WRONG_PLATE,
        HIDDEN_THING,
        COMPLETED_PLATE,
    ];
    Things {
        codes: Raster::from_fn(UVec2::new(97, 83), |at| {
            let light = u8::try_from(at.element_sum() % 251 + 2).unwrap();
            // Things have narrow gaps.
            let is_gap = at.x % 23 == 7;
            let code = if is_gap {
                0
            } else {
                codes[at.element_sum() as usize / 6 * 11 % 8]
            };
            [code, light, light / 2, 255 - light]
        }),
        // Not exact in binary, so that no position lies on the border of two pixels; behind its
        // camera on one side.
        codes_px_from_region_px: DMat3::from_cols(
            DVec3::new(0.803, 0.0511, -0.0113),
            DVec3::new(-0.0417, 0.7907, 0.00031),
            DVec3::new(3.317, 1.723, 0.8091),
        ),
    }
}

/// Largest factor of a plate: light of code 1.
const MOST: f64 = 255.0;

/// Errors of the marks that `source` makes, and of the plate's factors, relative to the largest one.
fn errors(source: &str) -> Errors {
    errors_before(source, false)
}

/// The same for a plate that is made soft afterwards, or for one that is not.
fn errors_before(source: &str, is_softened: bool) -> Errors {
    let (device, things) = (Device::shared(), things());
    let size = UVec2::new(123, 101);
    // Some pixels are marked already.
    let alpha = |at: UVec2| [1.0, 0.8, 0.6][(at.x / 5 + at.y / 3) as usize % 3];
    let numbers: Raster<DVec4> = numbers(size, 3);
    let validity = Raster::from_fn(size, |at| {
        let mut marks = numbers.at(at).truncate().round();
        // In a soft picture some of the toy's pixels count less.
        if at.x % 3 == 0 {
            marks.y *= 16.0 / 255.0;
        }
        marks.extend(alpha(at))
    });
    let columns = [0, 1, 2].map(|index| things.codes_px_from_region_px.as_mat3().col(index).extend(0.0));
    let of_codes = |codes: [u8; 4]| DVec4::from_array(codes.map(|code| f64::from(code) / 255.0));
    let maps = [device.map(&things.codes.map(of_codes)), device.map(&validity)];
    let view = device.uniform(&columns.map(|column| column.to_array()));
    let mut own = buffers(0, std::slice::from_ref(&view));
    own.extend(views(1, &maps));
    let marked = device.draw(Draw::of(source, "fs_mark", size), [&[], &own]);
    let expected = Raster::from_fn(size, |texel| mark(&things, &validity, texel));
    // The plate's part reads no validity.
    own.truncate(2);
    let factors = device.draw(Draw::of(source, "fs_correct_plate", size), [&[], &own]);
    let expected_factors = Raster::from_fn(size, |texel| {
        let factors = plate_factors(&things, texel);
        // Softening weighs colours by their alpha, as if they were multiplied by it.
        let weight = if is_softened && factors.w > 0.0 {
            factors.w
        } else {
            1.0
        };
        (weight * factors.truncate()).extend(factors.w) / MOST
    });
    let factors = factors.map(|factor| factor / MOST);
    let of_mask = pairs_of(&marked, &expected).into_iter();
    Errors::between(of_mask.chain(pairs_of(&factors, &expected_factors)))
}

#[test]
fn things_in_the_mask() {
    errors(&source("things")).check_all("things", 1e-6);
}

/// A llama's completed table was four times too bright: white, with an error of 11.78 in place of 1.19.
#[test]
fn a_completed_plate_that_is_made_soft() {
    let of_soft = source("things").replace("IS_SOFTENED: bool = false", "IS_SOFTENED: bool = true");
    errors_before(&of_soft, true).check_all("things", 1e-6);
}

#[test]
fn a_fault_in_marking_things_is_found() {
    let faults = [
        ("CODE_BEFORE_TOY: u32 = 2u", "CODE_BEFORE_TOY: u32 = 3u"),
        ("MIXED_PX: f32 = 2.0", "MIXED_PX: f32 = 1.0"),
        ("of_toy, clear, THING - less", "of_toy, marks.b, THING - less"),
        ("clear, BEFORE_TOY - less", "marks.r, BEFORE_TOY - less"),
        ("clear, BEFORE_TOY - less + above", "clear, BEFORE_TOY + above"),
        ("clear, BEFORE_TOY - less + above", "clear, BEFORE_TOY - less"),
        ("marks.b, BEFORE_TOY + above", "marks.b, BEFORE_TOY"),
        ("marks.b, THING + of_rim", "marks.b, THING"),
        ("select(0.0, above, marks.r == 1.0)", "above"),
        ("REACH_PX: i32 = 2", "REACH_PX: i32 = 1"),
        ("LEAST_PART: f32 = 0.3827", "LEAST_PART: f32 = 0.5"),
        ("select(0u, 1u, neighbor > 4u)", "0u"),
        ("!shows_thing(inner) || ", ""),
        ("min(within, beyond)", "beyond"),
        ("min(within, beyond)", "within"),
        ("|| shows_thing(code_at(beyond))", ""),
        (
            "select(rim_code(position.xy), vec2u(0u), is_second)",
            "rim_code(position.xy)",
        ),
        ("floor(at.xy / at.z)", "round(at.xy / at.z)"),
        ("of_toy = 0.0", "of_toy = 1.0"),
        ("of_toy > 0.0", "of_toy == 1.0"),
        ("return vec4f(mark.gba, 1.0)", "return vec4f(1.0)"),
        ("1.0 / max(mark.gba", "max(mark.gba"),
        ("MOST_PAINTED * mark.gba * mark.gba", "MOST_PAINTED * mark.gba"),
        ("MOST_PAINTED: f32 = 16.0", "MOST_PAINTED: f32 = 15.0"),
        (
            "weight * MOST_COMPLETED * mark.gba * mark.gba, ESTIMATED",
            "weight * MOST_COMPLETED * mark.gba * mark.gba, 1.0",
        ),
        ("MOST_COMPLETED: f32 = 64.0", "MOST_COMPLETED: f32 = 63.0"),
        ("IS_SOFTENED: bool = false", "IS_SOFTENED: bool = true"),
        (" || code == CODE_PAINTED_THING", ""),
    ];
    check_faults("things", &faults, 1e-6, errors);
}
