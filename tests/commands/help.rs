//! Help, manual pages and completions -> what a user reads and what the shells offer.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

use assert_cmd::Command;
use std::fs;
use std::process::Command as Process;

/// Every command there is; those below have commands of their own.
const COMMANDS: [&str; 21] = [
    "",
    "check",
    "compare",
    "completions",
    "diff",
    "estimate",
    "man",
    "mesh",
    "play",
    "preview",
    "profile",
    "profile check",
    "profile list",
    "profile new",
    "profile schema",
    "profile show",
    "report",
    "report schema",
    "roughness",
    "send",
    "steps",
];

fn product(words: &str, flags: &[&str]) -> String {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    let output = command.env("COLUMNS", "80").args(words.split_whitespace()).args(flags).assert();
    let output = output.success().stderr("").get_output().stdout.clone();
    String::from_utf8(output).unwrap()
}

#[test]
fn short_help_is_a_screen() {
    for command in COMMANDS {
        let help = product(command, &["-h"]);
        let count = help.lines().count();
        assert!(count <= 40, "slicer {command} -h has {count} lines:\n{help}");
    }
    let help = product("", &["-h"]);
    let wide: Vec<&str> = help.lines().filter(|line| line.chars().count() > 80).collect();
    assert!(wide.is_empty(), "{wide:#?}");
    let at = |flag: &str| help.find(flag).unwrap_or_else(|| panic!("{flag} is missing:\n{help}"));
    assert!(at("--output") < at("--profile") && at("--profile") < at("--dual"), "{help}");
    assert!(!help.contains("--max-triangles"), "{help}");
}

#[test]
fn long_help_and_the_manual_have_every_flag() {
    for flag in ["--output", "--dual-parts", "--max-triangles", "--threads"] {
        assert!(product("", &["--help"]).contains(flag), "{flag}");
        assert!(product("man", &[]).contains(&flag.replace('-', "\\-")), "{flag}");
    }
}

/// Whether a paragraph of a manual page names a flag and does not explain it.
fn is_bare(paragraph: &str) -> bool {
    let text = paragraph.split(".SH").next().unwrap_or_default();
    text.starts_with("\\fB") && text.lines().nth(1).is_none_or(|line| line.trim().is_empty())
}

#[test]
fn every_command_has_a_manual_page() {
    for command in COMMANDS {
        let page = product(&format!("man {command}"), &[]);
        let name = ["slicer", command].join(" ").trim().replace(' ', "-");
        let title = page.lines().find_map(|line| line.strip_prefix(".TH "));
        assert!(title.is_some_and(|title| title.starts_with(&format!("{name} 1"))), "{page}");
        let named = format!("{} \\- ", name.replace('-', "\\-"));
        assert!(page.contains(&named), "{name}:\n{page}");
        // A flag, and at once the next paragraph: nothing is said of it.
        let bare: Vec<&str> = page.split(".TP\n").filter(|flag| is_bare(flag)).collect();
        assert!(bare.is_empty(), "{name}: {bare:#?}");
    }
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slicer"));
    let known = "error: man: there is no command shw; there are: list, show, check";
    let found = command.args(["man", "profile", "shw"]).assert().code(2).stdout("");
    let found = String::from_utf8(found.get_output().stderr.clone()).unwrap();
    assert!(found.starts_with(&known[..known.len() - 11]) && found.lines().count() == 1, "{found}");
}

#[test]
fn the_page_of_check_names_every_finding() {
    let page = product("man check", &[]).replace("\\-", "-");
    assert!(page.contains(".SH NOTES\n.nf\n"), "lines of a table must stay lines:\n{page}");
    for code in slicer::check::finding::Code::ALL {
        assert!(page.contains(&format!("  {} ", code.name())), "{}:\n{page}", code.name());
    }
}

#[test]
fn scripts_hold_no_mark_that_was_not_replaced() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = product("completions", &[shell]);
        assert!(!script.contains("@profiles@") && !script.contains("@keys@"), "{shell}:\n{script}");
    }
}

/// What a shell says to a script, if it is there.
fn asked(shell: &str, script: &str) -> Option<String> {
    let Ok(output) = Process::new(shell).args(["-c", script]).output() else {
        println!("{shell} is missing: not asked");
        return None;
    };
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && complaint.is_empty(), "{shell}: {complaint}");
    Some(String::from_utf8(output.stdout).unwrap())
}

#[test]
fn bash_offers_profiles_and_keys() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("slicer.bash");
    fs::write(&script, product("completions", &["bash"])).unwrap();
    let offered = |words: &[&str]| {
        let (word, before) = (words[words.len() - 1], words[words.len() - 2]);
        let line = format!(
            "source '{}'
            compopt() {{ echo \"$@\"; }}
            COMP_WORDS=(slicer {}) COMP_CWORD={}
            _slicer_keys slicer '{word}' '{before}'
            printf '%s\\n' \"${{COMPREPLY[@]}}\"",
            script.display(),
            words.iter().map(|word| format!("'{word}' ")).collect::<String>(),
            words.len()
        );
        asked("bash", &line)
    };
    let Some(profiles) = offered(&["part.stl", "-p", "generic-"]) else { return };
    assert_eq!(profiles, "generic-klipper\ngeneric-marlin\ngeneric-reprapfirmware\n");
    assert_eq!(offered(&["check", "a.gcode", "--profile", "the"]).unwrap(), "thesis\n");
    // Bash is told to put no space after a key.
    assert_eq!(offered(&["part.stl", "--set", "speed.wa"]).unwrap(), "-o nospace\nspeed.wall=\n");
    assert_eq!(offered(&["estimate", "a", "--set", "walls"]).unwrap(), "-o nospace\nwalls=\n");
    // A file of one's own: nothing is offered, and bash offers files.
    assert_eq!(offered(&["part.stl", "-p", "./mine"]).unwrap(), "\n");
}

#[test]
fn fish_offers_profiles_files_and_keys() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("slicer.fish"), product("completions", &["fish"])).unwrap();
    fs::write(folder.path().join("mine.toml"), "").unwrap();
    let offered = |line: &str| {
        let script =
            format!("cd '{}'; source slicer.fish; complete -C '{line}'", folder.path().display());
        asked("fish", &script)
    };
    let Some(profiles) = offered("slicer part.stl -p ") else { return };
    assert!(profiles.contains("generic-klipper") && profiles.contains("mine.toml"), "{profiles}");
    let keys = offered("slicer part.stl --set speed.wal").unwrap();
    assert!(keys.starts_with("speed.wall=") && keys.lines().count() == 1, "{keys}");
    // All flags of slicing after a model, and none of them after a command.
    assert!(offered("slicer part.stl --copi").unwrap().starts_with("--copies"));
    assert_eq!(offered("slicer estimate a.gcode --copi").unwrap(), "");
}

#[test]
fn zsh_reads_its_script() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("_slicer");
    let text = product("completions", &["zsh"]);
    assert!(text.contains("NAME:_slicer_profiles'") && text.contains("KEY=VALUE:_slicer_keys'"));
    fs::write(&script, text).unwrap();
    asked("zsh", &format!("zsh -n '{}'", script.display()));
}
