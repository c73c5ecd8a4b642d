//! The result of a case: a measurement and its bound.

/// The bound of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Largest good number.
    pub limit: f64,
    /// Unit of limit and measure.
    pub unit: &'static str,
    /// The measured quantity, in a few words.
    pub meaning: &'static str,
}

/// One line of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Group of the case.
    pub group: &'static str,
    /// Name of the case.
    pub case: &'static str,
    /// The varied parameter, and its value.
    pub parameter: String,
    /// The bound.
    pub bound: Bound,
    /// The result of the core on its device.
    pub measured: Measured,
    /// The result of the CPU reference in 32 bits, if there is one.
    pub cpu_f32: Option<f64>,
    /// The same in 64 bits.
    pub cpu_f64: Option<f64>,
    /// Further remarks.
    pub note: String,
}

/// The outcome of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub enum Measured {
    /// A number.
    Number(f64),
    /// The core refused the input.
    Refused(String),
}

impl Row {
    /// The row, with a note of a number before and after a change.
    #[must_use]
    pub fn noting(mut self, before: f64, after: f64) -> Self {
        self.note = format!("{after:.2} after {before:.2}");
        self
    }

    /// Whether the bound is broken, as by a refused input and by NaN.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        match self.measured {
            Measured::Number(number) => number.is_nan() || number > self.bound.limit,
            Measured::Refused(_) => true,
        }
    }
}

/// A parameter in small steps with measurements along them, to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Name of the file, without its extension.
    pub name: String,
    /// The parameter and its unit.
    pub along: &'static str,
    /// The measured quantity and its unit.
    pub measure: &'static str,
    /// Lines, each with its name and its points.
    pub lines: Vec<(&'static str, Vec<[f64; 2]>)>,
}

/// The results of a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// Lines of the table.
    pub rows: Vec<Row>,
    /// Sweeps to draw.
    pub sweeps: Vec<Sweep>,
}

impl From<Vec<Row>> for Findings {
    fn from(rows: Vec<Row>) -> Self {
        Self {
            rows,
            sweeps: Vec::new(),
        }
    }
}
