//! `slicer send` over a pair of pseudo-terminals to a simulated board: exit codes, signals, what is printed.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::common::board::{self, Board, Kind, Step};
use super::run::{folder, slicer};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::{FdFlags, fcntl_setfd, read, write};
use rustix::process::{Pid, Signal, WaitOptions, kill_process, waitpid};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use serde_json::Value;
use slicer::steps::{Decoder, Item};
use std::fs;
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A board at the end of a line, and a folder with a stream for it.
struct Bench {
    folder: TempDir,
    port: String,
    board: Arc<Mutex<Board>>,
    is_off: Arc<Mutex<bool>>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.unplug();
    }
}

impl Bench {
    /// Of each so many frames that the board says or hears, one is lost and one is damaged.
    fn new(kind: Kind, loses: u64) -> Self {
        let folder = folder();
        let text = "G1 X20 Y10 E2 F3000\nG1 X0 Y5\nG4 P20\nG1 X7\nG1 X0 Y0 E0\n".repeat(3);
        fs::write(folder.path().join("a.gcode"), text).unwrap();
        let words = ["steps", "a.gcode", "-q", "-o", "a.steps", "-p", "generic-marlin"];
        let motors = ["steps.x=80", "steps.y=80", "steps.z=400", "steps.e=93"];
        let motors = motors.iter().flat_map(|motor| ["--set", motor]);
        slicer(&folder).args(words).args(motors).assert().success();
        let board = Arc::new(Mutex::new(Board::new(kind)));
        let is_off = Arc::new(Mutex::new(false));
        let main = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        // No other process keeps the line open.
        fcntl_setfd(&main, FdFlags::CLOEXEC).unwrap();
        grantpt(&main).unwrap();
        unlockpt(&main).unwrap();
        let port = ptsname(&main, Vec::new()).unwrap().into_string().unwrap();
        let (shared, off) = (Arc::clone(&board), Arc::clone(&is_off));
        let thread = thread::spawn(move || {
            // Each way counts by itself: how often nothing came makes no difference.
            let (began, mut frames, mut pieces) = (Instant::now(), 0_u64, 0);
            let wait = Timespec { tv_sec: 0, tv_nsec: 2_000_000 };
            while !*off.lock().unwrap() {
                let mut piece = [0; 4096];
                let mut polled = [PollFd::new(&main, PollFlags::IN)];
                poll(&mut polled, Some(&wait)).unwrap();
                // Nobody has it open yet, or any more.
                let is_quiet = !polled[0].revents().contains(PollFlags::IN);
                let mut heard = if is_quiet { 0 } else { read(&main, &mut piece).unwrap_or(0) };
                if is_quiet {
                    thread::sleep(Duration::from_millis(1));
                }
                pieces += u64::from(heard > 0);
                match pieces % loses.max(2) {
                    0 if loses > 0 => heard = 0,
                    1 if loses > 0 && heard > 0 => piece[heard / 2] ^= 0x10,
                    _ => {}
                }
                let now = began.elapsed().as_micros() as u64;
                let mut board = shared.lock().unwrap();
                let mut said = board.hear(&piece[..heard], now);
                said.extend(board.pass(now));
                for frame in said {
                    frames += 1;
                    if loses == 0 || !frames.is_multiple_of(loses) {
                        let _ = write(&main, &frame);
                    }
                }
            }
        });
        Self { folder, port, board, is_off, thread: Some(thread) }
    }

    fn unplug(&mut self) {
        *self.is_off.lock().unwrap() = true;
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }

