//! Fragment shaders contain no structs: drivers of older Adreno chips store those in 16 bits,
//! whatever precision was requested.
//!
//! Source: KhronosGroup/WebGL issue 3351. Uniform buffers are read member by member, and several
//! outputs of an entry point must be a struct: both are permitted.

use std::collections::BTreeSet;

use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{Block, Function, Handle, Module, ShaderStage, Statement, Type, TypeInner};

/// Structs as values, arguments or locals in the code of a fragment shader.
pub(crate) fn struct_values(module: &Module, info: &ModuleInfo) -> Vec<String> {
    let mut problems = BTreeSet::new();
    for (index, entry) in module.entry_points.iter().enumerate() {
        if entry.stage != ShaderStage::Fragment {
            continue;
        }
        let output = entry.function.result.as_ref().map(|result| result.ty);
        let of_entry = (&entry.function, info.get_entry_point(index));
        problems.extend(structs_in(module, &entry.name, of_entry, output));
        for handle in called_by(module, &entry.function) {
            let function = &module.functions[handle];
            let name = function.name.as_deref().unwrap_or_default();
            problems.extend(structs_in(module, name, (function, &info[handle]), None));
        }
    }
    problems.into_iter().collect()
}

/// All functions that a function calls, directly or indirectly.
fn called_by(module: &Module, function: &Function) -> BTreeSet<Handle<Function>> {
    let mut called = BTreeSet::new();
    let mut blocks = vec![&function.body];
    while let Some(block) = blocks.pop() {
        for handle in calls_in(block) {
            if called.insert(handle) {
                blocks.push(&module.functions[handle].body);
            }
        }
    }
    called
}

fn calls_in(block: &Block) -> Vec<Handle<Function>> {
    let of_statement = |statement: &Statement| match statement {
        Statement::Call { function, .. } => vec![*function],
        Statement::Block(block) => calls_in(block),
        Statement::If { accept, reject, .. } => [calls_in(accept), calls_in(reject)].concat(),
        Statement::Switch { cases, .. } => cases.iter().flat_map(|case| calls_in(&case.body)).collect(),
        Statement::Loop { body, continuing, .. } => [calls_in(body), calls_in(continuing)].concat(),
        _ => Vec::new(),
    };
    block.iter().flat_map(of_statement).collect()
}

fn structs_in(
    module: &Module,
    name: &str,
    (function, info): (&Function, &FunctionInfo),
    output: Option<Handle<Type>>,
) -> Vec<String> {
    let output = output.map(|ty| &module.types[ty].inner);
    let values = function
        .expressions
        .iter()
        .map(|(handle, _)| info[handle].ty.inner_with(&module.types));
    let is_struct = |inner: &&TypeInner| match inner {
        TypeInner::Struct { .. } => Some(*inner) != output,
        TypeInner::Array { base, .. } => holds_struct(module, *base),
        _ => false,
    };
    let mut problems = Vec::new();
    if values.filter(is_struct).count() > 0 {
        problems.push(format!("{name}: a struct as a value in a fragment shader"));
    }
    let locals = function.local_variables.iter().map(|(_, local)| local.ty);
    let arguments = function.arguments.iter().map(|argument| argument.ty);
    if locals.chain(arguments).any(|ty| holds_struct(module, ty)) {
        problems.push(format!("{name}: a struct as a variable in a fragment shader"));
    }
    problems
}

fn holds_struct(module: &Module, ty: Handle<Type>) -> bool {
    match module.types[ty].inner {
        TypeInner::Struct { .. } => true,
        TypeInner::Array { base, .. } | TypeInner::Pointer { base, .. } => holds_struct(module, base),
        _ => false,
    }
}
