//! Sizes -> Result: checks that models and layout fit the print volume.

use crate::mesh::{Bed, Error, Placement, Result};
use crate::units::MAX_COORDINATE_MM;

/// Half a grid unit, mm: smaller differences are rounding.
const HALF_UNIT_MM: f64 = 0.000_05;

/// Largest factor on lengths. The largest coordinate of a file is 10⁹ in metres, so that products
/// stay below 10²¹, far from overflow.
const MAX_SCALE: f64 = 1e9;

/// Refuses numbers that make no sense.
pub(super) fn check_placement(placement: &Placement) -> Result<()> {
    let Placement { scale, rotate, sink, at, gap, copies, .. } = *placement;
    if !(scale > 0.0 && scale <= MAX_SCALE) {
        return Err(Error::Scale { scale, most: MAX_SCALE });
    }
    if !rotate
        .iter()
        .chain([&sink, &gap])
        .chain(at.iter().flatten())
        .all(|number| number.is_finite())
    {
        return Err(Error::NotFinite);
    }
    if copies == 0 {
        return Err(Error::NoCopies);
    }
    Ok(())
}

/// Refuses a model that does not fit the print volume by itself.
pub(super) fn check_size(
    size_mm: [f64; 3],
    file: &str,
    placement: &Placement,
    bed: &Bed,
) -> Result<()> {
    let [width, depth] = bed.size();
    let space_mm = [width, depth, bed.height];
    let limit = space_mm.map(|side| side.min(MAX_COORDINATE_MM));
    if (0..3).all(|axis| size_mm[axis] <= limit[axis] + HALF_UNIT_MM) {
        return Ok(());
    }
    let shrink = (0..3).map(|axis| limit[axis] / size_mm[axis]).fold(f64::INFINITY, f64::min);
    let scale = shrink * placement.scale;
    // Rounded down to three digits, so that the model fits with the number that is shown.
    let digits = libm::pow(10.0, 2.0 - libm::floor(libm::log10(scale)));
    let scale = libm::floor(scale * digits) / digits;
    Err(Error::TooLarge {
        file: file.to_owned(),
        size_mm,
        space_mm,
        is_only_too_high: size_mm[0] <= limit[0] && size_mm[1] <= limit[1],
        scale: (scale > 0.0 && digits.is_finite()).then_some(scale),
    })
}

/// Where the middle of the layout goes; refused if the layout sticks out of the bed there.
pub(super) fn offset(placement: &Placement, bed: &Bed, size_mm: [f64; 2]) -> Result<[f64; 2]> {
    let Bed { min, max, .. } = *bed;
    let Some(at) = placement.at else {
        return Ok([f64::midpoint(min[0], max[0]), f64::midpoint(min[1], max[1])]);
    };
    let over = |axis: usize| {
        let half = size_mm[axis] / 2.0;
        let sides = [min[axis] - (at[axis] - half), at[axis] + half - max[axis]];
        sides.map(|over| if over > 2.0 * HALF_UNIT_MM { over } else { 0.0 })
    };
    let over_mm = [over(0), over(1)];
    if over_mm == [[0.0; 2]; 2] {
        return Ok(at);
    }
    let bed_mm = [[min[0], max[0]], [min[1], max[1]]];
    Err(Error::OffBed { at, size_mm, over_mm, bed_mm })
}
