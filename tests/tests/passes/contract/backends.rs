//! Every shader in the languages of phones' drivers, and its requirements.

use std::collections::BTreeSet;

use app_pipeline::gpu::shader::Shader;
use app_pipeline::shaders;
use naga::back::pipeline_constants::process_overrides;
use naga::back::{glsl, msl, spv};
use naga::proc::BoundsCheckPolicies;
use naga::valid::ModuleInfo;
use naga::{
    AddressSpace, Binding, BuiltIn, Expression, Function, ImageClass, ImageDimension, Module, ScalarKind,
    ShaderStage, Statement, TypeInner,
};

use crate::contract::check::{REQUESTED, parse, validate};

/// The document with the table of requirements, between two lines.
const DOCUMENT: &str = include_str!("../../../../app-core/doc/passes.md");
const BEGIN: &str = "<!-- needs: begin -->\n";
const END: &str = "<!-- needs: end -->";

/// One entry point in a language, or the reason why it cannot be translated.
fn translated(module: &Module, info: &ModuleInfo, entry: usize) -> [Result<(), String>; 3] {
    let point = &module.entry_points[entry];
    let (stage, name) = (point.stage, point.name.clone());
    let constants = naga::back::PipelineConstants::default();
    let (module, info) = process_overrides(module, info, Some((stage, &name)), &constants).unwrap();
    let to_msl = msl::write_string(
        &module,
        &info,
        // iOS 16.
        &msl::Options {
            lang_version: (3, 0),
            ..Default::default()
        },
        &msl::PipelineOptions::default(),
    );
    let to_msl = to_msl
        .map_err(|error| error.to_string())
        .and_then(|(_, written)| {
            let mut names = written.entry_point_names.into_iter();
            names.try_for_each(|name| name.map(|_| ()).map_err(|error| error.to_string()))
        });
    // Vulkan 1.0, which phones of 2016 have.
    let options = spv::Options {
        lang_version: (1, 0),
        ..Default::default()
    };
    let to_spv = spv::write_vec(&module, &info, &options, None);
    let options = glsl::Options {
        version: glsl::Version::new_gles(310),
        ..Default::default()
    };
    let of_pipeline = glsl::PipelineOptions {
        shader_stage: stage,
        entry_point: name,
        multiview: None,
    };
    let mut text = String::new();
    let bounds = BoundsCheckPolicies::default();
    let writer = glsl::Writer::new(&mut text, &module, &info, &options, &of_pipeline, bounds);
    let to_glsl = writer.and_then(|mut writer| writer.write());
    [
        to_msl,
        to_spv.map(|_| ()).map_err(|error| error.to_string()),
        to_glsl.map(|_| ()).map_err(|error| error.to_string()),
    ]
}

/// All parts that cannot be expressed in a language.
fn problems(name: &str, source: &str) -> Vec<String> {
    let module = parse(source).unwrap();
    let info = validate(&module, REQUESTED).unwrap();
    let mut problems = Vec::new();
    for (index, point) in module.entry_points.iter().enumerate() {
        let languages = ["MSL 3.0", "SPIR-V 1.0", "GLSL ES 3.10"];
        for (language, result) in languages.into_iter().zip(translated(&module, &info, index)) {
            if let Err(error) = result {
                problems.push(format!("{name}, {}, {language}: {error}", point.name));
            }
        }
    }
    problems
}

/// Those that naga cannot say in GLSL, which has no way to load a texel of a depth map. The core runs on Vulkan and Metal
/// alone: on OpenGL ES these would have to read another kind of texture.
const NOT_IN_GLSL: [&str; 8] = [
    "validity",
    "fit",
    "rim",
    "unmix",
    "gloss",
    "tint",
    "appearance",
    "toy",
];

#[test]
fn every_shader_can_be_said_in_the_languages_of_phones() {
    let of = |shader: &Shader| problems(shader.name, &shader.source());
    let (known, rest): (Vec<String>, Vec<String>) = shaders()
        .flat_map(of)
        .partition(|problem| problem.contains("GLSL ES 3.10") && problem.contains("from depth textures"));
    assert!(rest.is_empty(), "{}", rest.join("\n"));
    let mut passes: Vec<&str> = known
        .iter()
        .filter_map(|problem| problem.split(',').next())
        .collect();
    passes.dedup();
    assert_eq!(passes, NOT_IN_GLSL, "{}", known.join("\n"));
}

