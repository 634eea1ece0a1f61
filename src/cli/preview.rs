//! `slicer preview` -> pictures of what a G-code file prints, a page to look through it, or a picture of a model.
//!
//! What is made depends on the file and on the output's format:
//! - a model (STL) becomes one picture, a PNG, whatever else is asked;
//! - `.html` becomes the viewer's page with all layers, for which nothing can be chosen;
//! - `.svg` and `.png` show one layer, a patch of non-planar skin (`--patch`), an upright cut
//!   (`--cut`), or with `--all` each layer and each patch in a file of its own.
//!
//! All pictures of layers have the same frame, so that one can leaf through them, unless `--fit` fills
//! each with its layer or `--crop` sets the frame. A layer, cut or crop without a line is an error
//! that names what there is instead. Outputs are put in place only when all are written.

use super::output::{self, Sink};
use super::profiles::ProfileArgs;
use super::publish::publish;
use super::reading::ReadingArgs;
use super::texts::CODES;
use super::{failure, interrupt, model, say, say_line, usage, viewer, words};
use anyhow::{Context as _, Result};
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use slicer::mesh::read::DEFAULT_MAX_TRIANGLES;
use slicer::preview::cut::{Axis, Cut, Plane};
use slicer::preview::drawing::{Drawing, Frame};
use slicer::preview::stages::patches_in;
use slicer::preview::{layer, patch, png, svg};
use slicer::reader::{Cause, Print};
use slicer::text;
use std::ffi::OsString;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Digits of a layer's number in a file's name, at least.
const DIGITS: usize = 4;

/// Pixels of a picture's longer side.
const SIZE: u32 = 1200;

/// Makes a picture's bytes.
type Encode = fn(&Drawing) -> io::Result<Vec<u8>>;

/// Arguments of `preview`.
#[derive(Debug, Args)]
#[command(after_long_help = CODES)]
pub(crate) struct PreviewArgs {
    /// G-code file of any slicer, `-` for standard input; or an STL file, to see the model itself
    #[arg(value_name = "FILE")]
    file: OsString,
    /// Picture to write, .svg or .png, or .html to look through all layers; `-` writes standard output
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Format of OUT [default: by its ending]
    #[arg(long)]
    format: Option<Format>,
    /// Pixels of the longer side [default: 1200]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(400..=8000))]
    size: Option<u32>,
    /// Draw only this part: two corners, mm on the bed, or along a cut and in z
    #[arg(long, value_name = "X,Y,X,Y", value_parser = corners, allow_hyphen_values = true)]
    crop: Option<Frame>,

    /// Draw this layer, counted from 1 [default: the middle one, or that above if it has more in it]
    #[arg(long, value_name = "N", help_heading = "Layers")]
    layer: Option<usize>,
    /// Draw this patch of non-planar skin, coloured by height
    ///
    /// The layer below it leaves it out.
    #[arg(long, value_name = "N", conflicts_with = "layer", help_heading = "Layers")]
    patch: Option<u32>,
    /// Draw every layer; OUT.svg becomes OUT-0001.svg and so on
    #[arg(long, conflicts_with_all = ["layer", "patch"], help_heading = "Layers")]
    all: bool,
    /// Fill the picture with the layer
    ///
    /// Otherwise all layers have the same frame, that of the print.
    #[arg(long, conflicts_with = "crop", help_heading = "Layers")]
    fit: bool,
    /// Draw N layers below pale
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Layers")]
    below: usize,
    /// Draw travels
    #[arg(long, help_heading = "Layers")]
    travels: bool,

    /// Draw an upright cut through the print instead of a layer, such as x=12.5 (mm on the bed)
    #[arg(long, value_name = "AXIS=MM", value_parser = plane, conflicts_with_all = ["layer", "patch", "all", "fit", "below", "travels"], help_heading = "Cut")]
    cut: Option<Plane>,

    #[command(flatten)]
    reading: ReadingArgs,
    #[command(flatten)]
    profiles: ProfileArgs,
    /// Refuse a model with more triangles
    #[arg(hide_short_help = true, long, value_name = "N", default_value_t = DEFAULT_MAX_TRIANGLES, value_parser = words::triangles(), help_heading = "Model")]
    max_triangles: usize,
    /// Do not say which layer is drawn
    #[arg(short, long, help_heading = "Running")]
    quiet: bool,
}

