//! The list of a path's passes, which generates its modules, its pipelines, its targets and its shaders.

use crate::gpu::Gpu;

/// For passes without render targets of their own.
pub(crate) struct NoTargets;

impl NoTargets {
    pub(crate) fn new<P>(_: &Gpu, _: &P) -> Self {
        Self
    }
}

/// A pass's name and the function that compiles it.
pub(crate) type WarmUp = (&'static str, fn(&Gpu));

/// Declares the modules of a path's passes, in the order of their first runs for a new scene, and for each its
/// `Pass` and its `SHADER`; if the type of a plan follows, its `Targets` as well.
macro_rules! passes {
    ($plan:ty: $($pass:ident),* $(,)?) => {
        $crate::passes::list::passes!($($pass),*);

        /// The targets of the path's passes.
        #[allow(dead_code, reason = "there are passes that write to what others own")]
        pub(crate) struct Targets {
            $(pub(crate) $pass: $pass::Targets,)*
        }

        impl Targets {
            /// Allocates the resources of `plan`.
            pub(crate) fn new(gpu: &$crate::gpu::context::Gpu, plan: &$plan) -> Self {
                Self {
                    $($pass: $pass::Targets::new(gpu, plan),)*
                }
            }
        }
    };
    ($($pass:ident),* $(,)?) => {
        $(pub(crate) mod $pass;)*

        /// Every pass of the path.
        pub(crate) struct Passes {
            $(pub(crate) $pass: $pass::Pass,)*
        }

        impl Passes {
            pub(crate) fn new(gpu: &$crate::gpu::context::Gpu) -> Self {
                Self {
                    $($pass: $pass::Pass::new(gpu),)*
                }
            }
        }

        /// The passes' shaders.
        pub(crate) const SHADERS: &[&$crate::gpu::shader::Shader] = &[$(&$pass::SHADER),*];

        /// Functions that each compile one pass ahead of its first use.
        pub(crate) const WARM_UPS: &[$crate::passes::list::WarmUp] =
            &[$((stringify!($pass), |gpu| drop($pass::Pass::new(gpu)))),*];
    };
}

pub(crate) use passes;
