//! `slicer estimate` -> how long G-code files take, as a table or as JSON.
//!
//! 1. Each file is read and timed by itself: by the limits of `-p`, or else by those in its own settings. Where
//!    there are none it is timed by the default printer's, with a warning.
//! 2. The *print time* is that from the first layer to the last line, as files and summaries tell it; that of the
//!    *whole file* has start and end block, too.
//! 3. One file has a table, and of several each has a line.
//! 4. JSON is an object for one file, and for several one on each line, also for one that cannot be read.

use super::args::EstimateArgs;
use super::clock::{self, LimitsBy};
use super::{Outcome, failed, failure, say_line};
use anyhow::Result;
use slicer::estimate::{Estimate, LayerTime, NotCounted};
use slicer::steps;
use slicer::warning::plural;
use std::ffi::OsStr;

/// What standard output gets: of one file a table or an object, of several a line each. One of several that
/// cannot be read keeps no other from being timed, and the highest exit code holds.
///
/// # Errors
/// A profile or setting that is wrong; of a single file that it cannot be read or holds no move.
pub(super) fn run(args: &EstimateArgs) -> Result<Outcome> {
    if let [file] = args.files.as_slice() {
        return one(args, file, false).map(Outcome::from);
    }
    if args.files.iter().filter(|file| *file == "-").count() > 1 {
        return Err(failure::usage("`-` is given twice; standard input holds one file"));
    }
    // What is wrong with a profile is wrong for all of them.
    args.profiles.load([])?;
    let mut all = Outcome { text: String::new(), code: 0 };
    for file in &args.files {
        match one(args, file, true) {
            Ok(text) => all.text += &text,
            Err(error) => {
                let (code, line) = (failure::exit_code(&error), failure::line(&error));
                say_line("error", &line);
                all.code = all.code.max(code);
                if args.json {
                    all.text += &failed::row(file, code, line, &error)?;
                }
            }
        }
    }
    Ok(all)
}

/// What is said of a file, which may be one of several.
fn one(args: &EstimateArgs, file: &OsStr, is_one_of_many: bool) -> Result<String> {
    let opened = args.reading.open(file)?;
    let timed = clock::estimate(&opened, &args.profiles, &args.reading, args.fixed_limits)?;
    let mut source = opened.source.reader();
    let rates =
        steps::highest_rates(&mut source, timed.reading, &timed.settings, args.fixed_limits);
    let rates = rates.map_err(|error| opened.unreadable(error))?;
    let (found, limits, name) = (timed.estimate, timed.limits, &opened.name);
    // A printer that is one's own default is meant.
    if timed.by == LimitsBy::Default && args.profiles.shelf.shelf().default_printer().path.is_none()
    {
        let told = format!(
            "{name}: the file holds no settings of this program, since it is of another or cut off; timed by the \
             limits of {limits}: name its printer with -p"
        );
        say_line("warning", told);
    }
    if args.json {
        let line_of = is_one_of_many.then_some(name.as_str());
        return clock::json(line_of, &found, &limits, Some(timed.by), rates.map(Into::into));
    }
    if is_one_of_many {
        return Ok(
            line(name, &found) + &if args.layers { layers(&found.layers) } else { String::new() }
        );
    }
    let mut text = table(&found);
    if let Some([x, y, z, e]) = rates {
        text.push_str(&format!("steps/s at most: x {x:.0}, y {y:.0}, z {z:.0}, e {e:.0}\n"));
    }
    text.push_str(&format!("timed by the limits of {limits}\n"));
    if args.layers {
        text.push_str(&layers(&found.layers));
    }
    Ok(text)
}

/// A line for people.
fn line(name: &str, found: &Estimate) -> String {
    format!(
        "{name}: print time {}, whole file {}, filament {:.1} mm\n",
        clock(found.print_seconds),
        clock(found.seconds),
        found.filament_mm
    )
}