impl PreviewArgs {
    /// The first flag given that only pictures of layers and cuts have.
    fn of_layers(&self) -> Option<&'static str> {
        let flags = [
            ("--crop", self.crop.is_some()),
            ("--layer", self.layer.is_some()),
            ("--patch", self.patch.is_some()),
            ("--all", self.all),
            ("--fit", self.fit),
            ("--below", self.below > 0),
            ("--travels", self.travels),
            ("--cut", self.cut.is_some()),
        ];
        flags.into_iter().find(|(_, given)| *given).map(|(flag, _)| flag)
    }
}

/// What a picture is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Lines, for any size
    Svg,
    /// Pixels
    Png,
    /// A page that shows every layer and move in a browser, without network
    Html,
}

/// Draws.
///
/// # Errors
/// Arguments, a profile or setting that is wrong, a file that cannot be read or prints
/// nothing, a layer or cut that it does not have, or an output that cannot be written.
pub(super) fn run(args: &PreviewArgs) -> Result<()> {
    let format = format(args)?;
    if args.all && output::is_stdout(&args.output) {
        let why = "--all writes a file for each layer; name OUT, such as -o layers.svg";
        return Err(failure::usage(why));
    }
    usage::replaces(&args.output, &args.file)?;
    interrupt::watch();
    if model::is_model(&args.file) {
        return model_itself(args, format);
    }
    let encode: Encode = match format {
        Format::Svg => |drawing| Ok(svg::write(drawing).into_bytes()),
        Format::Png => png::write,
        Format::Html => return page(args),
    };
    let (name, print) = read(args)?;
    match args.cut {
        Some(plane) => {
            let sink = Sink::open(&args.output)?;
            let drawing = cut(args, &name, &print, plane)?;
            finish(args, encode, sink, &drawing)
        }
        None if args.all => all(args, encode, &print),
        None => {
            let sink = Sink::open(&args.output)?;
            let drawing = one(args, &name, &print)?;
            finish(args, encode, sink, &drawing)
        }
    }
}

/// By `--format`, or by the output's ending.
fn format(args: &PreviewArgs) -> Result<Format> {
    if let Some(format) = args.format {
        return Ok(format);
    }
    let ending = args.output.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let known = Format::value_variants().iter().filter_map(Format::to_possible_value);
    let names: Vec<String> = known.map(|value| value.get_name().to_owned()).collect();
    let found = names.iter().position(|name| Some(name) == ending.as_ref());
    found.map(|k| Format::value_variants()[k]).ok_or_else(|| {
        let out = text::name(&args.output);
        let endings: Vec<String> = names.iter().map(|name| format!(".{name}")).collect();
        let endings = match endings.split_last() {
            Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
            None => String::new(),
        };
        failure::usage(format!(
            "-o {out}: the ending tells no format; use {endings}, or say --format"
        ))
    })
}

/// Draws a model, which has no layers yet.
fn model_itself(args: &PreviewArgs, format: Format) -> Result<()> {
    let file = text::name(&args.file);
    if let Some(flag) = args.of_layers() {
        return Err(failure::usage(format!("{flag}: {file} is a model; slice it first")));
    }
    if format != Format::Png {
        let why = format!("{file} is a model, whose picture is a PNG; use .png or --format png");
        return Err(failure::usage(why));
    }
    let mut sink = Sink::open(&args.output)?;
    let drawn = model::draw(&args.file, args.size.unwrap_or(SIZE), args.max_triangles)?;
    let done = sink.write_all(&drawn.png).and_then(|()| sink.flush());
    done.with_context(|| failure::writing(&args.output))?;
    sink.commit()?;
    for warning in &drawn.warnings {
        say_line("warning", warning);
    }
    if !args.quiet {
        say(&format!("{}\n", drawn.title));
    }
    Ok(())
}

/// The file's name for messages, and what it prints.
fn read(args: &PreviewArgs) -> Result<(String, Print)> {
    let profile = args.profiles.load([])?;
    let settings = &profile.settings;
    let machine = args.profiles.any().then_some(settings);
    let opened = args.reading.open(&args.file)?;
    let reading = args.reading.of(machine, opened.says);
    let diameter = settings.filament.diameter;
    let print = Print::read_as(&mut opened.source.reader(), reading, diameter)
        .map_err(|error| opened.unreadable(error))?;
    let name = opened.name;
    if layer::frame(&print, &print.layers).is_empty() {
        return Err(Cause::NothingToDraw.of(&name).into());
    }
    Ok((name, print))
}