    fn board(&self) -> MutexGuard<'_, Board> {
        self.board.lock().unwrap()
    }

    fn send(&self, words: &[&str]) -> assert_cmd::assert::Assert {
        slicer(&self.folder).args(["send", "a.steps", "--port", &self.port]).args(words).assert()
    }

    /// Begins to send, and waits until the board is at it.
    fn begin(&self, words: &[&str]) -> Child {
        let child = Command::new(assert_cmd::cargo::cargo_bin!("slicer"))
            .current_dir(self.folder.path())
            .args(["send", "a.steps", "--port", &self.port])
            .args(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        self.until(|board| !board.lives[0].is_empty());
        child
    }

    fn until(&self, is_so: impl Fn(&Board) -> bool) {
        let began = Instant::now();
        while !is_so(&self.board()) {
            assert!(began.elapsed() < Duration::from_secs(30), "{:?}", self.board());
            thread::sleep(Duration::from_millis(2));
        }
    }

    /// The steps of the stream, by the library.
    fn steps(&self) -> Vec<Step> {
        let bytes = fs::read(self.folder.path().join("a.steps")).unwrap();
        let (mut decoder, mut steps) = (Decoder::new(&bytes[..]).unwrap(), Vec::new());
        while let Some((_, items)) = decoder.block().unwrap() {
            steps.extend(items.iter().filter_map(|item| match item {
                Item::Step { mask, backwards, .. } => Some((*mask, *backwards)),
                Item::Mark { .. } => None,
            }));
        }
        steps
    }

    fn is_done(&self) {
        let board = self.board();
        assert!(board.state == board::DONE && board.is_off());
        assert!(board.lives == [self.steps()], "other steps");
    }
}

fn signal(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}

/// Exit code, standard output, standard error.
fn end(child: Child) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code(), text(stdout), text(stderr))
}

fn said(run: &assert_cmd::assert::Assert) -> String {
    String::from_utf8(run.get_output().stderr.clone()).unwrap()
}

#[test]
fn a_stream_is_executed_over_a_line_that_loses_and_damages() {
    let bench = Bench::new(Kind::default(), 13);
    let run = bench.send(&["--json"]).success().stderr("");
    bench.is_done();
    let told: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    let played = slicer(&bench.folder).args(["play", "a.steps", "--json"]).assert();
    let played: Value = serde_json::from_slice(&played.get_output().stdout).unwrap();
    for key in ["blocks", "steps", "seconds"] {
        assert_eq!(told[key], played[key], "{key}");
    }
    assert!(told["repeated_frames"].as_u64().unwrap() > 0 && told["pauses"] == 0, "{told}");
    assert!(told.get("resumed_at").is_none());
}

#[test]
fn people_are_told_in_a_line_and_quiet_is_quiet() {
    let bench = Bench::new(Kind { haste: 50, ..Kind::default() }, 0);
    let run = bench.send(&[]).success().stdout("");
    assert!(said(&run).contains(" blocks executed in ") && said(&run).lines().count() == 1);
    bench.send(&["-q", "--baud", "9600"]).success().stdout("").stderr("");
}

#[test]
fn an_interrupt_turns_motors_and_heater_off_and_says_nothing() {
    for with in [Signal::INT, Signal::TERM] {
        let bench = Bench::new(Kind::default(), 0);
        let child = bench.begin(&["--json"]);
        signal(&child, with);
        assert_eq!(end(child), (Some(130), String::new(), String::new()));
        let board = bench.board();
        assert!(board.state == board::STOPPED && board.is_off());
        assert!(bench.steps().starts_with(&board.lives[0]));
        assert!(board.lives[0].len() < bench.steps().len());
    }
}

#[test]
fn a_second_interrupt_ends_at_once() {
    let bench = Bench::new(Kind::default(), 0);
    let child = bench.begin(&[]);
    // The board hears nothing meanwhile, and answers nothing.
    let deaf = bench.board();
    signal(&child, Signal::INT);
    thread::sleep(Duration::from_millis(300));
    let began = Instant::now();
    signal(&child, Signal::INT);
    assert_eq!(end(child), (Some(130), String::new(), String::new()));
    assert!(began.elapsed() < Duration::from_secs(4) && !deaf.is_off());
}

#[test]
fn a_board_that_does_not_stop_is_told() {
    let bench = Bench::new(Kind::default(), 0);
    let child = bench.begin(&[]);
    bench.board().kind.is_stubborn = true;
    signal(&child, Signal::INT);
    let (code, out, told) = end(child);
    assert_eq!((code, out.as_str(), told.lines().count()), (Some(4), "", 1));
    assert!(told.contains("motors and heater may be on: switch it off"), "{told}");
}

