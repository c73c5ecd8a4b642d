//! Numbers, lists and texts in messages, at a readable length.

use std::fmt;

/// Significant digits of a number.
const N_DIGITS: usize = 6;
/// Number of listed names; the rest is counted.
const N_NAMES: usize = 5;
/// Number of shown characters of a text from a file.
const N_CHARACTERS: usize = 160;

/// A number with at most six significant digits, in scientific notation if it is very large or
/// small.
pub struct Number(pub f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = format!("{:.*e}", N_DIGITS - 1, self.0);
        // NaN, or an infinity.
        let Some((_, exponent)) = rounded.split_once('e') else {
            return write!(f, "{}", self.0);
        };
        let value: f64 = rounded.parse().map_err(|_| fmt::Error)?;
        let is_short = exponent
            .parse()
            .is_ok_and(|exponent: i32| (-4..=6).contains(&exponent));
        if is_short || value == 0.0 {
            write!(f, "{value}")
        } else {
            write!(f, "{value:e}")
        }
    }
}

/// Some words of a list, and the number of the others.
pub struct Listed<'a, T> {
    /// The words.
    pub items: &'a [T],
    /// Separator.
    pub between: &'static str,
}

impl<T: fmt::Display> fmt::Display for Listed<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // One more name takes no more room than its count.
        let n_shown = if self.items.len() <= N_NAMES + 1 {
            self.items.len()
        } else {
            N_NAMES
        };
        for (index, item) in self.items[..n_shown].iter().enumerate() {
            let between = if index == 0 { "" } else { self.between };
            write!(f, "{between}{}", Text(&item.to_string()))?;
        }
        match self.items.len() - n_shown {
            0 => Ok(()),
            n_left => write!(f, " and {n_left} more"),
        }
    }
}

/// The beginning of a text.
pub struct Text<'a>(pub &'a str);

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.char_indices().nth(N_CHARACTERS) {
            None => f.write_str(self.0),
            Some((end, _)) => write!(f, "{}…", &self.0[..end]),
        }
    }
}
