//! Weighted linear least squares.

use nalgebra::{DMatrix, DVector, DVectorView};

/// Weighted normal equations of any number of unknowns.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    /// Sum of the weighted squares of the values.
    squares: f64,
}

impl NormalEquations {
    /// Equations of `n_columns` unknowns, without any observation.
    #[must_use]
    pub fn new(n_columns: usize) -> Self {
        Self {
            matrix: DMatrix::zeros(n_columns, n_columns),
            right: DVector::zeros(n_columns),
            squares: 0.0,
        }
    }

    /// Adds the observation that `columns` times the unknowns is `value`.
    pub fn observe(&mut self, columns: &[f64], value: f64, weight: f64) {
        let columns = DVectorView::from_slice(columns, columns.len());
        self.matrix.ger(weight, &columns, &columns, 1.0);
        self.right.axpy(weight * value, &columns, 1.0);
        self.squares += weight * value * value;
    }

    /// Adds the observation that unknown `column` is `value`.
    pub fn expect(&mut self, column: usize, value: f64, weight: f64) {
        self.matrix[(column, column)] += weight;
        self.right[column] += weight * value;
        self.squares += weight * value * value;
    }

    /// Adds all observations of `other`.
    pub fn join(&mut self, other: &Self) {
        self.matrix += &other.matrix;
        self.right += &other.right;
        self.squares += other.squares;
    }

    /// The same observations with all unknowns equal.
    #[must_use]
    pub fn of_equal_unknowns(&self) -> Self {
        Self {
            matrix: DMatrix::from_element(1, 1, self.matrix.sum()),
            right: DVector::from_element(1, self.right.sum()),
            squares: self.squares,
        }
    }

    /// Sum of weighted squared residuals.
    #[must_use]
    pub fn squares_left(&self, unknowns: &DVector<f64>) -> f64 {
        self.squares + self.cost(unknowns)
    }

    /// Sum of the weighted squares of a column.
    #[must_use]
    pub fn energy(&self, column: usize) -> f64 {
        self.matrix[(column, column)]
    }

    /// The non-negative least squares solution: for every set of zero unknowns the others are
    /// solved for.
    ///
    /// The work doubles with each unknown. Not finite if they are not determined.
    #[must_use]
    pub fn solve_non_negative(&self) -> DVector<f64> {
        let n = self.right.len();
        let solutions = (0..1_u32 << n).map(|zeros| self.solve_without(|column| zeros >> column & 1 == 1));
        let allowed = solutions.filter(|unknowns| unknowns.iter().all(|unknown| *unknown >= 0.0));
        let best = allowed.min_by(|a, b| self.cost(a).total_cmp(&self.cost(b)));
        best.unwrap_or_else(|| self.solve())
    }

    /// The solution with those unknowns zero for which `is_zero` is true.
    fn solve_without(&self, is_zero: impl Fn(usize) -> bool) -> DVector<f64> {
        let mut left = self.clone();
        for column in (0..self.right.len()).filter(|column| is_zero(*column)) {
            left.matrix.row_mut(column).fill(0.0);
            left.matrix.column_mut(column).fill(0.0);
            left.matrix[(column, column)] = 1.0;
            left.right[column] = 0.0;
        }
        left.solve()
    }

    /// Sum of weighted squared residuals, up to a constant.
    fn cost(&self, unknowns: &DVector<f64>) -> f64 {
        unknowns.dot(&(&self.matrix * unknowns - 2.0 * &self.right))
    }

    /// The solution by elimination with partial pivoting; not finite if it is not determined.
    #[must_use]
    pub fn solve(&self) -> DVector<f64> {
        let solution = self.matrix.clone().lu().solve(&self.right);
        solution.unwrap_or_else(|| DVector::repeat(self.right.len(), f64::NAN))
    }
}