fn one(args: &PreviewArgs, name: &str, print: &Print) -> Result<Drawing> {
    if let Some(number) = args.patch {
        return one_patch(args, name, print, number);
    }
    let count = print.layers.len();
    let number = args.layer.unwrap_or_else(|| layer::middle(print) + 1);
    if !(1..=count).contains(&number) {
        let layers = slicer::warning::plural(count as u64, "layer");
        let range =
            if count == 1 { "there is only 1".to_owned() } else { format!("choose 1 to {count}") };
        return Err(failure::usage(format!("--layer {number}: {name} has {layers}; {range}")));
    }
    let drawing = draw_layer(args, print, number - 1, frame(args, print));
    if drawing.scene.is_empty() {
        return Err(nothing_in_crop(name, layer::frame(print, &print.layers)));
    }
    Ok(drawing)
}

fn one_patch(args: &PreviewArgs, name: &str, print: &Print, number: u32) -> Result<Drawing> {
    let numbers = patch::numbers(print);
    if !numbers.contains(&number) {
        let there_is = match numbers.as_slice() {
            [] => "has no non-planar skin".to_owned(),
            [only] => format!("has only patch {only}"),
            [first, .., last] => format!("has patches from {first} to {last}"),
        };
        return Err(failure::usage(format!("--patch {number}: {name} {there_is}")));
    }
    let drawing = draw_patch(args, print, number, frame(args, print));
    if drawing.scene.is_empty() {
        return Err(nothing_in_crop(name, patch::frame(print, number)));
    }
    Ok(drawing)
}

fn cut(args: &PreviewArgs, name: &str, print: &Print, plane: Plane) -> Result<Drawing> {
    let cut = Cut::new(print, plane);
    if cut.sections.is_empty() {
        let whole = layer::frame(print, &print.layers);
        let (axis, k) = (plane.axis.name(), usize::from(plane.axis == Axis::Y));
        let (at, low, high) = (plane.at, whole.min[k], whole.max[k]);
        return Err(failure::usage(format!(
            "--cut {axis}={at}: nothing is printed there; {name} prints between {axis} = {low:.1} and {high:.1} mm"
        )));
    }
    let drawing =
        cut.drawing(plane, args.crop.unwrap_or_else(|| cut.frame()), args.size.unwrap_or(SIZE));
    if drawing.scene.is_empty() {
        return Err(nothing_in_crop(name, cut.frame()));
    }
    Ok(drawing)
}

/// A file for each layer and patch, or none.
fn all(args: &PreviewArgs, encode: Encode, print: &Print) -> Result<()> {
    let frame = frame(args, print);
    let batch = output::batch(&args.output)?;
    let pictures = pictures(args, print);
    let products = pictures.par_iter().enumerate().map(|(place, (name, index, patch))| {
        usage::replaces(name, &args.file)?;
        let mut sink = Sink::open_in(&batch, place, name)?;
        let drawing = match patch {
            Some(number) => draw_patch(args, print, *number, frame),
            None => draw_layer(args, print, *index, frame),
        };
        write(encode, &drawing, name, &mut sink)?;
        sink.close()
    });
    publish(products.collect::<Result<_>>()?)?;
    if !args.quiet
        && let (Some((first, ..)), Some((last, ..))) = (pictures.first(), pictures.last())
    {
        say(&format!("{} to {}\n", text::name(first), text::name(last)));
    }
    Ok(())
}

/// The names of all pictures: of each layer, counted from 0, and of the patches after it.
fn pictures(args: &PreviewArgs, print: &Print) -> Vec<(PathBuf, usize, Option<u32>)> {
    let count = print.layers.len();
    let mut pictures = Vec::with_capacity(count);
    for (index, layer) in print.layers.iter().enumerate() {
        let name = |skin: &str| numbered(&args.output, index + 1, count, skin);
        pictures.push((name(""), index, None));
        for number in patches_in(print, layer) {
            pictures.push((name(&format!("-skin-{number}")), index, Some(number)));
        }
    }
    pictures
}

fn draw_layer(args: &PreviewArgs, print: &Print, index: usize, frame: Frame) -> Drawing {
    let frame = if args.fit { layer::own_frame(print, index) } else { frame };
    layer::drawing(print, index, &options(args, frame))
}

fn draw_patch(args: &PreviewArgs, print: &Print, number: u32, frame: Frame) -> Drawing {
    let frame = if args.fit { patch::frame(print, number) } else { frame };
    patch::drawing(print, number, &options(args, frame))
}

