//! Start block -> lines around it that say what its numbers mean, where the block itself does not.
//!
//! A printer keeps the modes of the job before: a block written for absolute coordinates is drawn wrong, or
//! pushes out metres of filament, after a job that ended in relative ones.

use crate::profile::{DialectName, Machine};

/// Moves, whose numbers the modes tell.
const MOVES: [&str; 4] = ["G0", "G1", "G2", "G3"];

/// The command for the machine's way to count E.
pub(super) fn of_filament(machine: &Machine) -> &'static str {
    if machine.relative_e { "M83" } else { "M82" }
}

/// The lines before a block: G90 and the mode of E, unless it says both before its first move. G90 comes first,
/// since it sets E, too, on some firmwares. Without a move there is nothing to be told: macros have modes of
/// their own. Sailfish has one way of each only, and needs no word.
pub(super) fn before(block: &str, machine: &Machine) -> String {
    let is_move = |code: &String| MOVES.contains(&code.as_str());
    let has_one_way = machine.dialect == DialectName::Makerbot;
    let Some(first) = codes(block).position(|code| is_move(&code)).filter(|_| !has_one_way) else {
        return String::new();
    };
    let says = |modes: &[&str]| codes(block).take(first).any(|code| modes.contains(&&*code));
    if says(&["G90", "G91"]) && says(&["M82", "M83"]) {
        return String::new();
    }
    format!("G90\n{}\n", of_filament(machine))
}

/// The line after a block whose last word on units is inches: all that follows is in mm.
pub(super) fn units_after(block: &str) -> &'static str {
    let last = codes(block).filter(|code| code == "G20" || code == "G21").last();
    if last.is_some_and(|code| code == "G20") { "G21\n" } else { "" }
}

/// The command of each line that has one.
fn codes(block: &str) -> impl Iterator<Item = String> {
    block.lines().filter_map(|line| {
        let code = line.split(';').next()?.split_whitespace().next()?;
        Some(code.to_ascii_uppercase())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{builtin_names, load};

    #[test]
    fn a_block_that_moves_before_it_says_its_modes_is_told_them() {
        let machine = load(["ender-3"], &[]).unwrap().settings.machine;
        // Cura's for the Ender-3.
        let cura = "G92 E0 ; Reset Extruder\nG28 ; Home all axes\nG1 Z2.0 F3000\nG1 X0.1 Y200 Z0.3 F1500 E15\n";
        assert_eq!(before(cura, &machine), "G90\nM82\n");
        let relative = Machine { relative_e: true, ..machine.clone() };
        assert_eq!(before(cura, &relative), "G90\nM83\n");
        let makerbot = Machine { dialect: DialectName::Makerbot, ..machine.clone() };
        assert_eq!(before(cura, &makerbot), "");
        for (block, expected) in [
            ("G90\nM82\nG1 X5", ""),
            ("g90 ; absolute\nm83\nG1 X5 E2", ""),
            ("G90\nG1 X5\nM82", "G90\nM82\n"),
            ("M82\nG1 X5 E2", "G90\nM82\n"),
            ("PRINT_START BED=60", ""),
            ("G28\n", ""),
            ("", ""),
        ] {
            assert_eq!(before(block, &machine), expected, "{block}");
        }
    }

    #[test]
    fn shipped_blocks_say_their_modes() {
        for name in builtin_names() {
            let machine = load([name], &[]).unwrap().settings.machine;
            let block = machine.start_gcode.replace("{e_mode}", of_filament(&machine));
            assert_eq!(before(&block, &machine), "", "{name}");
        }
    }

    #[test]
    fn what_follows_a_block_in_inches_is_in_mm() {
        assert_eq!(units_after("G21\nG20 ; inches\nG1 X1"), "G21\n");
        assert_eq!((units_after("G20\nG21"), units_after("; G20")), ("", ""));
    }
}
