//! Difference -> text for people: a verdict, the sums of both files, and the worst differences.
//!
//! First a verdict in one line, with the tolerances. Then a table: for each role, and for all together,
//! length, filament and time in both files and how much more the second has, in percent; `!` marks
//! what exceeds the tolerance and decides. Then the findings, the worst first: the worst of each kind,
//! and as many more as fit into [`MOST_LISTED`] lines, since the first ten layers of the same fault
//! would hide all others. Settings in comments come last: they are listed, but decide nothing
//! unless `--settings` asks for it.
//!
//! Places are given with x, y, z and the line in both files, so that one can open both there. Layers
//! in a row are written as a range.

use slicer::diff::{
    Both, CodeDifference, Difference, File, Finding, Flow, Kind, Ordered, PartMoved, Place,
    Quantity, Setting, Sum,
};
use slicer::reader::Role;
use slicer::warning::plural;

/// Differences that are listed without `--all`.
const MOST_LISTED: usize = 10;

/// Width of the names of roles in the table, at least.
const LEAST_NAME: usize = 11;

/// Settings that are named where they do not decide.
const MOST_NAMED: usize = 5;

/// For people.
pub(super) fn text(found: &Difference, limits: &str, all: bool) -> String {
    let mut text = verdict(found);
    for row in table(found, limits).lines() {
        text.push_str(row.trim_end());
        text.push('\n');
    }
    let listed = listed(&found.findings, all);
    if !listed.is_empty() {
        text.push_str("\nworst first:\n");
    }
    for finding in &listed {
        text.push_str(&format!("  {}\n", line(finding, found.tolerance_mm)));
    }
    let left = found.findings.len() - listed.len();
    if left > 0 {
        text.push_str(&format!("  and {left} more; --all lists them\n"));
    }
    let listed_already = found.findings.iter().any(|one| one.kind() == Kind::Setting);
    if !found.settings.is_empty() && !listed_already {
        text.push_str(&settings(&found.settings, all));
    }
    text
}

fn verdict(found: &Difference) -> String {
    let within = format!("{} mm, {} %", found.tolerance_mm, found.sums_percent);
    if found.equal {
        return format!("equal within {within}\n\n");
    }
    let count = plural(found.findings.len() as u64, "difference");
    let farthest = found.findings.iter().filter_map(|finding| match finding {
        Finding::Lines { farthest, .. } => Some(farthest.distance_mm),
        _ => None,
    });
    let farthest = farthest.reduce(f64::max);
    let apart = farthest.map_or_else(String::new, |mm| format!(", lines up to {mm:.3} mm apart"));
    format!("not equal within {within}: {count}{apart}\n\n")
}

/// Sums of both files, side by side. `!` marks what is beyond the tolerances.
fn table(found: &Difference, limits: &str) -> String {
    let wide = found.roles.iter().map(|row| row.role.name().len() + 1).fold(LEAST_NAME, usize::max);
    let mut text = format!(
        "{:<wide$}{:^30}  {:^30}  {:^28}\n{:wide$}{}  {}  {}\n",
        "",
        "length, mm",
        "filament, mm",
        "time, s",
        "",
        heads(10),
        heads(10),
        heads(9)
    );
    for row in &found.roles {
        text.push_str(&format!(
            "{:<wide$}{}  {}  {}\n",
            row.role.name(),
            cells(&row.length_mm, 10, row.decides),
            cells(&row.filament_mm, 10, row.decides),
            cells(&row.time_s, 9, false)
        ));
    }
    text.push_str(&format!(
        "{:<wide$}{:30}  {}  {}\n",
        "all",
        "",
        cells(&found.filament_mm, 10, true),
        cells(&found.time_s, 9, true)
    ));
    let Both { a, b } = found.layers;
    let layers = if a == b { format!("{a} layers") } else { format!("{a} layers in A, {b} in B") };
    text.push_str(&format!("{layers}; timed by the limits of {limits}\n"));
    if let Both { a: Some(a), b: Some(b) } = found.extent_mm {
        let apart = (0..3).map(|k| (a.min[k] - b.min[k]).abs().max((a.max[k] - b.max[k]).abs()));
        let apart = apart.fold(0.0, f64::max);
        if found.moved_mm.is_none() && apart > found.tolerance_mm {
            text.push_str(&format!("the box around all lines differs by {apart:.3} mm\n"));
        }
    }
    text
}

