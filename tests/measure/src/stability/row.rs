//! What a case measures: a number beside the bound that it must keep.

/// What a measured number must not exceed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Largest number that is good.
    pub limit: f64,
    /// Unit of limit and measure.
    pub unit: &'static str,
    /// What is measured, in a few words.
    pub meaning: &'static str,
}

/// One line of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Group of the case.
    pub group: &'static str,
    /// Name of the case.
    pub case: &'static str,
    /// What was varied, and how far.
    pub parameter: String,
    /// The bound.
    pub bound: Bound,
    /// What the core on its device has.
    pub measured: Measured,
    /// What the CPU reference has in 32 bits, where there is one.
    pub cpu_f32: Option<f64>,
    /// The same in 64 bits.
    pub cpu_f64: Option<f64>,
    /// What else there is to say.
    pub note: String,
}

/// What came of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub enum Measured {
    /// A number.
    Number(f64),
    /// The core took the input for one that cannot be.
    Refused(String),
}

impl Row {
    /// The row, with a note of a number before a change and after it.
    #[must_use]
    pub fn noting(mut self, before: f64, after: f64) -> Self {
        self.note = format!("{after:.2} after {before:.2}");
        self
    }

    /// Whether the bound is not kept. A refused input keeps none, and neither does what is not a number.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        match self.measured {
            Measured::Number(number) => number.is_nan() || number > self.bound.limit,
            Measured::Refused(_) => true,
        }
    }
}

/// A parameter in small steps and what was measured along them, to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Name of the file, without its end.
    pub name: String,
    /// The parameter and its unit.
    pub along: &'static str,
    /// What is measured and its unit.
    pub measure: &'static str,
    /// Lines, each with its name and its points.
    pub lines: Vec<(&'static str, Vec<[f64; 2]>)>,
}

/// All that a case found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// Lines of the table.
    pub rows: Vec<Row>,
    /// Sweeps to be drawn.
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
