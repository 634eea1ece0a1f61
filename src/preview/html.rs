//! Print + Estimate -> HTML page: a viewer of one G-code file in a file of its own, without network.

use super::facts::Facts;
use super::packed;
use crate::estimate::Estimate;
use crate::reader::print::Print;
use crate::text;
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use std::io::{self, Write};

/// The page with `{{places}}` that are filled in.
const PAGE: &str = include_str!("viewer/viewer.html");

const STYLE: &str = include_str!("viewer/viewer.css");

/// The parts of the script in their order; they share one scope.
const SCRIPT: [&str; 9] = [
    include_str!("viewer/unpack.js"),
    include_str!("viewer/colour.js"),
    include_str!("viewer/webgl.js"),
    include_str!("viewer/canvas.js"),
    include_str!("viewer/scene.js"),
    include_str!("viewer/panel.js"),
    include_str!("viewer/ground.js"),
    include_str!("viewer/input.js"),
    include_str!("viewer/viewer.js"),
];

/// Writes the viewer's page of a print.
///
/// `name` stands in its title, `filament_diameter` in mm gives the volume of a length
/// of filament. The moves are in the page as [`packed`], deflated and in base64.
///
/// # Errors
/// What `out` gives.
pub fn write(
    print: &Print,
    estimate: &Estimate,
    name: &str,
    filament_diameter: f64,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut rest = PAGE;
    while let Some((before, place, after)) = next_place(rest) {
        out.write_all(before.as_bytes())?;
        match place {
            "name" => out.write_all(escaped(name).as_bytes())?,
            "style" => out.write_all(STYLE.as_bytes())?,
            "script" => SCRIPT.iter().try_for_each(|part| out.write_all(part.as_bytes()))?,
            "facts" => write_facts(&Facts::new(print, estimate, name, filament_diameter), out)?,
            "moves" => write_moves(print, out)?,
            _ => {}
        }
        rest = after;
    }
    out.write_all(rest.as_bytes())
}

/// What stands before the next `{{place}}`, its name, and what comes after it.
fn next_place(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once("{{")?;
    let (place, after) = rest.split_once("}}")?;
    Some((before, place, after))
}

/// As JSON that may stand in a script element: without `<` nothing can end it.
fn write_facts(facts: &Facts, out: &mut dyn Write) -> io::Result<()> {
    let json = serde_json::to_string(facts)?;
    let json = text::harmless(&json).replace('<', "\\u003c");
    out.write_all(json.as_bytes())
}

fn write_moves(print: &Print, out: &mut dyn Write) -> io::Result<()> {
    let mut deflated =
        DeflateEncoder::new(EncoderWriter::new(out, &STANDARD), Compression::default());
    packed::write(print, &mut deflated)?;
    deflated.finish()?.finish()?;
    Ok(())
}

/// As text of an element or of an attribute in double quotes.
fn escaped(text: &str) -> String {
    text::line(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
