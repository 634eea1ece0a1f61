//! A patch of the map -> Sums: means over profiles along the steepest slope, and over the area.
//!
//! Words used here: the *axis* of a patch is the direction in which it mostly rises, or falls; a *fan* is
//! six directions, 30° apart, the first of them the axis; a place belongs to the direction of the fan that
//! its own steepest slope is nearest to.
//!
//! In each direction of the fan parallel profiles, a cell apart, cross the whole patch. Their mean lines come
//! from all of their places, but a place counts only in its own direction. So a plane is measured along its
//! slope, and a dome from its top down on all sides.
//!
//! Without the filter, deviations are those from the mean of the profile, or of the patch. With it they are
//! those from the Gaussian mean line or plane. Lengths along a profile are those on the surface: the cell
//! over the mean cosine of the slope. Over the area the cut-off is one in plan. Each place counts by the
//! area of the surface that it stands for.
//!
//! Rz is the height from the lowest to the highest place of a piece of a profile as long as the cut-off, or
//! of the whole profile if that is shorter; at least half of the piece has to be counted in this direction.

use super::gauss::Gauss;
use super::map::Map;
use super::sums::{CLASSES, Sums, class_of};
use crate::units::to_mm;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Directions of the fan.
const FAN: u8 = 6;

/// No direction: a place that counts in none.
const NONE: u8 = u8::MAX;

/// Share of a direction in what slopes, of all; below it a patch has no axis but x.
const LEAST_AXIS: f64 = 0.02;

/// Places of some rows and columns of the map that belong to one patch.
#[derive(Debug)]
pub(super) struct Piece {
    width: usize,
    /// Deviation of each place, µm; NaN beside the patch or without plastic.
    deviation: Vec<f32>,
    /// Direction of the fan of each place.
    direction: Vec<u8>,
    class: Vec<u8>,
    /// Surface over each place, in cells.
    weight: Vec<f32>,
    /// Side of a cell, mm.
    cell: f64,
    /// The axis, from x towards y.
    axis: f64,
    /// Sums of what is no mean over profiles or filtered areas.
    sums: [Sums; CLASSES],
}

/// What was found of a patch.
#[derive(Debug)]
pub(super) struct Found {
    /// By class of slopes.
    pub(super) sums: [Sums; CLASSES],
    /// Direction of the steepest slope, degrees from x towards y, 0 to 180.
    pub(super) direction: f64,
}

/// The sums of a patch; `samples` are its places in the map.
pub(super) fn measure(map: &Map, samples: &[u32], cutoff: f64) -> Found {
    let piece = Piece::new(map, samples);
    let mut sums = piece.sums;
    let mut take = |more: [Sums; CLASSES]| {
        sums.iter_mut().zip(&more).for_each(|(sums, more)| sums.and(more));
    };
    take(piece.area(cutoff));
    let gauss = Gauss::new(cutoff, piece.step());
    for direction in 0..FAN {
        if piece.direction.contains(&direction) {
            piece.profiles(direction, &gauss, cutoff).into_iter().for_each(&mut take);
        }
    }
    Found { sums, direction: piece.axis.to_degrees().rem_euclid(180.0) }
}

/// The direction in which something with these gradients mostly rises or falls, from x towards y.
fn axis(gradients: impl Iterator<Item = [f32; 2]>) -> f64 {
    let (mut twice, mut all) = ([0.0; 2], 0.0);
    for [x, y] in gradients.map(|one| one.map(f64::from)) {
        twice[0] += x * x - y * y;
        twice[1] += 2.0 * x * y;
        all += x * x + y * y;
    }
    let size = (twice[0] * twice[0] + twice[1] * twice[1]).sqrt();
    if size <= LEAST_AXIS * all { 0.0 } else { 0.5 * libm::atan2(twice[1], twice[0]) }
}

