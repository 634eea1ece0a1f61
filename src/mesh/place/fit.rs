//! Sizes -> Result: says whether models and layout fit the print volume, and what to do if not.

use crate::error::{Error, Result};
use crate::mesh::{Bed, Placement};
use crate::units::MAX_COORDINATE_MM;

/// Half a grid unit: differences below it are rounding, mm.
const HALF_UNIT_MM: f64 = 0.000_05;

/// Largest factor: keeps the largest coordinate of a file far from overflow.
const MAX_SCALE: f64 = 1e9;

/// Refuses numbers that make no sense.
pub(crate) fn check_placement(placement: &Placement) -> Result<()> {
    let Placement { scale, rotate, at, copies, .. } = *placement;
    let finite = rotate.iter().chain(at.iter().flatten()).all(|number| number.is_finite());
    if !(scale > 0.0 && scale <= MAX_SCALE) {
        return Err(Error::Usage(format!(
            "--scale {scale}: must be above 0 and at most {MAX_SCALE:e}"
        )));
    }
    if !finite {
        return Err(Error::Usage("--rotate and --at take finite numbers".to_owned()));
    }
    if copies == 0 {
        return Err(Error::Usage("--copies 0: must be at least 1".to_owned()));
    }
    Ok(())
}

/// Refuses a model that does not fit the bed by itself.
pub(crate) fn check_size(
    size: [f64; 3],
    file: &str,
    placement: &Placement,
    bed: &Bed,
) -> Result<()> {
    let space = [bed.max[0] - bed.min[0], bed.max[1] - bed.min[1], bed.height];
    let limit = space.map(|side| side.min(MAX_COORDINATE_MM));
    if (0..3).all(|axis| size[axis] <= limit[axis] + HALF_UNIT_MM) {
        return Ok(());
    }
    let shrink = (0..3).map(|axis| limit[axis] / size[axis]).fold(f64::INFINITY, f64::min);
    let what = if size[0] <= limit[0] && size[1] <= limit[1] { "higher" } else { "larger" };
    let scale = shrink * placement.scale;
    // Rounded down to three digits, so that the advice does fit.
    let digits = libm::pow(10.0, 2.0 - libm::floor(libm::log10(scale)));
    let scale = libm::floor(scale * digits) / digits;
    let advice = if scale > 0.0 && digits.is_finite() {
        format!("use --scale {scale} or less, or turn it with --rotate")
    } else {
        "check the model and --scale".to_owned()
    };
    Err(Error::Unprintable(format!(
        "{file}: the model is {} mm and so {what} than the print volume of {} mm; {advice}",
        sides(&size),
        sides(&space)
    )))
}

/// Sizes or positions for a message.
pub(crate) fn sides(mm: &[f64]) -> String {
    let text: Vec<String> = mm.iter().map(|&mm| number(mm)).collect();
    text.join(" × ")
}

/// A length for a message: at most two decimals, and powers of ten for numbers
/// that only a damaged model or a wrong unit has.
pub(crate) fn number(mm: f64) -> String {
    if mm.abs() >= 1e6 { format!("{mm:.1e}") } else { format!("{}", (mm * 100.0).round() / 100.0) }
}

/// Where the layout's middle goes; refused if that pushes it off the bed.
pub(crate) fn offset(placement: &Placement, bed: &Bed, size: [f64; 3]) -> Result<[f64; 2]> {
    let middle = [0, 1].map(|axis| f64::midpoint(bed.min[axis], bed.max[axis]));
    let Some(at) = placement.at else {
        return Ok(middle);
    };
    let names = [["left", "right"], ["front", "back"]];
    let mut beyond = Vec::new();
    for axis in 0..2 {
        let low = bed.min[axis] - (at[axis] - size[axis] / 2.0);
        let high = at[axis] + size[axis] / 2.0 - bed.max[axis];
        for (over, name) in [low, high].into_iter().zip(names[axis]) {
            if over > 2.0 * HALF_UNIT_MM {
                // Rounded up, but not for the noise of the subtraction.
                let over = (over * 100.0 - 1e-6).ceil() / 100.0;
                beyond.push(format!("{} mm at the {name}", number(over)));
            }
        }
    }
    if beyond.is_empty() {
        return Ok(at);
    }
    Err(Error::Unprintable(format!(
        "--at {},{}: models of {} mm stick out of the bed by {}; the bed is x {} to {}, y {} to {} mm",
        at[0],
        at[1],
        sides(&size[..2]),
        beyond.join(" and "),
        number(bed.min[0]),
        number(bed.max[0]),
        number(bed.min[1]),
        number(bed.max[1])
    )))
}