fn heads(width: usize) -> String {
    format!("{:>width$}{:>width$}{:>9} ", "A", "B", "B - A")
}

/// A sum of either file and how much more the second one is.
fn cells(sum: &Sum, width: usize, decides: bool) -> String {
    let more = if sum.a == sum.b { "=".to_owned() } else { percent(sum.a, sum.b) };
    let mark = if decides && !sum.equal { "!" } else { " " };
    format!("{:>width$.1}{:>width$.1}{more:>9}{mark}", sum.a, sum.b)
}

fn percent(a: f64, b: f64) -> String {
    if a.abs() <= f64::EPSILON {
        return "new".to_owned();
    }
    let percent = 100.0 * (b - a) / a.abs();
    match percent.abs() {
        size if size < 0.005 => "~".to_owned(),
        size if size < 10.0 => format!("{percent:+.2}%"),
        _ => format!("{percent:+.0}%"),
    }
}

/// The worst of each kind, and then the worst of all.
fn listed(findings: &[Finding], all: bool) -> Vec<&Finding> {
    let first_of_kind = |k: usize| k == 0 || findings[k].kind() != findings[k - 1].kind();
    let firsts = (0..findings.len()).filter(|&k| first_of_kind(k)).count();
    let mut more = MOST_LISTED.saturating_sub(firsts);
    let mut chosen = Vec::new();
    for (k, finding) in findings.iter().enumerate() {
        if all || first_of_kind(k) {
            chosen.push(finding);
        } else if more > 0 {
            more -= 1;
            chosen.push(finding);
        }
    }
    chosen
}

/// One difference in one line.
pub(super) fn line(finding: &Finding, tolerance: f64) -> String {
    match finding {
        Finding::Moved { .. } | Finding::PartMoved(_) => moved(finding),
        Finding::Limits { difference } => format!("limits and waits: {}", codes(difference)),
        Finding::Travels { .. }
        | Finding::Order { .. }
        | Finding::Seams { .. }
        | Finding::Retractions { .. }
        | Finding::FirmwareRetractions { .. } => between_lines(finding, tolerance),
        Finding::LayersOnlyIn { file, layers, length_mm } => {
            format!("only in {}: {} ({length_mm:.1} mm of lines)", name(*file), runs(layers))
        }
        Finding::RoleOnlyIn { file, role, layers, patches, length_mm } => {
            let (role, file) = (role.name(), name(*file));
            let numbers: Vec<String> = patches.iter().map(u32::to_string).collect();
            let patches = match numbers.len() {
                0 => String::new(),
                1 => format!(" (patch {})", numbers[0]),
                _ => format!(" (patches {})", numbers.join(", ")),
            };
            format!("{role}{patches} only in {file}: {length_mm:.1} mm in {}", runs(layers))
        }
        Finding::Heights { count, layer, z_mm } => {
            let Both { a, b } = z_mm;
            let count = plural(*count as u64, "layer");
            format!("{count} at another height, most {}: z {a:.3} in A, {b:.3} in B", label(*layer))
        }
        Finding::Heaters { layer, difference } => {
            format!("{}: heaters: {}", place(*layer), codes(difference))
        }
        Finding::Commands { layer, difference } => {
            format!("{}: commands: {}", place(*layer), codes(difference))
        }
        Finding::Lines { layer, role, patch, length_mm, far_mm, farthest } => {
            let place = lines(&of(*role, *patch), *length_mm, *far_mm, farthest, tolerance);
            format!("{}: {place}", label(*layer))
        }
        Finding::Flow { layer, role, patch, unlike_mm, most_unlike } => {
            format!("{}: {}", label(*layer), flow(&of(*role, *patch), *unlike_mm, most_unlike))
        }
        Finding::Sum { layer, role, quantity, sum } => {
            let layer = layer.map_or_else(|| "whole file".to_owned(), label);
            let role = role.map_or_else(String::new, |role| format!("{} ", role.name()));
            let (what, unit) = match quantity {
                Quantity::Length => ("length", "mm"),
                Quantity::Filament => ("filament", "mm"),
                Quantity::Time => ("time", "s"),
                Quantity::AskedTime => ("time at the feeds asked for", "s"),
            };
            let Sum { a, b, .. } = *sum;
            let more = percent(a, b);
            format!("{layer}: {role}{what} {a:.2} {unit} in A, {b:.2} in B ({more})")
        }
        Finding::Setting(setting) => format!("setting {}", changed(setting)),
    }
}