impl Piece {
    fn new(map: &Map, samples: &[u32]) -> Self {
        let across = map.grid.size[0];
        let place = |sample: &u32| {
            let cell = map.samples[*sample as usize].cell as usize;
            [cell % across, cell / across]
        };
        let end = |axis: usize| {
            let all = || samples.iter().map(|sample| place(sample)[axis]);
            (all().min().unwrap_or(0), all().max().unwrap_or(0))
        };
        let ((left, right), (front, back)) = (end(0), end(1));
        let (width, height) = (right - left + 1, back - front + 1);
        let cell = to_mm(map.grid.cell);
        let gradients = samples.iter().map(|sample| map.samples[*sample as usize].gradient);
        let mut piece = Self {
            width,
            deviation: vec![f32::NAN; width * height],
            direction: vec![NONE; width * height],
            class: vec![0; width * height],
            weight: vec![0.0; width * height],
            cell,
            axis: axis(gradients),
            sums: [Sums::default(); CLASSES],
        };
        for sample in samples {
            let [x, y] = place(sample);
            piece.take(map, *sample as usize, (y - front) * width + x - left);
        }
        piece
    }

    /// Takes in a sample at a place.
    fn take(&mut self, map: &Map, sample: usize, place: usize) {
        let one = &map.samples[sample];
        let class = class_of(one.slope());
        let cosine = one.cosine();
        let area = self.cell * self.cell / cosine;
        let over = map.over(sample);
        let sums = &mut self.sums[class];
        sums.area += area;
        sums.covered += if map.covers(over) { area } else { 0.0 };
        let Some(over) = over else { return };
        let deviation = 1000.0 * over * cosine;
        sums.near += area;
        sums.signed += area * deviation;
        self.deviation[place] = deviation as f32;
        self.weight[place] = (1.0 / cosine) as f32;
        self.class[place] = class as u8;
        let [x, y] = one.gradient.map(f64::from);
        let from_axis = libm::atan2(y, x) - self.axis;
        let nearest = (from_axis / (PI / f64::from(FAN))).round();
        self.direction[place] = nearest.rem_euclid(f64::from(FAN)) as u8;
    }

    /// Distance of places along a profile on the surface, mm.
    fn step(&self) -> f64 {
        let count = self.deviation.iter().filter(|one| !one.is_nan()).count();
        let all: f64 = self.weight.iter().map(|weight| f64::from(*weight)).sum();
        self.cell * if count > 0 { all / count as f64 } else { 1.0 }
    }

    /// Mean over the area, without the filter and with it.
    fn area(&self, cutoff: f64) -> [Sums; CLASSES] {
        let plane = Gauss::new(cutoff, self.cell).plane(&self.deviation, self.width);
        let mean = Sums::of(&self.sums);
        let mean = if mean.near > 0.0 { mean.signed / mean.near } else { 0.0 };
        let rows = self.deviation.par_chunks(self.width).enumerate().map(|(row, deviations)| {
            let mut sums = [Sums::default(); CLASSES];
            for (k, deviation) in deviations.iter().enumerate().filter(|(_, one)| !one.is_nan()) {
                let place = row * self.width + k;
                let sums = &mut sums[usize::from(self.class[place])];
                let (weight, deviation) = (f64::from(self.weight[place]), f64::from(*deviation));
                sums.raw.area.add(weight, deviation - mean);
                sums.filtered.area.add(weight, deviation - f64::from(plane[place]));
            }
            sums
        });
        // Row after row, so that the sum does not depend on threads.
        let mut all = [Sums::default(); CLASSES];
        for sums in rows.collect::<Vec<_>>() {
            all.iter_mut().zip(&sums).for_each(|(all, sums)| all.and(sums));
        }
        all
    }

    /// Sums of the profiles in a direction of the fan.
    fn profiles(&self, direction: u8, gauss: &Gauss, cutoff: f64) -> Vec<[Sums; CLASSES]> {
        let height = self.deviation.len() / self.width;
        let (middle_x, middle_y) = ((self.width / 2) as f64, (height / 2) as f64);
        let angle = self.axis + f64::from(direction) * PI / f64::from(FAN);
        let [along, across] = [angle, angle + FRAC_PI_2].map(|at| [libm::cos(at), libm::sin(at)]);
        let reach = ((self.width * self.width + height * height) as f64).sqrt() / 2.0;
        let reach = reach.ceil() as i64 + 1;
        let profile = |line: i64| {
            let place = |k: i64| {
                let at = |axis: usize| k as f64 * along[axis] + line as f64 * across[axis];
                let (x, y) = ((middle_x + at(0)).round(), (middle_y + at(1)).round());
                let is_in = x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < height as f64;
                is_in.then(|| y as usize * self.width + x as usize)
            };
            let places: Vec<Option<usize>> = (-reach..=reach).map(place).collect();
            self.profile(&places, direction, gauss, cutoff)
        };
        (-reach..=reach).into_par_iter().filter_map(profile).collect()
    }

