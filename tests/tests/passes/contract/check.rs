//! The shaders' side of the contract: all requirements for one joined module, as a list of
//! violations.

use app_pipeline::gpu::context::phone_limits;
use app_pipeline::gpu::shader::Mirrors;
use app_pipeline::gpu::shared::{Member, Mirror, NumberKind};
use naga::valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator};
use naga::{
    AddressSpace, ArraySize, Expression, GlobalVariable, Handle, ImageClass, Literal, Module, ScalarKind,
    Type, TypeInner,
};

use crate::contract::fragment::struct_values;

/// Capabilities that a shader may use beyond plain WGSL: none.
///
/// wgpu derives naga's capabilities from the requested features and from the downlevel flags of the
/// adapter. The only requested feature is `TIMESTAMP_QUERY`, which adds none. The flags could add
/// multisampled shading, arrays of cube maps and half floats packed in floats if an adapter
/// supports them; no phone limit guarantees any of the three.
pub(crate) const REQUESTED: Capabilities = Capabilities::empty();

/// Parses a joined module.
pub(crate) fn parse(source: &str) -> Result<Module, String> {
    naga::front::wgsl::parse_str(source)
        .map_err(|error| format!("does not parse: {}", error.emit_to_string(source)))
}

/// Validates a module for a device with `capabilities`.
pub(crate) fn validate(module: &Module, capabilities: Capabilities) -> Result<ModuleInfo, String> {
    Validator::new(ValidationFlags::all(), capabilities)
        .validate(module)
        .map_err(|error| format!("is not valid for the device: {:?}", error.into_inner()))
}

/// Violations in `source`, of which the host shares `shared`, and which may contain a planted
/// fault.
pub(crate) fn problems(source: &str, shared: &[&Mirrors]) -> Vec<String> {
    let checked = parse(source).and_then(|module| Ok((validate(&module, REQUESTED)?, module)));
    let (info, module) = match checked {
        Ok(checked) => checked,
        Err(problem) => return vec![problem],
    };
    let mirrors: Vec<&Mirror> = shared.iter().flat_map(|shared| shared.structs).collect();
    let mut problems = struct_problems(&module, &mirrors);
    let constants = shared.iter().flat_map(|shared| shared.constants);
    problems.extend(constants.filter_map(|constant| constant_problem(&module, constant)));
    problems.extend(entry_point_problems(&module));
    problems.extend(struct_values(&module, &info));
    for (index, entry) in module.entry_points.iter().enumerate() {
        let counts = counts(&module, entry, info.get_entry_point(index));
        let too_many = counts.into_iter().filter(|(_, count, limit)| count > limit);
        problems.extend(
            too_many.map(|(what, count, limit)| format!("{}: {count} {what}, at most {limit}", entry.name)),
        );
    }
    problems
}

/// Value of a constant that is a plain number.
pub(crate) fn constant(module: &Module, name: &str) -> Option<f64> {
    let (_, constant) = module
        .constants
        .iter()
        .find(|(_, constant)| constant.name.as_deref() == Some(name))?;
    match module.global_expressions[constant.init] {
        Expression::Literal(Literal::U32(value)) => Some(f64::from(value)),
        Expression::Literal(Literal::I32(value)) => Some(f64::from(value)),
        Expression::Literal(Literal::F32(value)) => Some(f64::from(value)),
        _ => None,
    }
}

/// Number of elements of an array variable of the module.
pub(crate) fn array_length(module: &Module, name: &str) -> Option<u32> {
    let (_, global) = module
        .global_variables
        .iter()
        .find(|(_, global)| global.name.as_deref() == Some(name))?;
    match module.types[global.ty].inner {
        TypeInner::Array {
            size: ArraySize::Constant(n),
            ..
        } => Some(n.get()),
        _ => None,
    }
}

fn struct_problems(module: &Module, mirrors: &[&Mirror]) -> Vec<String> {
    let mut problems = Vec::new();
    for mirror in mirrors {
        let name = mirror.name;
        let of_that_name = |ty: &&Type| ty.name.as_deref() == Some(name);
        let ty = module.types.iter().map(|(_, ty)| ty).find(of_that_name);
        let Some(TypeInner::Struct { members, span }) = ty.map(|ty| &ty.inner) else {
            problems.push(format!("{name}: the host shares it, but the shader has none"));
            continue;
        };
        let shader: Vec<ShaderMember> = members
            .iter()
            .map(|member| shader_member(module, member))
            .collect();
        let host: Vec<ShaderMember> = mirror.members.iter().map(ShaderMember::from).collect();
        if shader != host {
            problems.push(format!("{name}: shader has {shader:#?}, host has {host:#?}"));
        }
        if *span as usize != mirror.size {
            problems.push(format!(
                "{name}: {span} bytes in the shader, {} on the host",
                mirror.size
            ));
        }
    }
    for name in shared_structs(module) {
        if !mirrors.iter().any(|mirror| mirror.name == name) {
            problems.push(format!(
                "{name}: bound to a buffer, but the host has no mirror of it"
            ));
        }
    }
    problems
}