fn options(args: &PreviewArgs, frame: Frame) -> layer::Options {
    let (size, below, travels) = (args.size.unwrap_or(SIZE), args.below, args.travels);
    layer::Options { size, below, travels, frame }
}

/// What pictures of layers show, unless each is to fill its own.
fn frame(args: &PreviewArgs, print: &Print) -> Frame {
    args.crop.unwrap_or_else(|| layer::frame(print, &print.layers))
}

fn nothing_in_crop(name: &str, whole: Frame) -> anyhow::Error {
    let [[x, y], [to_x, to_y]] = [whole.min, whole.max];
    failure::usage(format!(
        "--crop: nothing of {name} is printed there; all of it lies within {x:.1},{y:.1},{to_x:.1},{to_y:.1}"
    ))
}

fn finish(args: &PreviewArgs, encode: Encode, mut sink: Sink, drawing: &Drawing) -> Result<()> {
    write(encode, drawing, &args.output, &mut sink)?;
    sink.commit()?;
    if !args.quiet {
        say(&format!("{}\n", drawing.title));
    }
    Ok(())
}

fn write(encode: Encode, drawing: &Drawing, name: &Path, sink: &mut Sink) -> Result<()> {
    let done = encode(drawing).and_then(|bytes| sink.write_all(&bytes)).and_then(|()| sink.flush());
    done.with_context(|| failure::writing(name))
}

/// The page with all layers in it, for which nothing can be chosen.
fn page(args: &PreviewArgs) -> Result<()> {
    if let Some(flag) = args.size.map(|_| "--size").or(args.of_layers()) {
        return Err(failure::usage(format!(
            "{flag} is for pictures, and a page shows everything; leave it out, or write .svg or .png"
        )));
    }
    let summary = viewer::write(&args.file, &args.output, &args.profiles, &args.reading)?;
    if !args.quiet {
        say(&summary);
    }
    Ok(())
}

/// `a-0007.svg` for `a.svg`, and `a-0007-skin-1.svg` with `-skin-1` as what follows.
fn numbered(name: &Path, number: usize, count: usize, follows: &str) -> PathBuf {
    let digits = count.to_string().len().max(DIGITS);
    let mut file = name.file_stem().unwrap_or_default().to_owned();
    file.push(format!("-{number:0digits$}{follows}"));
    if let Some(ending) = name.extension() {
        file.push(".");
        file.push(ending);
    }
    name.with_file_name(file)
}

fn plane(text: &str) -> std::result::Result<Plane, String> {
    let wrong = || "it must be x=MM or y=MM, such as x=12.5".to_owned();
    let (axis, at) = text.split_once('=').ok_or_else(wrong)?;
    let axis = match axis.trim() {
        "x" | "X" => Axis::X,
        "y" | "Y" => Axis::Y,
        _ => return Err(wrong()),
    };
    let at: Option<f64> = at.trim().parse().ok();
    Ok(Plane { axis, at: at.filter(|at| at.is_finite()).ok_or_else(wrong)? })
}

fn corners(text: &str) -> std::result::Result<Frame, String> {
    let [x, y, to_x, to_y] = words::numbers(text)?;
    let mut frame = Frame::EMPTY;
    frame.include([x, y], 0.0);
    frame.include([to_x, to_y], 0.0);
    let [width, height] = frame.size();
    if width >= 0.1 && height >= 0.1 && width.max(height) <= 10_000.0 {
        Ok(frame)
    } else {
        Err("its sides must be 0.1 to 10000 mm".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_before_the_ending() {
        let named = |name: &str, count| numbered(Path::new(name), 7, count, "");
        assert_eq!(named("a.svg", 120), Path::new("a-0007.svg"));
        assert_eq!(named("dir.x/a.b.png", 12_000), Path::new("dir.x/a.b-00007.png"));
    }

    #[test]
    fn planes_and_corners_are_checked() {
        assert_eq!(plane("y=-3"), Ok(Plane { axis: Axis::Y, at: -3.0 }));
        assert!(plane("z=1").is_err() && plane("x=nan").is_err() && plane("x").is_err());
        assert_eq!(corners("5,6,1,2"), Ok(Frame { min: [1.0, 2.0], max: [5.0, 6.0] }));
        assert!(corners("1,1,1,2").is_err() && corners("1,1,1e9,2").is_err());
    }
}