    /// Sums of a profile; `None` of one that no place counts in.
    fn profile(
        &self,
        places: &[Option<usize>],
        direction: u8,
        gauss: &Gauss,
        cutoff: f64,
    ) -> Option<[Sums; CLASSES]> {
        let counts =
            |place: &Option<usize>| place.is_some_and(|at| self.direction[at] == direction);
        if !places.iter().any(counts) {
            return None;
        }
        let value = |place: Option<usize>| place.map_or(f32::NAN, |at| self.deviation[at]);
        let is_there = |place: &Option<usize>| !value(*place).is_nan();
        let first = places.iter().position(is_there)?;
        let last = places.iter().rposition(is_there)?;
        let places = &places[first..=last];
        let raw: Vec<f32> = places.iter().map(|place| value(*place)).collect();
        let there: Vec<f64> =
            raw.iter().filter(|one| !one.is_nan()).map(|one| f64::from(*one)).collect();
        let mean = there.iter().sum::<f64>() / there.len() as f64;
        let line = gauss.line(&raw);
        let rest: Vec<f32> = raw.iter().zip(&line).map(|(one, mean)| one - mean).collect();
        let mut sums = [Sums::default(); CLASSES];
        for (k, place) in places.iter().enumerate().filter(|(_, place)| counts(place)) {
            let Some(place) = *place else { continue };
            let (weight, class) = (f64::from(self.weight[place]), usize::from(self.class[place]));
            sums[class].raw.profile.add(weight, f64::from(raw[k]) - mean);
            sums[class].filtered.profile.add(weight, f64::from(rest[k]));
        }
        self.ranges(places, &counts, [&raw, &rest], cutoff, &mut sums);
        Some(sums)
    }

    /// Adds the heights of the pieces of a profile: of `values` without the filter, and with it.
    fn ranges(
        &self,
        places: &[Option<usize>],
        counts: &impl Fn(&Option<usize>) -> bool,
        values: [&[f32]; 2],
        cutoff: f64,
        sums: &mut [Sums; CLASSES],
    ) {
        let length = places.len() as f64 * self.step_of(places);
        let pieces = (length / cutoff).round().max(1.0) as usize;
        let part = |piece: usize| piece * places.len() / pieces;
        for range in (0..pieces).map(|piece| part(piece)..part(piece + 1)) {
            let counted: Vec<usize> = range.clone().filter(|k| counts(&places[*k])).collect();
            let Some(middle) = counted.get(counted.len() / 2) else { continue };
            if 2 * counted.len() < range.len() {
                continue;
            }
            let class = places[*middle].map_or(0, |place| usize::from(self.class[place]));
            let kinds = [&mut sums[class].raw, &mut sums[class].filtered];
            for (kind, values) in kinds.into_iter().zip(values) {
                let best = |better: fn(f32, f32) -> f32| {
                    counted.iter().map(|k| values[*k]).fold(values[*middle], better)
                };
                let weight = counted.len() as f64;
                let height = f64::from(best(f32::max) - best(f32::min));
                kind.range = [kind.range[0] + weight * height, kind.range[1] + weight];
            }
        }
    }

    /// Distance of the places of a profile on the surface, mm.
    fn step_of(&self, places: &[Option<usize>]) -> f64 {
        let weights = || places.iter().flatten().map(|at| f64::from(self.weight[*at]));
        let weights = || weights().filter(|weight| *weight > 0.0);
        self.cell * weights().sum::<f64>() / weights().count().max(1) as f64
    }
}
