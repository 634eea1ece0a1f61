//! Flags of placing -> Placement: how models are laid on the bed.

use super::words::{UNITS, factor, numbers, sunk, triangles, unit};
use clap::Args;
use slicer::mesh::place::GAP_MM;
use slicer::mesh::read::DEFAULT_MAX_TRIANGLES;
use slicer::mesh::{Placement, Policy};

/// How the models are laid on the bed.
#[derive(Debug, Args)]
#[command(next_help_heading = "Placing")]
pub(crate) struct PlaceArgs {
    /// Make the models larger or smaller by this factor
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = factor, allow_negative_numbers = true)]
    scale: f64,
    /// Turn the models about x, then y, then z, degrees
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", value_parser = numbers::<3>, allow_hyphen_values = true)]
    rotate: [f64; 3],
    /// Cut this much off the bottom of the models, mm
    #[arg(hide_short_help = true, long, value_name = "MM", default_value = "0", value_parser = sunk, allow_negative_numbers = true)]
    sink: f64,
    /// Put the middle of the layout here, mm [default: middle of the bed]
    #[arg(long, value_name = "X,Y", value_parser = numbers::<2>, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,
    /// Unit of the models' numbers
    #[arg(long, default_value = "mm", value_parser = UNITS)]
    unit: String,
    /// Print each model N times
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    copies: u32,
    /// Refuse models with more triangles, alone or together: 5 million take some 0.5 GB
    #[arg(hide_short_help = true, long, value_name = "N", default_value_t = DEFAULT_MAX_TRIANGLES, value_parser = triangles())]
    max_triangles: usize,
    /// What to do about faults of a mesh: mend it, slice it as it is, or refuse it
    #[arg(hide_short_help = true, long, value_name = "POLICY", default_value = "repair", value_parser = ["repair", "warn", "strict"])]
    mesh: String,
}

impl PlaceArgs {
    /// As the mesh stage takes it.
    pub(crate) fn placement(&self) -> Placement {
        Placement {
            gap: GAP_MM,
            unit: unit(&self.unit),
            scale: self.scale,
            stretch: [1.0; 3],
            rotate: self.rotate,
            sink: self.sink,
            at: self.at,
            taken: Vec::new(),
            copies: self.copies,
            max_triangles: self.max_triangles,
            policy: match self.mesh.as_str() {
                "warn" => Policy::Warn,
                "strict" => Policy::Strict,
                _ => Policy::Repair,
            },
        }
    }
}
