//! Deviations -> mean line and mean plane: the Gaussian filters of ISO 16610-21 and ISO 16610-61.
//!
//! The weight of a place at the distance x of a profile is exp(-π (x / (α λ))²) with α = √(ln 2 / π) and
//! λ the cut-off: of a wave as long as the cut-off, half passes. Over an area the weights of both axes are
//! multiplied. What lies farther than the cut-off (less than a millionth of the weight) counts nothing. At
//! borders and gaps the weights of what is there are made 1 in all.

use rayon::prelude::*;
use std::f64::consts::{LN_2, PI};

/// Weights of a place and of those beyond it to one side.
#[derive(Debug, Clone)]
pub(super) struct Gauss(Vec<f32>);

impl Gauss {
    /// For places `step` apart and the cut-off `cutoff`, both mm.
    pub(super) fn new(cutoff: f64, step: f64) -> Self {
        let reach = (cutoff / step).ceil().max(1.0) as usize;
        let weight = |k: usize| {
            let part = k as f64 * step / cutoff;
            libm::exp(-PI * part * part * PI / LN_2) as f32
        };
        Self((0..=reach).map(weight).collect())
    }

    /// For each place the sum of the values around it, weighted.
    fn sums(&self, values: &[f32]) -> Vec<f32> {
        let mut sums: Vec<f32> = values.iter().map(|value| value * self.0[0]).collect();
        let count = values.len();
        for (k, weight) in self.0.iter().enumerate().skip(1).take(count.saturating_sub(1)) {
            for (sum, value) in sums[k..].iter_mut().zip(values) {
                *sum += weight * value;
            }
            for (sum, value) in sums[..count - k].iter_mut().zip(&values[k..]) {
                *sum += weight * value;
            }
        }
        sums
    }

    /// The mean line of a profile; NaN is a gap. Where no value is near it is 0.
    pub(super) fn line(&self, profile: &[f32]) -> Vec<f32> {
        let (values, there) = parts(profile);
        let (values, there) = (self.sums(&values), self.sums(&there));
        values.into_iter().zip(there).map(|(value, there)| ratio(value, there)).collect()
    }

    /// The mean plane of rows of `width` places; NaN is a gap.
    pub(super) fn plane(&self, places: &[f32], width: usize) -> Vec<f32> {
        let (values, there) = parts(places);
        let both = |places: &[f32]| {
            let along = self.rows(places, width);
            let height = along.len() / width.max(1);
            let across = self.rows(&turned(&along, width), height);
            turned(&across, height)
        };
        let (values, there) = (both(&values), both(&there));
        values.into_iter().zip(there).map(|(value, there)| ratio(value, there)).collect()
    }

    fn rows(&self, places: &[f32], width: usize) -> Vec<f32> {
        let width = width.max(1);
        let mut sums = vec![0.0; places.len()];
        let rows = sums.par_chunks_mut(width).zip(places.par_chunks(width));
        rows.for_each(|(sums, row)| {
            if row.iter().any(|value| *value != 0.0) {
                sums.copy_from_slice(&self.sums(row));
            }
        });
        sums
    }
}

/// Values with 0 in gaps, and 1 where there is one.
fn parts(places: &[f32]) -> (Vec<f32>, Vec<f32>) {
    let value = |value: &f32| if value.is_nan() { 0.0 } else { *value };
    let there = |value: &f32| if value.is_nan() { 0.0 } else { 1.0 };
    (places.iter().map(value).collect(), places.iter().map(there).collect())
}

fn ratio(value: f32, there: f32) -> f32 {
    if there > 0.0 { value / there } else { 0.0 }
}

/// Rows for columns.
fn turned(places: &[f32], width: usize) -> Vec<f32> {
    let width = width.max(1);
    let height = places.len() / width;
    let mut turned = vec![0.0; places.len()];
    turned.par_chunks_mut(height.max(1)).enumerate().for_each(|(column, out)| {
        for (row, out) in out.iter_mut().enumerate() {
            *out = places[row * width + column];
        }
    });
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave of this length, mm, of height 1, every 0.05 mm.
    fn wave(length: f64, count: usize) -> Vec<f32> {
        let at = |k: usize| libm::sin(2.0 * PI * k as f64 * 0.05 / length) as f32;
        (0..count).map(at).collect()
    }

    #[test]
    fn of_a_wave_as_long_as_the_cut_off_half_passes() {
        let gauss = Gauss::new(2.0, 0.05);
        // ISO 16610-21: exp(-π (α λc / λ)²) passes.
        for (length, passes) in [(2.0, 0.5), (4.0, 0.840_896), (1.0, 0.0625)] {
            let line = gauss.line(&wave(length, 1000));
            let most = line[300..700].iter().fold(0.0_f32, |most, one| most.max(*one));
            assert!((f64::from(most) - passes).abs() < 2e-3, "{length}: {most}");
        }
        // Over an area, along x and along y.
        let rows: Vec<f32> = (0..200).flat_map(|_| wave(2.0, 400)).collect();
        for plane in [gauss.plane(&rows, 400), turned(&gauss.plane(&turned(&rows, 400), 200), 200)]
        {
            let most =
                plane[100 * 400 + 100..100 * 400 + 300].iter().fold(0.0_f32, |a, b| a.max(*b));
            assert!((most - 0.5).abs() < 2e-3, "{most}");
        }
    }

    #[test]
    fn borders_and_gaps_take_no_weight() {
        let gauss = Gauss::new(2.0, 0.05);
        let mut profile = vec![3.0; 120];
        profile[40..70].fill(f32::NAN);
        assert!(gauss.line(&profile).iter().all(|one| (one - 3.0).abs() < 1e-5));
        assert!(gauss.plane(&profile, 12).iter().all(|one| (one - 3.0).abs() < 1e-5));
        assert!(gauss.line(&[]).is_empty() && gauss.plane(&[], 0).is_empty());
        assert_eq!(gauss.line(&[f32::NAN, f32::NAN]), [0.0, 0.0]);
    }
}