/// Names of the structs in buffers: alone, in arrays, or within others.
fn shared_structs(module: &Module) -> Vec<String> {
    let is_buffer = |global: &&GlobalVariable| {
        matches!(global.space, AddressSpace::Uniform | AddressSpace::Storage { .. })
    };
    let globals = module.global_variables.iter().map(|(_, global)| global);
    let mut held: Vec<Handle<Type>> = globals.filter(is_buffer).map(|global| global.ty).collect();
    let mut names = Vec::new();
    while let Some(ty) = held.pop() {
        match &module.types[ty].inner {
            TypeInner::Array { base, .. } => held.push(*base),
            TypeInner::Struct { members, .. } => {
                held.extend(members.iter().map(|member| member.ty));
                names.push(module.types[ty].name.clone().unwrap_or_default());
            }
            _ => {}
        }
    }
    names
}

/// A member of a shared struct, as naga or as Rust lays it out.
#[derive(Debug, PartialEq)]
struct ShaderMember {
    name: String,
    offset: usize,
    size: usize,
    kind: Option<ScalarKind>,
}

impl From<&Member> for ShaderMember {
    fn from(member: &Member) -> Self {
        Self {
            name: member.name.to_owned(),
            offset: member.offset,
            size: member.size,
            kind: member.kind.map(|kind| match kind {
                NumberKind::Float => ScalarKind::Float,
                NumberKind::Signed => ScalarKind::Sint,
                NumberKind::Unsigned => ScalarKind::Uint,
            }),
        }
    }
}

fn shader_member(module: &Module, member: &naga::StructMember) -> ShaderMember {
    let mut inner = &module.types[member.ty].inner;
    let size = inner.size(module.to_ctx()) as usize;
    while let TypeInner::Array { base, .. } = inner {
        inner = &module.types[*base].inner;
    }
    let kind = match inner {
        TypeInner::Matrix { scalar, .. } => Some(scalar.kind),
        other => other.scalar_kind(),
    };
    ShaderMember {
        name: member.name.clone().unwrap_or_default(),
        offset: member.offset as usize,
        size,
        kind,
    }
}

fn constant_problem(module: &Module, (name, host): &(&'static str, f64)) -> Option<String> {
    let shader = constant(module, name);
    (shader != Some(*host)).then(|| format!("{name}: {shader:?} in the shader, {host} on the host"))
}

fn entry_point_problems(module: &Module) -> Vec<String> {
    let mut problems = Vec::new();
    for entry in &module.entry_points {
        let prefix = match entry.stage {
            naga::ShaderStage::Vertex => "vs_",
            naga::ShaderStage::Fragment => "fs_",
            naga::ShaderStage::Compute => "cs_",
            _ => "a stage that phones lack",
        };
        if !entry.name.starts_with(prefix) {
            problems.push(format!("{}: should be named {prefix}…", entry.name));
        }
    }
    problems
}

/// An entry point's use of resources that the device limits: (name, number, limit).
fn counts(module: &Module, entry: &naga::EntryPoint, uses: &FunctionInfo) -> Vec<(&'static str, u32, u32)> {
    let limits = phone_limits();
    let is_used = |handle: Handle<GlobalVariable>| !uses[handle].is_empty();
    let used: Vec<&GlobalVariable> = module
        .global_variables
        .iter()
        .filter(|(handle, _)| is_used(*handle))
        .map(|(_, global)| global)
        .collect();
    let count = |is_one: &dyn Fn(&GlobalVariable) -> bool| {
        u32::try_from(used.iter().filter(|global| is_one(global)).count()).unwrap_or(u32::MAX)
    };
    let inner = |global: &GlobalVariable| &module.types[global.ty].inner;
    let is_image = |global: &GlobalVariable, is_storage: bool| match inner(global) {
        TypeInner::Image { class, .. } => matches!(class, ImageClass::Storage { .. }) == is_storage,
        _ => false,
    };
    let workgroup_bytes = used
        .iter()
        .filter(|global| global.space == AddressSpace::WorkGroup)
        // The count is that of wgpu: each variable is aligned to 16 bytes.
        .map(|global| inner(global).size(module.to_ctx()).next_multiple_of(16))
        .sum();
    let n_groups = used
        .iter()
        .filter_map(|global| global.binding.as_ref())
        .map(|binding| binding.group + 1)
        .max();
    #[rustfmt::skip] // One count a line.
    let counts = vec![
        ("bind groups", n_groups.unwrap_or(0), limits.max_bind_groups),
        ("storage buffers", count(&|global| matches!(global.space, AddressSpace::Storage { .. })), limits.max_storage_buffers_per_shader_stage),
        ("uniform buffers", count(&|global| global.space == AddressSpace::Uniform), limits.max_uniform_buffers_per_shader_stage),
        ("storage textures", count(&|global| is_image(global, true)), limits.max_storage_textures_per_shader_stage),
        ("sampled textures", count(&|global| is_image(global, false)), limits.max_sampled_textures_per_shader_stage),
        ("samplers", count(&|global| matches!(inner(global), TypeInner::Sampler { .. })), limits.max_samplers_per_shader_stage),
        ("invocations", entry.workgroup_size.iter().product(), limits.max_compute_invocations_per_workgroup),
        ("bytes of workgroup memory", workgroup_bytes, limits.max_compute_workgroup_storage_size),
    ];
    counts
}