#[test]
fn a_pause_stands_still_until_it_is_let_go_on() {
    let bench = Bench::new(Kind::default(), 0);
    let child = bench.begin(&["--json"]);
    signal(&child, Signal::TSTP);
    bench.until(|board| board.state == board::PAUSED);
    let steps = bench.board().lives[0].len();
    thread::sleep(Duration::from_millis(400));
    let stands = bench.board().lives[0].len();
    assert!(steps == stands && !bench.board().is_off(), "{steps} {stands}");
    signal(&child, Signal::CONT);
    let (code, out, told) = end(child);
    assert_eq!((code, told.as_str()), (Some(0), ""));
    assert_eq!(serde_json::from_str::<Value>(&out).unwrap()["pauses"], 1);
    bench.is_done();
}

#[test]
fn a_stop_of_who_stands_still_moves_nothing() {
    for with in [Signal::INT, Signal::TERM] {
        let bench = Bench::new(Kind::default(), 0);
        let child = bench.begin(&[]);
        signal(&child, Signal::TSTP);
        // Until the process is stopped, too.
        waitpid(Some(Pid::from_child(&child)), WaitOptions::UNTRACED).unwrap();
        assert_eq!(bench.board().state, board::PAUSED);
        let steps = bench.board().lives[0].len();
        signal(&child, with);
        signal(&child, Signal::CONT);
        assert_eq!(end(child), (Some(130), String::new(), String::new()));
        let board = bench.board();
        assert!(board.state == board::STOPPED && board.is_off());
        // Pause and stop, and no go on between them.
        assert_eq!((board.orders, board.lives[0].len()), (2, steps));
    }
}

#[test]
fn a_pause_that_is_under_way_is_taken_back() {
    let bench = Bench::new(Kind::default(), 0);
    let child = bench.begin(&["--json"]);
    // The board hears nothing meanwhile.
    let deaf = bench.board();
    signal(&child, Signal::TSTP);
    thread::sleep(Duration::from_millis(300));
    signal(&child, Signal::CONT);
    thread::sleep(Duration::from_millis(300));
    drop(deaf);
    bench.until(|board| board.state == board::DONE);
    let (code, out, told) = end(child);
    assert_eq!((code, told.as_str()), (Some(0), ""));
    assert_eq!(serde_json::from_str::<Value>(&out).unwrap()["pauses"], 0);
    assert_eq!(bench.board().orders, 2);
    bench.is_done();
}

#[test]
fn an_unplugged_port_is_one_line_of_error() {
    let mut bench = Bench::new(Kind::default(), 0);
    let child = bench.begin(&[]);
    bench.unplug();
    let (code, out, told) = end(child);
    assert_eq!((code, out.as_str(), told.lines().count()), (Some(4), "", 1), "{told}");
    assert!(told.contains(&bench.port) && told.contains("the port is gone"), "{told}");
    assert!(told.contains("--resume"), "{told}");
}

#[test]
fn another_run_goes_on_where_one_was_killed_and_none_begins_anew() {
    let bench = Bench::new(Kind::default(), 0);
    let child = bench.begin(&[]);
    signal(&child, Signal::KILL);
    assert_eq!(end(child).0, None);
    bench.until(|board| board.wakes_at().is_none() && board.done == board.next);
    let held = bench.board().next;
    assert!(held > 0 && !bench.board().is_off());
    let busy = said(&bench.send(&[]).code(4).stdout(""));
    assert!(busy.contains(&format!("in the middle of a job, at block {held}")), "{busy}");
    let run = bench.send(&["--resume", "--json"]).success();
    let told: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    assert_eq!(told["resumed_at"], held);
    bench.is_done();
    // The user is not sent into printing it again.
    let heard = bench.board().lives.clone();
    let over = said(&bench.send(&["--resume"]).success().stdout(""));
    assert!(
        over.contains("the board has executed all of it") && over.lines().count() == 1,
        "{over}"
    );
    assert!(bench.board().lives == heard && bench.board().is_off());
    // It restarts: nothing is held, and nothing is known.
    bench.board().restart();
    let none = said(&bench.send(&["--resume"]).code(4).stdout(""));
    assert!(none.contains("holds no part of this file") && none.lines().count() == 1, "{none}");
}