/// What lies elsewhere as a whole.
fn moved(finding: &Finding) -> String {
    match finding {
        Finding::Moved { by_mm } => {
            let [x, y, z] = by_mm.map(short);
            let z = if by_mm[2] == 0.0 { String::new() } else { format!(", {z}") };
            format!("all moved by {x}, {y}{z} mm; the rest is compared as if it had not")
        }
        Finding::PartMoved(PartMoved { box_mm: [low, high], by_mm }) => {
            let [x, y] = by_mm.map(short);
            let span = |axis: usize| format!("{} to {}", short(low[axis]), short(high[axis]));
            format!(
                "the part at x {}, y {} moved by {x}, {y} mm; the rest is compared as if it had not",
                span(0),
                span(1)
            )
        }
        _ => String::new(),
    }
}

/// What the nozzle does between lines.
fn between_lines(finding: &Finding, tolerance: f64) -> String {
    match finding {
        Finding::Travels { layer, length_mm, far_mm, z_mm, farthest } => {
            let heights = |z: Option<[f64; 2]>| {
                z.map_or_else(
                    || "none".to_owned(),
                    |[low, high]| format!("z {low:.2} to {high:.2}"),
                )
            };
            format!(
                "{}: travels {}; {:.1} of {:.1} mm in A ({}) and {:.1} of {:.1} in B ({}) farther \
                 than {tolerance} mm",
                place(*layer),
                apart(farthest),
                far_mm.a,
                length_mm.a,
                heights(z_mm.a),
                far_mm.b,
                length_mm.b,
                heights(z_mm.b)
            )
        }
        Finding::Order { of, layers, layer, line, farthest } => {
            let farthest = farthest.as_ref().map_or_else(String::new, |place| {
                format!("; so travels are others, {}", apart(place))
            });
            let what = match of {
                Ordered::Lines => "lines are the same in another order or direction",
                Ordered::Travels => "travels are the same in another order",
            };
            let layers = in_layers(layers, *layer);
            format!("{layers}: {what}, from lines {} on{farthest}", numbers(*line))
        }
        Finding::Seams { role, layers, moved, layer, farthest } => {
            let walls = plural(moved.a.max(moved.b) as u64, "wall");
            format!(
                "{}: {walls} ({}) begin elsewhere, most in {}, {}",
                runs(layers),
                role.name(),
                label(*layer),
                apart(farthest)
            )
        }
        Finding::Retractions { layers, layer, pulled_mm: back, pushed_mm: forth } => format!(
            "{}: in {} {:.3} mm of filament are pulled back in A and {:.3} in B, {:.3} and {:.3} \
             pushed out again",
            in_layers(layers, *layer),
            place(*layer),
            back.a,
            back.b,
            forth.a,
            forth.b
        ),
        Finding::FirmwareRetractions { count } => {
            format!("retractions by the printer (G10, G11): {} in A, {} in B", count.a, count.b)
        }
        _ => String::new(),
    }
}

/// How far and where.
fn apart(Place { distance_mm, at_mm: [x, y, z], line }: &Place) -> String {
    let lines = numbers(*line);
    format!("{distance_mm:.3} mm apart at x {x:.3} y {y:.3} z {z:.3} (lines {lines})")
}

/// Layers, or what comes after them.
fn in_layers(layers: &[usize], first: Option<Both<usize>>) -> String {
    if layers.is_empty() { place(first) } else { runs(layers) }
}

/// A length in mm without zeros that say nothing.
pub(super) fn short(mm: f64) -> String {
    format!("{}", (mm * 1e4).round() / 1e4)
}

/// A role, and the patch that it is of.
fn of(role: Role, patch: Option<Both<Option<u32>>>) -> String {
    let patch = match patch {
        Some(Both { a: Some(a), b: Some(b) }) if a != b => format!(" (patch {a} in A, {b} in B)"),
        Some(Both { a: Some(number), .. } | Both { b: Some(number), .. }) => {
            format!(" (patch {number})")
        }
        _ => String::new(),
    };
    format!("{}{patch}", role.name())
}

