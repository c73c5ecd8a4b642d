//! Weighted linear least squares.

use super::real::Real;

/// Weighted normal equations of any number of unknowns.
#[derive(Clone, Debug)]
pub struct NormalEquations<R> {
    matrix: Vec<Vec<R>>,
    right: Vec<R>,
    /// Sum of the weighted squares of the values.
    squares: R,
}

impl<R: Real> NormalEquations<R> {
    /// Of `n_columns` unknowns, without any observation.
    #[must_use]
    pub fn new(n_columns: usize) -> Self {
        Self {
            matrix: vec![vec![R::ZERO; n_columns]; n_columns],
            right: vec![R::ZERO; n_columns],
            squares: R::ZERO,
        }
    }

    /// Adds the observation that `columns` times the unknowns is `value`.
    pub fn observe(&mut self, columns: &[R], value: R, weight: R) {
        for (i, column) in columns.iter().enumerate() {
            for (j, other) in columns.iter().enumerate() {
                self.matrix[i][j] += weight * *column * *other;
            }
            self.right[i] += weight * *column * value;
        }
        self.squares += weight * value * value;
    }

    /// Adds the observation that unknown `column` is `value`.
    pub fn expect(&mut self, column: usize, value: R, weight: R) {
        self.matrix[column][column] += weight;
        self.right[column] += weight * value;
        self.squares += weight * value * value;
    }

    /// Adds all observations of `other`.
    pub fn join(&mut self, other: &Self) {
        let pairs = |a: &mut [R], b: &[R]| a.iter_mut().zip(b).for_each(|(a, b)| *a += *b);
        self.matrix
            .iter_mut()
            .zip(&other.matrix)
            .for_each(|(row, more)| pairs(row, more));
        pairs(&mut self.right, &other.right);
        self.squares += other.squares;
    }

    /// The same observations of unknowns that are all equal.
    #[must_use]
    pub fn of_equal_unknowns(&self) -> Self {
        Self {
            matrix: vec![vec![self.matrix.iter().flatten().copied().sum()]],
            right: vec![self.right.iter().copied().sum()],
            squares: self.squares,
        }
    }

    /// Weighted squares that some unknowns leave.
    #[must_use]
    pub fn squares_left(&self, unknowns: &[R]) -> R {
        self.squares + self.cost(unknowns)
    }

    /// Sum of the weighted squares of a column.
    #[must_use]
    pub fn energy(&self, column: usize) -> R {
        self.matrix[column][column]
    }

    /// The unknowns that cost least of all those without one below 0: of every set of them that is 0 the others are solved for.
    ///
    /// The work doubles with each unknown. Not finite where they are not determined.
    #[must_use]
    pub fn solve_non_negative(&self) -> Vec<R> {
        let n = self.right.len();
        let solutions = (0..1_u32 << n).map(|zeros| self.solve_without(|column| zeros >> column & 1 == 1));
        let allowed = solutions.filter(|unknowns| unknowns.iter().all(|unknown| *unknown >= R::ZERO));
        let best = allowed.min_by(|a, b| self.cost(a).total_cmp(&self.cost(b)));
        best.unwrap_or_else(|| self.solve())
    }

    /// The unknowns, where those that `is_zero` tells are 0.
    fn solve_without(&self, is_zero: impl Fn(usize) -> bool) -> Vec<R> {
        let mut left = self.clone();
        for column in (0..self.right.len()).filter(|column| is_zero(*column)) {
            left.matrix.iter_mut().for_each(|row| row[column] = R::ZERO);
            left.matrix[column].fill(R::ZERO);
            left.matrix[column][column] = R::ONE;
            left.right[column] = R::ZERO;
        }
        left.solve()
    }

    /// Weighted squares that are left, up to a constant.
    fn cost(&self, unknowns: &[R]) -> R {
        let rows = self.matrix.iter().zip(&self.right).zip(unknowns);
        rows.map(|((row, right), unknown)| {
            let product: R = row.iter().zip(unknowns).map(|(a, b)| *a * *b).sum();
            *unknown * (product - *right - *right)
        })
        .sum()
    }

    /// The unknowns, by elimination with partial pivoting; not finite where they are not determined.
    #[must_use]
    pub fn solve(&self) -> Vec<R> {
        let n = self.right.len();
        let mut rows: Vec<Vec<R>> = self.matrix.clone();
        rows.iter_mut()
            .zip(&self.right)
            .for_each(|(row, value)| row.push(*value));
        for p in 0..n {
            let largest = (p..n).max_by(|a, b| rows[*a][p].abs().total_cmp(&rows[*b][p].abs()));
            rows.swap(p, largest.unwrap_or(p));
            let (above, below) = rows.split_at_mut(p + 1);
            for row in below {
                let factor = row[p] / above[p][p];
                for (value, pivot) in row.iter_mut().zip(&above[p]).skip(p) {
                    *value -= factor * *pivot;
                }
            }
        }
        let mut unknowns = vec![R::ZERO; n];
        for p in (0..n).rev() {
            let known: R = (p + 1..n).map(|j| rows[p][j] * unknowns[j]).sum();
            unknowns[p] = (rows[p][n] - known) / rows[p][p];
        }
        unknowns
    }
}