#[test]
fn who_resumes_what_was_stopped_or_failed_is_told_so() {
    let bench = Bench::new(Kind::default(), 0);
    let child = bench.begin(&[]);
    signal(&child, Signal::INT);
    assert_eq!(end(child).0, Some(130));
    let told = said(&bench.send(&["--resume"]).code(4).stdout(""));
    assert!(
        told.contains("was stopped at the board after ") && told.lines().count() == 1,
        "{told}"
    );
    let bench = Bench::new(Kind { fails_at: Some(1), ..Kind::default() }, 0);
    let why = "failed after 1 block: Y: a switch was hit";
    for words in [&[][..], &["--resume"]] {
        let told = said(&bench.send(words).code(4).stdout(""));
        assert!(told.contains(why) && told.lines().count() == 1, "{told}");
    }
}

#[test]
fn a_board_that_restarts_ends_the_print() {
    let bench = Bench::new(Kind::default(), 0);
    let child = bench.begin(&[]);
    bench.board().restart();
    let (code, _, told) = end(child);
    assert_eq!((code, told.lines().count()), (Some(4), 1));
    assert!(told.contains("the board restarted after "), "{told}");
    assert!(bench.board().lives[1].is_empty() && bench.board().is_off());
}

#[test]
fn boards_of_another_kind_are_told_by_their_exit_code() {
    type Case = (fn(&mut Kind), i32, &'static str);
    let cases: [Case; 4] = [
        (|kind| kind.version = 9, 4, "speaks version 9 of the protocol"),
        (|kind| kind.scale = Some((1, 1)), 3, "X: it makes another number of steps a mm"),
        (|kind| kind.interval = 100_000, 3, "X: its motors are not so fast"),
        (|kind| kind.is_lost = true, 3, "its axes do not stand where the stream begins"),
    ];
    for (change, code, why) in cases {
        let mut kind = Kind::default();
        change(&mut kind);
        let bench = Bench::new(kind, 0);
        let told = said(&bench.send(&[]).code(code).stdout(""));
        assert!(told.contains(why) && told.lines().count() == 1, "{told}");
        assert!(bench.board().lives == [vec![]] && bench.board().is_off());
    }
}

#[test]
fn what_is_no_stream_or_no_port_is_refused_before_anything_is_sent() {
    let bench = Bench::new(Kind::default(), 0);
    let good = fs::read(bench.folder.path().join("a.steps")).unwrap();
    let mut turned = good.clone();
    *turned.last_mut().unwrap() ^= 1;
    for (bytes, why) in [
        (&b"G1 X1\n"[..], "it is no stream of steps"),
        (&good[..good.len() - 1], "is cut off"),
        (&turned, "is damaged"),
    ] {
        fs::write(bench.folder.path().join("a.steps"), bytes).unwrap();
        let told = said(&bench.send(&[]).code(3).stdout(""));
        assert!(told.starts_with("error: a.steps: ") && told.contains(why), "{told}");
        assert_eq!(told.lines().count(), 1);
    }
    assert_eq!(bench.board().heard, 0);
    fs::write(bench.folder.path().join("a.steps"), &good).unwrap();
    for (port, why) in
        [("nowhere", "cannot open"), ("/dev/null", "no serial port"), ("a.steps", "no serial port")]
    {
        let run = slicer(&bench.folder).args(["send", "a.steps", "--port", port]).assert();
        let told = said(&run.code(4).stdout(""));
        assert!(told.starts_with(&format!("error: {port}: ")) && told.contains(why), "{told}");
    }
    bench.send(&["--baud", "300"]).code(2);
    slicer(&bench.folder).args(["send", "a.steps"]).assert().code(2);
    let run = slicer(&bench.folder).args(["send", "-", "--port", &bench.port]).assert();
    assert!(said(&run.code(2).stdout("")).contains("send needs a file"));
}
