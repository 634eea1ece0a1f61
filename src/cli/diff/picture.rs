//! Difference -> a picture of the worst layer, or a page with the worst ones and what is said of them.

use super::text;
use crate::cli::failure::{self, writing};
use crate::cli::output::Sink;
use crate::cli::usage;
use anyhow::{Context as _, Result};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use slicer::diff::{Both, Difference, File, Finding, Strand};
use slicer::preview::both::{self, Whose};
use slicer::preview::drawing::Drawing;
use slicer::preview::{png, svg};
use std::ffi::OsStr;
use std::io::Write as _;
use std::path::Path;

/// Pictures in a page.
const MOST: usize = 6;

/// Findings that stand under a picture.
const MOST_SAID: usize = 4;

/// Pixels of a picture's longer side.
const SIZE: u32 = 1200;

/// The page, whose `{}` places are filled in.
const STYLE: &str = "body{font-family:sans-serif;max-width:1240px;margin:1em auto;padding:0 1em;\
                     color:#333}pre{overflow-x:auto;background:#f5f5f5;padding:.8em}\
                     img{max-width:100%;height:auto}li{margin:.2em 0}";

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Svg,
    Png,
    Html,
}

/// A layer that is shown.
struct Sight {
    layer: Both<Option<usize>>,
    /// The worst place.
    ring: Option<[f64; 2]>,
    /// Findings that are to be seen there.
    said: Vec<String>,
}

/// Gives the strands of layers; `true` shows a moved print where it lies.
pub(super) type Views<'a> = &'a dyn Fn(&[Both<Option<usize>>], bool) -> Result<Vec<Vec<Strand>>>;

/// The format that the output's ending names.
///
/// # Errors
/// [`failure::Usage`] for any other ending, or if it would replace one of the files.
pub(super) fn format(out: &Path, files: [&OsStr; 2]) -> Result<Format> {
    for file in files {
        usage::replaces(out, file)?;
    }
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("svg") => Ok(Format::Svg),
        Some("png") => Ok(Format::Png),
        Some("html") => Ok(Format::Html),
        _ => Err(failure::usage(format!(
            "-o {}: the ending tells no format; use .html, .svg or .png",
            slicer::text::name(out)
        ))),
    }
}

/// Writes the picture or the page. `text` is what is said of the files, `names` are theirs.
///
/// # Errors
/// An output that cannot be written, a file that cannot be read any more.
pub(super) fn write(
    mut sink: Sink,
    format: Format,
    found: &Difference,
    (names, text): ([&str; 2], &str),
    views: Views<'_>,
    out: &Path,
) -> Result<()> {
    let mut sights = sights(found);
    // Of a print that only moved, the move itself is to be seen.
    let in_place = found.moved_mm.is_some() && sights.is_empty();
    if sights.is_empty() {
        let middle = found.pairs.get(found.pairs.len().div_ceil(2)).or(found.pairs.last());
        let layer = middle.map_or(Both { a: None, b: None }, |pair| pair.layer);
        sights.push(Sight { layer, ring: None, said: Vec::new() });
    }
    sights.truncate(if format == Format::Html { MOST } else { 1 });
    let mut bytes = Vec::new();
    let mut pictures = String::new();
    let layers: Vec<Both<Option<usize>>> = sights.iter().map(|sight| sight.layer).collect();
    for (sight, strands) in sights.iter().zip(views(&layers, in_place)?) {
        let drawing = draw(sight, found, strands);
        match format {
            Format::Svg => bytes = svg::write(&drawing).into_bytes(),
            Format::Png => bytes = png::write(&drawing).with_context(|| writing(out))?,
            Format::Html => pictures.push_str(&figure(&drawing, &sight.said)),
        }
    }
    if format == Format::Html {
        bytes = page(names, text, &pictures).into_bytes();
    }
    let done = sink.write_all(&bytes).and_then(|()| sink.flush());
    done.with_context(|| writing(out))?;
    sink.commit()
}

/// The layers where findings are to be seen, the worst first.
fn sights(found: &Difference) -> Vec<Sight> {
    let mut sights: Vec<Sight> = Vec::new();
    let last = Both { a: Some(found.layers.a), b: Some(found.layers.b) };
    for finding in &found.findings {
        let mut layers = finding.layers();
        if let Finding::Travels { layer: None, .. } | Finding::Order { layer: None, .. } = finding {
            layers = vec![last];
        }
        for mut layer in layers {
            // What comes before the first layer is shown with it.
            if layer == (Both { a: Some(0), b: Some(0) }) {
                layer = Both { a: Some(1), b: Some(1) };
            }
            // What only one file has of a layer is shown beside what the other has there.
            let is_it = |pair: &Both<Option<usize>>| match layer {
                Both { a: None, b } => pair.b == b,
                Both { a, b: None } => pair.a == a,
                both => *pair == both,
            };
            layer = found.pairs.iter().map(|pair| pair.layer).find(is_it).unwrap_or(layer);
            let said = text::line(finding, found.tolerance_mm);
            let ring = finding.at_mm().filter(|_| found.moved_mm.is_none());
            let ring = ring.map(|[x, y, _]| [x, y]);
            match sights.iter_mut().find(|sight| sight.layer == layer) {
                Some(sight) => {
                    sight.ring = sight.ring.or(ring);
                    sight.said.push(said);
                }
                None => sights.push(Sight { layer, ring, said: vec![said] }),
            }
        }
    }
    sights
}

fn draw(sight: &Sight, found: &Difference, strands: Vec<Strand>) -> Drawing {
    let pair = found.pairs.iter().find(|pair| pair.layer == sight.layer);
    let z = pair.map_or(Both { a: None, b: None }, |pair| pair.z_mm);
    let number = |number: Option<usize>| number.map_or("none".to_owned(), |n| n.to_string());
    let height = |z: Option<f64>| z.map_or(String::new(), |z| format!(", z {}", text::short(z)));
    let heading = vec![
        format!("A: layer {}{}", number(sight.layer.a), height(z.a)),
        format!("B: layer {}{}", number(sight.layer.b), height(z.b)),
    ];
    let strands: Vec<both::Strand> = strands
        .into_iter()
        .map(|Strand { from, to, width, file }| {
            let whose = match file {
                None => Whose::Both,
                Some(File::A) => Whose::First,
                Some(File::B) => Whose::Second,
            };
            both::Strand { from, to, width, whose }
        })
        .collect();
    both::drawing(&strands, sight.ring, heading, SIZE)
}

fn figure(drawing: &Drawing, said: &[String]) -> String {
    let said: Vec<String> =
        said.iter().take(MOST_SAID).map(|line| format!("<li>{}</li>\n", escaped(line))).collect();
    let picture = STANDARD.encode(svg::write(drawing));
    let title = escaped(&drawing.title);
    format!(
        "<h2>{title}</h2>\n<ul>\n{}</ul>\n\
         <img alt=\"{title}\" src=\"data:image/svg+xml;base64,{picture}\">\n",
        said.concat()
    )
}

fn page([a, b]: [&str; 2], text: &str, pictures: &str) -> String {
    let (a, b, text) = (escaped(a), escaped(b), escaped(text));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <title>{a} and {b}</title>\n<style>{STYLE}</style>\n\
         <h1>What differs</h1>\n<p>A is {a}, B is {b}</p>\n<pre>{text}</pre>\n{pictures}</html>\n"
    )
}

/// As text of an element or of an attribute in double quotes; what a terminal would obey is no text.
fn escaped(text: &str) -> String {
    let kept = text.chars().filter(|c| !c.is_control() || *c == '\n').collect::<String>();
    kept.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