#[test]
fn a_planted_load_that_a_language_lacks_is_found() {
    let planted = "
        @group(0) @binding(0) var planted: texture_depth_2d;
        @fragment fn fs_planted(@builtin(position) at: vec4f) -> @location(0) vec4f {
            return vec4f(textureLoad(planted, vec2u(at.xy), 0));
        }";
    let problems = problems("planted", planted);
    assert!(
        problems.len() == 1 && problems[0].starts_with("planted, fs_planted, GLSL"),
        "{problems:?}"
    );
}

/// Features that a shader needs from a driver beyond drawing triangles with textures that are
/// loaded or filtered.
fn needs(shader: &Shader) -> BTreeSet<&'static str> {
    let module = parse(&shader.source()).unwrap();
    let info = validate(&module, REQUESTED).unwrap();
    let mut needs = BTreeSet::new();
    for (index, point) in module.entry_points.iter().enumerate() {
        let of_point = info.get_entry_point(index);
        if point.stage == ShaderStage::Compute {
            needs.insert("compute");
        }
        let of_result = point.function.result.as_ref();
        if of_result.is_some_and(|result| writes_depth(&module, result)) {
            needs.insert("depth written by the shader");
        }
        if kills(&module, &point.function) {
            needs.insert("discard");
        }
        for (handle, variable) in module.global_variables.iter() {
            if of_point[handle].is_empty() {
                continue;
            }
            if let AddressSpace::Storage { access } = variable.space {
                needs.insert(match (point.stage, access.contains(naga::StorageAccess::STORE)) {
                    (ShaderStage::Compute, _) => "storage buffers in compute",
                    (_, true) => "storage buffers written in draws",
                    (_, false) => "storage buffers read in draws",
                });
            }
            needs.extend(of_type(&module.types[variable.ty].inner));
        }
    }
    needs
}

fn of_type(of: &TypeInner) -> Option<&'static str> {
    match of {
        TypeInner::Sampler { comparison: true } => Some("depth comparison"),
        TypeInner::Image { arrayed: true, .. } => Some("texture arrays"),
        TypeInner::Image {
            class: ImageClass::Sampled { kind, .. },
            dim: ImageDimension::D2,
            ..
        } if *kind == ScalarKind::Uint => Some("textures of whole numbers"),
        TypeInner::Image {
            class: ImageClass::Depth { .. },
            ..
        } => Some("depth textures"),
        _ => None,
    }
}

fn writes_depth(module: &Module, result: &naga::FunctionResult) -> bool {
    let is_depth = |binding: Option<&Binding>| matches!(binding, Some(Binding::BuiltIn(BuiltIn::FragDepth)));
    let of_members = match &module.types[result.ty].inner {
        TypeInner::Struct { members, .. } => members.iter().any(|member| is_depth(member.binding.as_ref())),
        _ => false,
    };
    is_depth(result.binding.as_ref()) || of_members
}

/// Whether a function, or one that it calls, ends without a result.
fn kills(module: &Module, function: &Function) -> bool {
    let called = |expression: &Expression| match expression {
        Expression::CallResult(of) => kills(module, &module.functions[*of]),
        _ => false,
    };
    has_kill(module, &function.body)
        || function
            .expressions
            .iter()
            .any(|(_, expression)| called(expression))
}

fn has_kill(module: &Module, block: &naga::Block) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Kill => true,
        Statement::Block(block) => has_kill(module, block),
        Statement::If { accept, reject, .. } => has_kill(module, accept) || has_kill(module, reject),
        Statement::Switch { cases, .. } => cases.iter().any(|case| has_kill(module, &case.body)),
        Statement::Loop { body, continuing, .. } => has_kill(module, body) || has_kill(module, continuing),
        Statement::Call { function, .. } => has_kill(module, &module.functions[*function].body),
        _ => false,
    })
}

/// The table of the document: the requirements, and the passes that have them.
#[test]
fn the_document_says_what_each_pass_needs() {
    let all: Vec<(&str, BTreeSet<&str>)> = shaders().map(|shader| (shader.name, needs(shader))).collect();
    let kinds: BTreeSet<&str> = all.iter().flat_map(|(_, needs)| needs.iter().copied()).collect();
    let mut table = "| needed | by |\n| --- | --- |\n".to_owned();
    for kind in kinds {
        let by = all.iter().filter(|(_, needs)| needs.contains(kind));
        let by: Vec<String> = by.map(|(name, _)| format!("`{name}`")).collect();
        table.push_str(&format!("| {kind} | {} |\n", by.join(", ")));
    }
    let (_, rest) = DOCUMENT.split_once(BEGIN).unwrap();
    let (written, _) = rest.split_once(END).unwrap();
    assert_eq!(written, table, "in passes.md it has to be\n{table}");
}
