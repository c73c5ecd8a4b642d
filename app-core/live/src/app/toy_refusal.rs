//! The reason why a file is no toy for this app, in kinds that a person can act upon.

use app_scene::toy::{ToyError, ToyProblem};

/// A file that is no toy for this app.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToyRefusal {
    /// Name of the file.
    pub file: String,
    /// The kind of the reason.
    pub kind: RefusalKind,
    /// The whole reason, for the log.
    pub reason: String,
}

/// Kinds of reasons.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RefusalKind {
    /// It cannot be read.
    Unreadable,
    /// It is larger than this number of MiB.
    TooLarge(u64),
    /// It has another format.
    Foreign,
    /// It requires an extension that is not supported.
    Extension(String),
    /// A field has more than a limit allows.
    TooMany {
        /// Path of the field.
        field: String,
        /// The number of things.
        found: u64,
        /// The limit.
        limit: u64,
    },
    /// It refers to another file.
    External,
    /// It has no triangles.
    NoTriangles,
    /// A picture in it cannot be decoded.
    Picture,
    /// A field is invalid.
    Damaged {
        /// Path of the field.
        field: String,
    },
}

impl ToyRefusal {
    /// A file that cannot be read, for this reason.
    #[must_use]
    pub fn unreadable(file: &str, reason: impl std::fmt::Display) -> Self {
        Self {
            file: file.to_owned(),
            kind: RefusalKind::Unreadable,
            reason: format!("{file}: {reason}"),
        }
    }

    /// A file of more than this number of MiB.
    #[must_use]
    pub fn too_large(file: &str, most_mib: u64) -> Self {
        Self {
            file: file.to_owned(),
            kind: RefusalKind::TooLarge(most_mib),
            reason: format!("{file}: more than {most_mib} MiB"),
        }
    }

    /// The refusal of a file of this name.
    #[must_use]
    pub fn of(file: &str, error: &ToyError) -> Self {
        let kind = match error {
            ToyError::Malformed { field, problem, .. } => kind_of(field, problem),
            _ => RefusalKind::Damaged {
                field: "pose".to_owned(),
            },
        };
        Self {
            file: file.to_owned(),
            kind,
            reason: error.to_string(),
        }
    }
}

fn kind_of(field: &str, problem: &ToyProblem) -> RefusalKind {
    match problem {
        ToyProblem::Foreign { .. } => RefusalKind::Foreign,
        ToyProblem::Extension { name, .. } => RefusalKind::Extension(name.clone()),
        ToyProblem::TooMany { found, limit, .. } => RefusalKind::TooMany {
            field: field.to_owned(),
            found: *found,
            limit: *limit,
        },
        ToyProblem::External | ToyProblem::Neighbour { .. } => RefusalKind::External,
        ToyProblem::NoTriangles => RefusalKind::NoTriangles,
        ToyProblem::Image(_) => RefusalKind::Picture,
        _ => RefusalKind::Damaged {
            field: field.to_owned(),
        },
    }
}
