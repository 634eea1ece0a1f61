//! Layer and the one above -> Ironing: where the nozzle goes over what is seen from above once more.
//!
//! It smooths walls as well as skin, so that all of the layer counts that the layer above leaves bare. Its
//! lines lie closer to each other than those of any other raster: they have one of their own. On it, the
//! layer is drawn in by the inset, and what is above grown by the same.
//!
//! As with [`tops`](super::tops), a strip along what stands on the layer is left out if it is nowhere wide:
//! such are the steps of a slope.

use super::params::{IroningParams, NOISE};
use super::scan::Scan;
use crate::geom::raster::Raster;
use crate::geom::spans::{Rows, Span};
use crate::geom::{Contour, Point};
use crate::slice::Layer;

/// What is ironed of one layer.
#[derive(Debug, Clone)]
pub struct Ironing {
    /// The lines.
    pub raster: Raster,
    /// Where the middle of the nozzle goes.
    pub rows: Rows,
}

/// What is ironed of `layer`; `None` if nothing is. `above` is what lies on it.
#[must_use]
pub fn ironing(layer: &Layer, above: &[Contour], params: &IroningParams) -> Option<Ironing> {
    let chosen;
    let contours = if params.topmost {
        chosen = topmost(&layer.contours, above, &params.bodies);
        &chosen
    } else {
        &layer.contours
    };
    if contours.is_empty() {
        return None;
    }
    let raster = params.rasters[layer.index % 2];
    let inside = Scan::new(contours, raster).inset(params.inset);
    let cover = Scan::new(above, raster).outset(params.inset);
    let rows = bare(inside, &cover, params, raster);
    (!rows.is_empty()).then_some(Ironing { raster, rows })
}

/// The part of `inside` that `cover` leaves bare, without what is narrow beside it.
fn bare(inside: Rows, cover: &Rows, params: &IroningParams, raster: Raster) -> Rows {
    let long = |_, span: Span| span.len() >= i64::from(params.least);
    let hidden = inside.and(cover).filter(|_, span| span.len() >= NOISE);
    if hidden.is_empty() {
        return inside.filter(long);
    }
    let bare = inside.minus(cover).filter(long);
    if bare.is_empty() {
        return bare;
    }
    let inmost = bare.minus(&hidden.dilate(params.narrow, raster.pitch));
    if inmost.is_empty() {
        return inmost;
    }
    bare.and(&inmost.dilate(params.narrow, raster.pitch)).filter(long)
}

/// The `contours` of bodies that end here: nothing of `above` lies in their boxes.
fn topmost(contours: &[Contour], above: &[Contour], bodies: &[[Point; 2]]) -> Vec<Contour> {
    let holds = |[low, high]: &[Point; 2], contour: &Contour| {
        let is_in = |p: &Point| low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y;
        contour.first().is_some_and(is_in)
    };
    let ends = |body: &&[Point; 2]| !above.iter().any(|contour| holds(body, contour));
    let ending: Vec<&[Point; 2]> = bodies.iter().filter(ends).collect();
    let ends_here = |contour: &&Contour| ending.iter().any(|body| holds(body, contour));
    contours.iter().filter(ends_here).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile;
    use crate::region::RegionParams;
    use crate::units::Coord;
    use std::sync::Arc;

    fn params(place: &str) -> IroningParams {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        settings.ironing.place = match place {
            "top" => profile::IroningPlace::Top,
            _ => profile::IroningPlace::Topmost,
        };
        RegionParams::new(&settings).ironing.unwrap()
    }

    fn layer(squares: &[[Coord; 3]]) -> Arc<Layer> {
        let square = |&[x, y, side]: &[Coord; 3]| {
            [(0, 0), (1, 0), (1, 1), (0, 1)]
                .map(|(a, b)| Point { x: x + a * side, y: y + b * side })
        };
        let contours = squares.iter().map(|s| square(s).to_vec()).collect();
        Arc::new(Layer { index: 4, z: 10_000, height: 2_000, contours, closed_gap: 0 })
    }

    /// Ironed area, mm².
    fn area(below: &[[Coord; 3]], above: Option<&[[Coord; 3]]>, params: &IroningParams) -> f64 {
        let above = above.map_or_else(Vec::new, |above| layer(above).contours.clone());
        let Some(Ironing { raster, rows }) = ironing(&layer(below), &above, params) else {
            return 0.0;
        };
        rows.total() as f64 * f64::from(raster.pitch) / 1e8
    }

    #[test]
    fn all_that_is_bare_is_ironed_but_for_the_inset_around() {
        let params = params("top");
        let whole = area(&[[0, 0, 200_000]], None, &params);
        assert!((whole - 19.6 * 19.6).abs() < 2.0, "{whole}");
        let half = area(&[[0, 0, 200_000]], Some(&[[-100_000, 0, 200_000]]), &params);
        assert!((half - 9.6 * 19.6).abs() < 2.0, "{half}");
        assert_eq!(area(&[[0, 0, 200_000]], Some(&[[0, 0, 200_000]]), &params), 0.0);
    }

    #[test]
    fn steps_of_a_slope_are_not_ironed_but_what_stands_apart_is() {
        let params = params("top");
        let step = [10_000, 10_000, 180_000];
        assert_eq!(area(&[[0, 0, 200_000]], Some(&[step]), &params), 0.0);
        let apart = area(&[[0, 0, 200_000], [300_000, 0, 12_000]], Some(&[step]), &params);
        assert!((apart - 0.64).abs() < 0.1, "{apart}");
    }

    #[test]
    fn the_highest_layer_of_each_body_is_the_topmost() {
        let at = |x: Coord| [Point { x, y: 0 }, Point { x: x + 200_000, y: 200_000 }];
        let params = IroningParams { bodies: vec![at(0), at(300_000)], ..params("topmost") };
        let two = [[0, 0, 200_000], [300_000, 0, 200_000]];
        let both = area(&two, None, &params);
        let one = area(&two, Some(&[[300_000, 0, 100_000]]), &params);
        assert!(both > 0.0 && (2.0 * one - both).abs() < 1.0, "{one} of {both}");
        assert_eq!(area(&[[0, 0, 200_000]], Some(&[[0, 0, 50_000]]), &params), 0.0);
    }
}
