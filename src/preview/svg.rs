//! Drawing -> SVG: text, in mm of the bed, as short as it can be.
//!
//! The scene is a group whose matrix leads from mm to pixels, so that its numbers are places on the
//! bed, and what is printed can be read from the file. The page around it is in pixels.
//!
//! Strokes that look alike are one path, painted once for each coat: `use` repeats it with another width
//! and colour. A filled outline is such a path, closed, with a fill. Numbers have two decimals, or
//! three in a picture that shows so much, and no zeros that mean nothing. A path goes from point to
//! point by differences: they are shorter.

use super::colours::{Colour, INK, PAPER};
use super::drawing::{Anchor, Drawing, Kind, Mark, Stroke};
use crate::text;
use std::fmt::Write as _;

/// Height of letters over height of lines of text.
const LETTERS: f64 = 0.8;

/// Half the height of capitals over height of letters: from a text's middle to its base line.
const HALF_CAPITAL: f64 = 0.36;

/// Writes a drawing.
#[must_use]
pub fn write(drawing: &Drawing) -> String {
    let [width, height] = drawing.size;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\">\n<title>{}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n",
        escaped(&drawing.title),
        PAPER.hex()
    );
    scene(drawing, &mut out);
    page(drawing, &mut out);
    out.push_str("</svg>\n");
    out
}

/// The strokes, in mm: what is on the bed can be read from the file.
fn scene(drawing: &Drawing, out: &mut String) {
    let (scale, [x, y]) = (drawing.view.scale, drawing.view.origin);
    let matrix = [scale, 0.0, 0.0, -scale, x, y].map(|number| short(number, 3)).join(" ");
    put(
        out,
        format_args!(
            "<g transform=\"matrix({matrix})\" fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
        ),
    );
    // Rounding moves nothing by more than an eighth of a pixel.
    let decimals = if scale <= 25.0 { 2 } else { 3 };
    for (number, group) in drawing.groups().enumerate() {
        paths(group, number, decimals, out);
    }
    out.push_str("</g>\n");
}

/// Strokes that look alike: one path, painted once for each coat.
fn paths(group: &[Stroke], number: usize, decimals: usize, out: &mut String) {
    let look = group[0].look;
    let coats = look.coats();
    let several = coats.len() > 1;
    for (k, (width, colour)) in coats.into_iter().enumerate() {
        let paint = format!("stroke=\"{}\" stroke-width=\"{}\"", colour.hex(), short(width, 3));
        if k > 0 {
            put(out, format_args!("<use href=\"#p{number}\" {paint}/>\n"));
            continue;
        }
        let more = match look.kind {
            Kind::Dashed(dash) => {
                let dash = short(f64::from(dash) * look.width, 3);
                format!(" stroke-linecap=\"butt\" stroke-dasharray=\"{dash}\"")
            }
            Kind::Outline => format!(" fill=\"{}\"", look.colour.hex()),
            Kind::Bead | Kind::PaleBead | Kind::Plain => String::new(),
        };
        // What paints lies around the path, so that its second coat can differ.
        let id = if several { format!(" id=\"p{number}\"") } else { String::new() };
        put(out, format_args!("<g {paint}{more}><path{id} d=\""));
        group.iter().for_each(|stroke| path(stroke, decimals, out));
        out.push_str("\"/></g>\n");
    }
}

/// `M` and the first point, then the way from point to point.
fn path(stroke: &Stroke, decimals: usize, out: &mut String) {
    let unit = if decimals == 2 { 100.0 } else { 1000.0 };
    let grid = |at: &[f64; 2]| at.map(|at| (at * unit).round());
    let mut points = stroke.points.iter().map(grid);
    let Some(mut at) = points.next() else { return };
    let number = |on_grid: f64| short(on_grid / unit, decimals);
    pair("M", [number(at[0]), number(at[1])], out);
    let mut letter = "l";
    for next in points {
        pair(letter, [number(next[0] - at[0]), number(next[1] - at[1])], out);
        (at, letter) = (next, " ");
    }
    if stroke.look.kind == Kind::Outline {
        out.push('z');
    }
}

/// Two numbers of a path. A minus needs no blank before it.
fn pair(before: &str, [x, y]: [String; 2], out: &mut String) {
    let before = if before == " " && x.starts_with('-') { "" } else { before };
    let between = if y.starts_with('-') { "" } else { " " };
    put(out, format_args!("{before}{x}{between}{y}"));
}

fn page(drawing: &Drawing, out: &mut String) {
    let size = drawing.text.height() * LETTERS;
    out.push_str("<g shape-rendering=\"crispEdges\">\n");
    for mark in drawing.page.iter().filter(|mark| !matches!(mark, Mark::Text { .. })) {
        match mark {
            Mark::Line { from, to, width, colour } => line(*from, *to, *width, *colour, out),
            Mark::Rectangle { at, size, colour } => rectangle(*at, *size, *colour, out),
            Mark::Text { .. } => {}
        }
    }
    out.push_str("</g>\n");
    let ink = INK.hex();
    put(
        out,
        format_args!(
            "<g font-family=\"sans-serif\" font-size=\"{}\" fill=\"{ink}\">\n",
            short(size, 2)
        ),
    );
    for mark in &drawing.page {
        if let Mark::Text { at, anchor, text } = mark {
            let anchor = match anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            };
            let (x, y) = (short(at[0], 2), short(at[1] + HALF_CAPITAL * size, 2));
            let text = escaped(text);
            put(out, format_args!("<text x=\"{x}\" y=\"{y}\"{anchor}>{text}</text>\n"));
        }
    }
    out.push_str("</g>\n");
}

fn line(from: [f64; 2], to: [f64; 2], width: f64, colour: Colour, out: &mut String) {
    let [x1, y1, x2, y2] = [from[0], from[1], to[0], to[1]].map(|number| short(number, 2));
    let (colour, width) = (colour.hex(), short(width, 2));
    put(
        out,
        format_args!(
            "<path d=\"M{x1} {y1}L{x2} {y2}\" stroke=\"{colour}\" stroke-width=\"{width}\"/>\n"
        ),
    );
}

fn rectangle(at: [f64; 2], size: [f64; 2], colour: Colour, out: &mut String) {
    let [x, y, width, height] = [at[0], at[1], size[0], size[1]].map(|number| short(number, 2));
    let colour = colour.hex();
    put(
        out,
        format_args!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{colour}\"/>\n"
        ),
    );
}

/// Appends; a string takes everything.
fn put(out: &mut String, text: std::fmt::Arguments) {
    let _ = out.write_fmt(text);
}

/// A number with at most this many decimals, without zeros that mean nothing.
fn short(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    match text {
        "-0" | "" => "0".to_owned(),
        _ if text.starts_with("0.") => text[1..].to_owned(),
        _ if text.starts_with("-0.") => format!("-{}", &text[2..]),
        _ => text.to_owned(),
    }
}

/// As text of XML.
fn escaped(text: &str) -> String {
    text::line(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (number, text) in [
            (0.0, "0"),
            (-0.0001, "0"),
            (0.5, ".5"),
            (-0.25, "-.25"),
            (100.0, "100"),
            (12.3456, "12.346"),
            (-3.1, "-3.1"),
        ] {
            assert_eq!(short(number, 3), text);
        }
        assert_eq!(short(100.0, 0), "100");
    }

    #[test]
    fn text_is_no_markup() {
        assert_eq!(escaped("a<b & c>"), "a&lt;b &amp; c&gt;");
    }
}