/// For people.
fn table(found: &Estimate) -> String {
    let told = "  from the first layer to the last line, as files and summaries tell it";
    let mut text = row("print time", found.print_seconds, None, told) + &ends(found);
    for role in &found.roles {
        let count = plural(role.moves, "move");
        let moves = format!("{count:>15} {:>12.1} mm", role.length_mm);
        text.push_str(&row(role.role.name(), role.seconds, Some(found.seconds), &moves));
    }
    if found.dwell_seconds > 0.0 {
        text.push_str(&row("dwell", found.dwell_seconds, Some(found.seconds), ""));
    }
    let layer = |number: usize| found.layers.get(number.wrapping_sub(1)).map(|one| (number, one));
    if let (Some((longest, most)), Some((shortest, least))) =
        (layer(found.longest_layer), layer(found.shortest_layer))
    {
        text.push_str(&format!(
            "{}: layer {longest} at {} mm takes longest, {:.1} s; layer {shortest} at {} mm least, {:.1} s\n",
            plural(found.layers.len() as u64, "layer"),
            millimetres(most),
            most.seconds,
            millimetres(least),
            least.seconds,
        ));
    }
    text.push_str(&format!(
        "filament {:.1} mm, at most {:.1} mm³/s\n{}",
        found.filament_mm,
        found.peak_flow_mm3_s,
        not_counted(&found.not_counted)
    ));
    text
}

/// All of the time. What of it is no printing, the summary and the file's own comments leave out.
fn ends(found: &Estimate) -> String {
    let [start, end] = [found.start_seconds, found.end_seconds].map(clock);
    let with = format!("  with {start} until the first layer and {end} after the last line");
    row("whole file", found.seconds, None, &with)
}

fn row(name: &str, seconds: f64, of: Option<f64>, more: &str) -> String {
    let share = of.map_or_else(String::new, |all| format!("{:>5.1} %", 100.0 * seconds / all));
    format!("{name:<12} {:>9} {share}{more}", clock(seconds)).trim_end().to_owned() + "\n"
}

/// What is in the file but not in the time, in a line of its own, if anything.
fn not_counted(not: &NotCounted) -> String {
    let mut parts = Vec::new();
    for (count, name) in [
        (not.heating, "wait for heat"),
        (not.homing, "homing"),
        (not.pauses, "pause"),
        (not.firmware_retractions, "firmware retraction"),
    ] {
        match (count, name) {
            (0, _) => {}
            (1, "wait for heat" | "homing") => parts.push(name.to_owned()),
            (_, "wait for heat") => parts.push(format!("{count} waits for heat")),
            (_, "homing") => parts.push(format!("{count} times homing")),
            _ => parts.push(plural(count, name)),
        }
    }
    if not.coarse_arcs > 0 {
        parts.push(format!("{} in full", plural(not.coarse_arcs, "huge arc")));
    }
    if not.unknown_lines > 0 {
        let lines = plural(not.unknown_lines, "unknown line");
        parts.push(format!("{lines} (the first is line {})", not.first_unknown_line));
    }
    if parts.is_empty() { String::new() } else { format!("not counted: {}\n", parts.join(", ")) }
}

/// One line a layer: number, height, time.
fn layers(layers: &[LayerTime]) -> String {
    let line = |(index, layer): (usize, &LayerTime)| {
        format!("{:>6} {:>9} mm {:>9.2} s\n", index + 1, millimetres(layer), layer.seconds)
    };
    layers.iter().enumerate().map(line).collect()
}

/// Micrometres are enough for a height, and sums of layers end in long tails.
fn millimetres(layer: &LayerTime) -> f64 {
    (layer.z_mm * 1000.0).round() / 1000.0
}

/// Hours, minutes and seconds.
fn clock(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_written_as_on_a_clock() {
        assert_eq!(clock(0.4), "0:00:00");
        assert_eq!(clock(59.6), "0:01:00");
        assert_eq!(clock(360_061.0), "100:01:01");
    }

    #[test]
    fn what_does_not_occur_is_not_listed() {
        assert_eq!(not_counted(&NotCounted::default()), "");
        let not = NotCounted { heating: 2, unknown_lines: 1, first_unknown_line: 7, ..not_any() };
        assert_eq!(
            not_counted(&not),
            "not counted: 2 waits for heat, 1 unknown line (the first is line 7)\n"
        );
    }

    fn not_any() -> NotCounted {
        NotCounted::default()
    }
}
