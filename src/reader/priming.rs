//! The first lines of a file without marks -> how many of them prime the nozzle.
//!
//! A start block draws a line or two with far more plastic than the print's own, to fill the nozzle. Where it
//! does so at the height of the first layer, nothing but that plastic tells it from the layer's lines.

/// Lines that a start block draws to prime the nozzle, at most.
pub(super) const MOST_LINES: usize = 8;

/// How many times as much plastic for each mm such a line takes as the layer's others, at least.
const TIMES: f64 = 1.5;

/// The lines with which the first layer begins.
#[derive(Debug, Default)]
pub(super) struct Priming {
    /// Place after each in the file's moves; its length and its filament, mm.
    lines: Vec<(usize, [f64; 2])>,
}

impl Priming {
    /// The next line of the first layer, of which the move `after` it is the next.
    pub(super) fn line(&mut self, after: usize, drawn: [f64; 2]) {
        if self.lines.len() < MOST_LINES {
            self.lines.push((after, drawn));
        }
    }

    /// The place in the moves after the last line that primes, and what all lines of the layer after it draw, if
    /// they draw `all`: length and filament, mm.
    pub(super) fn end(&self, all: [f64; 2]) -> Option<(usize, [f64; 2])> {
        let flow = |[length, filament]: [f64; 2]| filament / length;
        (1..=self.lines.len()).rev().find_map(|count| {
            let own = &self.lines[..count];
            let sum =
                own.iter().fold([0.0; 2], |sum, (_, drawn)| [0, 1].map(|k| sum[k] + drawn[k]));
            let rest = [0, 1].map(|k| all[k] - sum[k]);
            let primes = |drawn: [f64; 2]| flow(drawn) >= TIMES * flow(rest);
            let is_priming = rest[0] > sum[0] && own.iter().all(|(_, drawn)| primes(*drawn));
            is_priming.then_some((own.last()?.0, rest))
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::reader::Print;
    use std::fmt::Write as _;

    fn start(begin: &str) -> std::ops::Range<usize> {
        let mut text = format!("M83\nG1 Z0.2\n{begin}G1 X50 Y50\n");
        for k in 0..20 {
            let _ = writeln!(text, "G1 X{} Y{} E0.6", 50 + 20 * (k % 2), 50 + k);
        }
        text.push_str("G1 Z0.4\nG1 X50 Y50\nG1 X70 Y51 E0.6\nG1 X50 Y52 E0.6\n");
        let print = Print::read(&mut text.as_bytes(), 1.75).unwrap();
        assert_eq!(print.layers.len(), 2);
        print.facts.start
    }

    #[test]
    fn what_primes_at_the_height_of_the_first_layer_is_none_of_it() {
        // Up, where it begins, one line, two with a way between; and lines that are as thick as the others.
        assert_eq!(start("G1 Y-3\nG1 X65 E9\n"), 0..3);
        assert_eq!(start("G1 Y9\nG1 X65 E9\nG1 Y10\nG1 X5 E9\n"), 0..5);
        assert_eq!(start("G1 Y-3\nG1 X65 E1.9\n"), 0..2);
    }
}
