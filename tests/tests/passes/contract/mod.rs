//! The contract between host and shaders, read from the shaders themselves, and proof that its checks can fail.

mod backends;
mod check;
mod fragment;

use std::fs;
use std::path::Path;

use app_core::gloss::Gloss;
use app_core::preset::BALANCED;
use app_core::sharpness::Sharpness;
use app_pipeline::geometry::rect::{PixelRect, PlaneRect};
use app_pipeline::gpu::context::phone_limits;
use app_pipeline::gpu::shader::Shader;
use app_pipeline::model::plan::Plan;
use app_pipeline::model::state::grids::{MAX_CELLS, grids_over};
use app_pipeline::model::state::solution::N_COLUMNS;
use app_pipeline::plan::SceneFacts;
use app_pipeline::{mirrors, shaders};
use glam::{DVec2, UVec2};
use harness::shader_text::without_comments;
use naga::Module;
use naga::valid::Capabilities;

use check::{array_length, constant, parse, problems, validate};

fn shader(name: &str) -> &'static Shader {
    shaders().find(|shader| shader.name == name).unwrap()
}

fn module(name: &str) -> Module {
    parse(&shader(name).source()).unwrap()
}

/// A whole number.
fn number(module: &Module, name: &str) -> u32 {
    let value = constant(module, name).unwrap_or_else(|| panic!("there is no constant {name}"));
    format!("{value}").parse().unwrap()
}

