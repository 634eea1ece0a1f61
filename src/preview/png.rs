//! Drawing -> PNG: pixels with smooth edges, no window, no fonts of the system.

use super::colours::{Colour, INK, PAPER};
use super::drawing::{Anchor, Drawing, Kind, Mark, Stroke};
use super::text::TextSize;
use nalgebra::Vector2;
use std::io;
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Rect, Stroke as Pen, StrokeDash,
    Transform,
};

/// Writes a drawing.
///
/// # Errors
/// A picture larger than memory or the format allows.
pub fn write(drawing: &Drawing) -> io::Result<Vec<u8>> {
    let [width, height] = drawing.size;
    let mut pixels = Pixmap::new(width, height)
        .ok_or_else(|| io::Error::other(format!("no picture of {width} x {height} pixels")))?;
    pixels.fill(ink(PAPER));
    for group in drawing.groups() {
        strokes(drawing, group, &mut pixels);
    }
    for mark in &drawing.page {
        match mark {
            Mark::Line { from, to, width, colour } => {
                line(*from, *to, *width, *colour, &mut pixels);
            }
            Mark::Rectangle { at, size, colour } => rectangle(*at, *size, *colour, &mut pixels),
            Mark::Text { at, anchor, text } => {
                letters(drawing.text, *at, *anchor, text, &mut pixels);
            }
        }
    }
    encode(&pixels)
}

fn strokes(drawing: &Drawing, group: &[Stroke], pixels: &mut Pixmap) {
    let look = group[0].look;
    let mut path = PathBuilder::new();
    for stroke in group {
        for (k, &point) in stroke.points.iter().enumerate() {
            let [x, y] = drawing.view.pixel(point).map(|at| at as f32);
            if k == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        if look.kind == Kind::Outline {
            path.close();
        }
    }
    let Some(path) = path.finish() else { return };
    if look.kind == Kind::Outline {
        let (paint, rule) = (paint(look.colour), FillRule::Winding);
        pixels.fill_path(&path, &paint, rule, Transform::identity(), None);
    }
    for (width, colour) in look.coats() {
        let width = (width * drawing.view.scale) as f32;
        let (line_cap, dash) = match look.kind {
            Kind::Dashed(dash) => {
                let dash = f32::from(dash) * width;
                (LineCap::Butt, StrokeDash::new(vec![dash, dash], 0.0))
            }
            Kind::Bead | Kind::PaleBead | Kind::Outline | Kind::Plain => (LineCap::Round, None),
        };
        let pen = Pen { width, line_cap, line_join: LineJoin::Round, dash, ..Pen::default() };
        pixels.stroke_path(&path, &paint(colour), &pen, Transform::identity(), None);
    }
}

fn line(from: [f64; 2], to: [f64; 2], width: f64, colour: Colour, pixels: &mut Pixmap) {
    // Lines of the page lie along the axes: as a rectangle on whole pixels they are sharp.
    let half = width / 2.0;
    let (low, high) = Vector2::from(from).inf_sup(&to.into());
    let low = low.add_scalar(-half).map(f64::round);
    let size = (high.add_scalar(half).map(f64::round) - low).map(|side| side.max(1.0));
    rectangle(low.into(), size.into(), colour, pixels);
}

fn rectangle(at: [f64; 2], size: [f64; 2], colour: Colour, pixels: &mut Pixmap) {
    let [x, y] = at.map(|at| at.round() as f32);
    let [width, height] = size.map(|side| side.round() as f32);
    if let Some(rectangle) = Rect::from_xywh(x, y, width, height) {
        pixels.fill_rect(rectangle, &paint(colour), Transform::identity(), None);
    }
}

fn letters(size: TextSize, at: [f64; 2], anchor: Anchor, text: &str, pixels: &mut Pixmap) {
    let width = text.chars().count() as f64 * size.advance();
    let before = match anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => width / 2.0,
        Anchor::End => width,
    };
    let (left, top) = ((at[0] - before).round(), (at[1] - size.height() / 2.0).round());
    let (columns, rows) = (pixels.width() as usize, pixels.height() as usize);
    size.pixels(text, &mut |column, row, strength| {
        let (x, y) = (left + column as f64, top + row as f64);
        if x < 0.0 || y < 0.0 || x as usize >= columns || y as usize >= rows {
            return;
        }
        let dot = &mut pixels.pixels_mut()[y as usize * columns + x as usize];
        let below = Colour([dot.red(), dot.green(), dot.blue()]);
        *dot = ink(below.mixed(INK, f64::from(strength) / 255.0)).premultiply().to_color_u8();
    });
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(ink(colour));
    paint
}

fn ink(Colour([red, green, blue]): Colour) -> tiny_skia::Color {
    tiny_skia::Color::from_rgba8(red, green, blue, 255)
}

fn encode(pixels: &Pixmap) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    // Nothing shows through: three bytes a pixel are all.
    let colours: Vec<u8> =
        pixels.data().chunks_exact(4).flat_map(|dot| &dot[..3]).copied().collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&colours)?;
    writer.finish()?;
    Ok(bytes)
}