fn lines(
    role: &str,
    length: Both<f64>,
    far: Both<f64>,
    farthest: &Place,
    tolerance: f64,
) -> String {
    format!(
        "{role} {}; {:.1} of {:.1} mm in A and {:.1} of {:.1} in B farther than {tolerance} mm",
        apart(farthest),
        far.a,
        length.a,
        far.b,
        length.b
    )
}

fn flow(role: &str, unlike: Both<f64>, flow: &Flow) -> String {
    let Flow { filament_per_mm, section_mm, at_mm: [x, y, z], line } = flow;
    let more = percent(filament_per_mm.a, filament_per_mm.b);
    let section = |[width, height]: [f64; 2]| format!("{width:.2} x {height:.2}");
    format!(
        "{role} with other filament on {:.1} mm, most {more} at x {x:.3} y {y:.3} z {z:.3} \
         (lines {}; {} and {} mm)",
        unlike.a.max(unlike.b),
        numbers(*line),
        section(section_mm.a),
        section(section_mm.b)
    )
}

/// Lines of both files.
fn numbers(line: Both<u32>) -> String {
    format!("A:{} B:{}", line.a, line.b)
}

fn codes(difference: &CodeDifference) -> String {
    let only = |codes: &[String]| {
        if codes.is_empty() { "nothing".to_owned() } else { codes.join(", ") }
    };
    let line = |line: Option<u64>| line.map_or_else(String::new, |n| format!(" (line {n})"));
    let CodeDifference { only: Both { a, b }, line: lines } = difference;
    format!("A {}{}, B {}{}", only(a), line(lines.a), only(b), line(lines.b))
}

/// Where commands differ.
fn place(layer: Option<Both<usize>>) -> String {
    match layer {
        Some(Both { a: 0, b: 0 }) => "before the first line".to_owned(),
        Some(layer) => label(layer),
        None => "after the last line".to_owned(),
    }
}

fn label(layer: Both<usize>) -> String {
    match layer {
        Both { a: 0, b: 0 } => "before layer 1".to_owned(),
        Both { a, b } if a == b => format!("layer {a}"),
        Both { a, b } => format!("layer {a} (in B {b})"),
    }
}

fn name(file: File) -> &'static str {
    match file {
        File::A => "A",
        File::B => "B",
    }
}

/// `layers 3, 5-9` for 3, 5, 6, 7, 8, 9; how many there are where that gets long.
fn runs(numbers: &[usize]) -> String {
    const MOST: usize = 8;
    let runs: Vec<&[usize]> = numbers.chunk_by(|a, b| a + 1 == *b).collect();
    let ranges = runs.iter().take(MOST).map(|run| match run {
        [0] => "before layer 1".to_owned(),
        [one] => one.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    });
    let ranges = ranges.collect::<Vec<_>>().join(", ");
    match numbers.len() {
        1 => format!("layer {ranges}"),
        count if runs.len() > MOST => format!("{count} layers ({ranges}, ...)"),
        _ => format!("layers {ranges}"),
    }
}

/// Settings that differ but do not matter.
fn settings(settings: &[Setting], all: bool) -> String {
    let most = if all { settings.len() } else { MOST_NAMED };
    let named: Vec<String> = settings.iter().take(most).map(changed).collect();
    let more = if settings.len() > most { ", and so on" } else { "" };
    let count = plural(settings.len() as u64, "setting");
    format!("\ntold only: {count} in comments: {}{more}\n", named.join("; "))
}

fn changed(setting: &Setting) -> String {
    let value = |value: &Option<String>| value.clone().unwrap_or_else(|| "nothing".to_owned());
    let Both { a, b } = &setting.value;
    format!("{}: {} in A, {} in B", setting.key, value(a), value(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_in_a_row_are_a_range() {
        assert_eq!(runs(&[3, 5, 6, 7, 9]), "layers 3, 5-7, 9");
        assert_eq!(runs(&[4]), "layer 4");
        let many: Vec<usize> = (1..40).map(|k| 2 * k).collect();
        assert_eq!(runs(&many), "39 layers (2, 4, 6, 8, 10, 12, 14, 16, ...)");
    }
}