#[test]
fn every_shader_keeps_the_contract() {
    let wrong: Vec<String> = shaders()
        .flat_map(|shader| {
            let problems = problems(&shader.source(), &mirrors(shader));
            problems
                .into_iter()
                .map(|problem| format!("{}: {problem}", shader.name))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Each part is included once, after its own imports, and every part has a file.
#[test]
fn shaders_import_parts_that_exist() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shaders");
    for shader in shaders() {
        let imports = shader.imports();
        for (index, path) in imports.iter().enumerate() {
            let text = fs::read_to_string(folder.join(format!("{path}.wgsl"))).expect(path);
            assert_eq!(
                shader.source().matches(&without_comments(&text)).count(),
                1,
                "{}: {path}",
                shader.name
            );
            let needed = text.lines().filter_map(|line| line.strip_prefix("//#import "));
            for needed in needed {
                assert!(
                    imports[..index].contains(&needed),
                    "{}: {path} needs {needed}",
                    shader.name
                );
            }
        }
    }
}

#[test]
fn the_limits_are_those_of_a_phone() {
    let limits = phone_limits();
    let asked = [
        limits.max_bind_groups,
        limits.max_storage_buffers_per_shader_stage,
        limits.max_storage_textures_per_shader_stage,
        limits.max_sampled_textures_per_shader_stage,
        limits.max_color_attachments,
        limits.max_color_attachment_bytes_per_sample,
        limits.max_compute_invocations_per_workgroup,
    ];
    assert_eq!(asked, [4, 4, 4, 16, 4, 32, 256]);
    assert!(limits.max_compute_workgroup_storage_size <= 16 << 10);
}

#[test]
fn the_sums_of_the_fit_have_room() {
    let n = u32::try_from(N_COLUMNS).unwrap();
    // The sums of the normal equations, and that of clipped pixels.
    let n_sums = n * (n + 1) / 2 + n + 1;
    let (fit, solve) = (module("fit"), module("fit_solve"));
    assert_eq!([number(&fit, "N_SUMS"), number(&solve, "N_SUMS")], [n_sums; 2]);
    assert_eq!(array_length(&solve, "sums"), Some(3 * n_sums));
    assert_eq!(array_length(&solve, "matrix"), Some(n * n));
    assert!(
        solve.entry_points[0].workgroup_size[0] >= 3 * n_sums,
        "a lane for each sum"
    );

    let (workgroup, part) = (number(&fit, "WORKGROUP"), number(&fit, "N_PART"));
    assert_eq!(fit.entry_points[0].workgroup_size, [workgroup, 1, 1]);
    assert_eq!(array_length(&fit, "partial"), Some(workgroup * part));
    let strided = number(&fit, "N_STRIDED");
    assert_eq!(array_length(&fit, "strided"), Some(strided * part));
    assert_eq!(workgroup % strided, 0, "as many in each strided sum");
    assert!(strided * part <= workgroup, "a lane for each");
    assert_eq!(n_sums % part, 0, "whole parts");
    // One pixel more than sixteen for each invocation of a workgroup requires a second one.
    let full = 16 * workgroup;
    assert_eq!(
        [plan(full, 1), plan(full + 1, 1)].map(|plan| plan.n_fit_rows(plan.fit_stride_px)),
        [1, 2]
    );
}

#[test]
fn the_levels_of_the_fill_reach_one_cell() {
    let fill = module("fill");
    let square = PlaneRect {
        min: DVec2::splat(-0.4),
        max: DVec2::splat(0.4),
    };
    let [width, height] = grids_over(&[square]).grids[0].size;
    assert!(width.max(height) > 32 && width.max(height) <= 1 << (number(&fill, "N_LEVELS") - 1));
    assert_eq!(
        (width * height) as usize,
        MAX_CELLS,
        "the sums of the largest grid have room"
    );
    assert_eq!(
        fill.entry_points[0].workgroup_size,
        [number(&fill, "WORKGROUP"), 1, 1]
    );
}

fn plan(width_px: u32, height_px: u32) -> Plan {
    let region = PixelRect {
        origin_px: UVec2::ZERO,
        size_px: UVec2::new(width_px, height_px),
    };
    Plan::new(
        &SceneFacts {
            has_things: false,
            has_raised_things: false,
            things_fronts: Vec::new(),
            sharpness: Sharpness::SHARP,
            is_softened: false,
            gloss: Gloss::NONE,
            angular_radii_rad: vec![0.0],
            reflection: None,
            region,
            physical_toy: Some(region),
            toy_box: Some(region),
            physical_box: Some(region),
            pixel_in_object: 0.0,
            penumbrae_px: vec![0.0],
            n_receivers: 1,
            is_plate_complete: true,
            are_plates_scaled: false,
        },
        &BALANCED,
    )
}

/// Each fault in a shader must be found, with a message that names it.
#[test]
fn faults_in_a_shader_are_found() {
    // Columns: shader, a text in it, the replacement, a part of the expected message.
    #[rustfmt::skip] // Each case has a line of its own.
    let faults = [
        ("composite", "bounce", "rebound", ["Fit", "rebound"]),
        ("residual", "size: vec2u,\n  _pad: vec2u,", "_pad: vec2u,\n  size: vec2u,", ["Grid", "size"]),
        ("residual", "_pad: vec2u", "normal_offset: vec2u", ["Grid", "normal_offset"]),
        ("residual", "_pad: vec2u", "_pad: vec2f", ["Grid", "_pad"]),
        ("present", "origin_px: vec2u,", "origin_px: vec2u,\n  more: u32,", ["Placement", "bytes"]),
        ("occlusion", "array<vec4f, 256>", "array<vec4f, 128>", ["LightPoints", "bytes"]),
        ("composite", "MAX_LIGHTS: u32 = 4u", "MAX_LIGHTS: u32 = 5u", ["MAX_LIGHTS", "5"]),
        ("fit_solve", "PRIOR_BOUNCE: f32 = 0.27", "PRIOR_BOUNCE: f32 = 0.28", ["PRIOR_BOUNCE", "0.28"]),
        ("residual", "Grids", "AllGrids", ["Grids", "the shader has none"]),
        ("residual", "fn cs_pool", "fn pool", ["pool", "cs_…"]),
        ("residual", "@workgroup_size(8, 8)", "@workgroup_size(16, 17)", ["272", "invocations"]),
        ("fit", "N_PARTIAL: u32 = 1792u", "N_PARTIAL: u32 = 5000u", ["20448", "workgroup memory"]),
        ("present", "@group(1)", "@group(4)", ["5", "bind groups"]),
        ("residual", "var sums = Sums", "var sums: vec2f = Sums", ["does not parse", "sums"]),
    ];
    for (name, from, to, words) in faults {
        let shader = shader(name);
        let sound = shader.source();
        let faulty = sound.replace(from, to);
        assert_ne!(faulty, sound, "{name} has no \"{from}\"");
        assert_found(&problems(&faulty, &mirrors(shader)), &words, to);
    }
}

#[test]
fn faults_in_bindings_are_found() {
    let buffers = |n: u32| {
        let declared: String = (0..n)
            .map(|k| format!("@group(0) @binding({k}) var<storage, read> b{k}: array<f32>;\n"))
            .collect();
        let used: Vec<String> = (0..n).map(|k| format!("b{k}[0]")).collect();
        let sum = used.join(" + ");
        format!("{declared}@fragment fn fs_sum() -> @location(0) vec4f {{ return vec4f({sum}); }}")
    };
    assert_eq!(problems(&buffers(4), &[]), Vec::<String>::new());
    assert_found(
        &problems(&buffers(5), &[]),
        &["5", "storage buffers"],
        "five buffers",
    );

    let unknown = "struct Extra { a: f32 }\n@group(0) @binding(0) var<uniform> extra: array<Extra, 4>;";
    let aligned = unknown.replace("a: f32", "@align(16) a: f32");
    assert_found(
        &problems(&aligned, &[]),
        &["Extra", "mirror"],
        "a struct that the host lacks",
    );
}

#[test]
fn structs_in_fragment_shaders_are_found() {
    let shader = |body: &str| {
        format!(
            "struct Pair {{ a: f32, b: f32 }}\n\
             struct In {{ @builtin(position) at: vec4f }}\n\
             fn pair(a: f32) -> Pair {{ return Pair(a, a); }}\n\
             fn sum(a: f32) -> f32 {{ {body} }}\n\
             @fragment fn fs_sum(@builtin(position) at: vec4f) -> @location(0) vec4f {{ return vec4f(sum(at.x)); }}"
        )
    };
    assert_eq!(problems(&shader("return a;"), &[]), Vec::<String>::new());
    let values = [
        "return pair(a).b;",
        "return Pair(a, a).b;",
        "let p = Pair(); return p.a;",
    ];
    for body in values {
        assert_found(&problems(&shader(body), &[]), &["a struct as a value"], body);
    }
    for body in [
        "var p: Pair; return p.a;",
        "var p: array<Pair, 2>; return p[1].a;",
    ] {
        assert_found(
            &problems(&shader(body), &[]),
            &["sum: a struct as a variable"],
            body,
        );
    }
    let input = shader("return a;")
        .replace("(@builtin(position) at: vec4f)", "(in: In)")
        .replace("at.x", "in.at.x");
    assert_found(
        &problems(&input, &[]),
        &["fs_sum: a struct as a variable"],
        "an input",
    );
}

#[test]
fn what_the_device_was_not_asked_for_is_found() {
    let half = "enable f16;\n@fragment fn fs_half(@builtin(position) at: vec4f) -> @location(0) vec4f {\n\
        let half_at = vec4h(at);\n  return vec4f(half_at + half_at);\n}";
    assert_found(&problems(half, &[]), &["not valid for the device"], "f16");
    // Only the capability is missing.
    validate(&parse(half).unwrap(), Capabilities::all()).unwrap();
}

fn assert_found(problems: &[String], words: &[&str], fault: &str) {
    let text = problems.join("\n");
    for word in words {
        assert!(
            text.contains(word),
            "\"{fault}\" is not found, \"{word}\" is not in:\n{text}"
        );
    }
}
