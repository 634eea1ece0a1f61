//! `slicer send` -> a board that executes a stream of steps, over a serial port.
//!
//! Words used here: a *wish* is what a signal asks for: to stop, or to pause.
//!
//! 1. The stream is read whole: of one that is damaged nothing is sent.
//! 2. The port is opened, and blocks go to the board, until it has executed all.
//! 3. SIGINT and SIGTERM wish to stop: motors and heater off, and the program ends with 130. A second one
//!    ends it at once. Ctrl-Z (SIGTSTP) wishes to pause: when the board stands still, this process is
//!    stopped as any other would be; `fg` or SIGCONT goes on, or takes back a pause that is still under
//!    way. A stop that was wished meanwhile is all that is then sent. Other signals end the program as they end any:
//!    the board holds the job, and `--resume` goes on with it.

use super::progress::Meter;
use super::{Outcome, output, say, usage};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use slicer::error::Error;
use slicer::progress::Progress;
use slicer::steps::axis::Axes;
use slicer::steps::send::{Ended, Feed, Sent};
use slicer::text;
use slicer::warning::plural;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Version of the JSON; raised when a field changes its meaning or goes away.
const SCHEMA: u32 = 1;

const SEND_RULES: &str = "\
Ctrl-Z, or kill -TSTP, pauses the board; fg, or kill -CONT, goes on.
Ctrl-C stops it: motors and heater off, exit code 130; again, at once.
After a failure of the line the board holds the job: go on with --resume.
A board that restarted has lost its place: that print is over.
A board that has a heater heats by itself.

Exit codes: 0 the board has executed all of it, 2 wrong arguments, 3 a file
that is no stream or is damaged, or that the board refuses, 4 the port, the
line or the board fails, 130 stopped.";

/// Arguments of `send`.
#[derive(Debug, Args)]
#[command(after_long_help = SEND_RULES)]
pub(crate) struct SendArgs {
    /// Stream of steps, as `slicer steps` makes it
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Serial port of the board, such as /dev/ttyUSB0
    #[arg(long, value_name = "PATH")]
    port: PathBuf,
    /// Bits a second of the line; a board on USB takes any
    #[arg(long, value_name = "N", default_value_t = 115_200, value_parser = clap::value_parser!(u32).range(9600..=8_000_000))]
    baud: u32,
    /// Go on with this file where the board holds it, after the line or this program failed
    #[arg(long)]
    resume: bool,
    /// Print JSON at the end
    #[arg(long)]
    json: bool,
    /// Show only errors
    #[arg(short, long)]
    quiet: bool,
}

/// Sends a stream.
///
/// # Errors
/// A stream that cannot be read or is damaged; every error of sending.
pub(super) fn run(args: &SendArgs) -> Result<Outcome> {
    if args.file == Path::new("-") {
        usage::refuse("send needs a file: it is read more than once")?;
    }
    let mut wishes = signals::Wishes::watch();
    let name = text::name(&args.file);
    let unreadable = |error| slicer::steps::Cause::Unreadable(error).of(&name);
    let file = File::open(&args.file).map_err(unreadable)?;
    let feed = Feed::new(BufReader::new(file), &name, || !wishes.is_stop())?;
    let stopped = || Outcome { text: String::new(), code: super::interrupt::INTERRUPTED };
    let Some(mut feed) = feed else { return Ok(stopped()) };
    let began = Instant::now();
    let progress = Arc::new(Progress::default());
    progress.set_total(feed.job().blocks as usize);
    let meter = Meter::of("blocks", &progress, !args.quiet);
    let sent = signals::send(&mut feed, args, &mut wishes, &progress).map_err(Error::from)?;
    drop(meter);
    if sent.ended == Ended::Stopped {
        return Ok(stopped());
    }
    let told = Told {
        schema: SCHEMA,
        blocks: sent.done,
        resumed_at: args.resume.then_some(sent.from),
        steps: feed.steps().into(),
        seconds: feed.seconds(),
        elapsed_seconds: (began.elapsed().as_secs_f64() * 1e3).round() / 1e3,
        repeated_frames: sent.repeated,
        pauses: wishes.pauses(),
    };
    if args.json {
        return Ok(output::json(&told, Path::new("-"))?.into());
    }
    if !args.quiet {
        say(&notes(&sent, &told));
    }
    Ok(String::new().into())
}

/// For people.
fn notes(sent: &Sent, told: &Told) -> String {
    let blocks = plural(u64::from(sent.done), "block");
    if told.resumed_at == Some(sent.done) {
        return format!("the board has executed all of it: {blocks}\n");
    }
    let again = match sent.repeated {
        0 => String::new(),
        frames => format!(", {} sent again", plural(frames, "frame")),
    };
    format!("{blocks} executed in {:.1} s of {:.1} s{again}\n", told.elapsed_seconds, told.seconds)
}

/// For programs.
#[derive(Serialize)]
struct Told {
    schema: u32,
    /// All that the board executed.
    blocks: u32,
    /// The first block that was sent, with --resume.
    #[serde(skip_serializing_if = "Option::is_none")]
    resumed_at: Option<u32>,
    /// Steps of each axis.
    steps: Axes<u64>,
    /// How long the stream takes.
    seconds: f64,
    /// How long it took from here.
    elapsed_seconds: f64,
    repeated_frames: u64,
    pauses: u64,
}

#[cfg(unix)]
mod signals {
    //! Signals -> wishes, and a port that they are for.

    use super::SendArgs;
    use signal_hook::consts::{SIGCONT, SIGINT, SIGTERM, SIGTSTP};
    use signal_hook::{flag, low_level};
    use slicer::progress::Progress;
    use slicer::steps::send::{self, Error, Event, Feed, Port, Sender, Sent};
    use slicer::text;
    use std::hash::{BuildHasher as _, RandomState};
    use std::io::{Read, Seek};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::thread;
    use std::time::Duration;

    /// What was asked for last, and is not done: nothing, to pause, or to go on.
    const NOTHING: usize = 0;
    const PAUSE: usize = 1;
    const GO: usize = 2;

    /// How long signals that came while this process was stopped may take: another thread may have them.
    const DELIVERY: Duration = Duration::from_millis(50);

    /// What signals ask for.
    pub(super) struct Wishes {
        stop: Arc<AtomicBool>,
        /// The last of pause and go on.
        last: Arc<AtomicUsize>,
        /// The board was told to stand still.
        is_pausing: bool,
        pauses: u64,
    }

    impl Wishes {
        /// Watches signals from now on. What cannot be watched ends the program as it ends any.
        pub(super) fn watch() -> Self {
            let stop = Arc::new(AtomicBool::new(false));
            let last = Arc::new(AtomicUsize::new(NOTHING));
            for signal in [SIGINT, SIGTERM] {
                // In this order: the first signal finds the flag still down.
                let code = i32::from(crate::cli::interrupt::INTERRUPTED);
                let _ = flag::register_conditional_shutdown(signal, code, Arc::clone(&stop));
                let _ = flag::register(signal, Arc::clone(&stop));
            }
            let _ = flag::register_usize(SIGTSTP, Arc::clone(&last), PAUSE);
            let _ = flag::register_usize(SIGCONT, Arc::clone(&last), GO);
            Self { stop, last, is_pausing: false, pauses: 0 }
        }

        pub(super) fn is_stop(&self) -> bool {
            self.stop.load(Ordering::Relaxed)
        }

        pub(super) fn pauses(&self) -> u64 {
            self.pauses
        }

        fn next(&mut self, sender: &Sender) -> Option<Event> {
            if self.is_stop() {
                return Some(Event::Stop);
            }
            match self.last.swap(NOTHING, Ordering::SeqCst) {
                PAUSE => {
                    self.is_pausing = true;
                    return Some(Event::Pause);
                }
                GO if self.is_pausing => {
                    self.is_pausing = false;
                    return Some(Event::Go);
                }
                _ => {}
            }
            (self.is_pausing && sender.is_paused()).then(|| self.stand())
        }

        /// Stops this process, until somebody lets it go on.
        fn stand(&mut self) -> Event {
            (self.is_pausing, self.pauses) = (false, self.pauses + 1);
            let _ = low_level::emulate_default_handler(SIGTSTP);
            thread::sleep(DELIVERY);
            if self.is_stop() { Event::Stop } else { Event::Go }
        }
    }

    /// Sends to the port that the arguments name.
    pub(super) fn send<R: Read + Seek>(
        feed: &mut Feed<R>,
        args: &SendArgs,
        wishes: &mut Wishes,
        progress: &Progress,
    ) -> Result<Sent, Error> {
        let name = text::name(&args.port);
        let mut port = Port::open(&args.port, args.baud).map_err(|cause| cause.at(&name))?;
        // Only to be another than that of any sender before: nothing of the print depends on it.
        let run = (RandomState::new().hash_one(std::process::id()) as u32).max(1);
        send::send(feed, &mut port, &name, (run, args.resume), |sender| {
            let (done, _) = progress.get();
            progress.add((sender.done() as usize).saturating_sub(done));
            wishes.next(sender)
        })
    }
}

#[cfg(not(unix))]
mod signals {
    //! Where no port is known.

    use super::SendArgs;
    use slicer::progress::Progress;
    use slicer::steps::send::{Cause, Error, Feed, Sent};
    use slicer::text;

    pub(super) struct Wishes;

    impl Wishes {
        pub(super) fn watch() -> Self {
            Self
        }

        pub(super) fn is_stop(&self) -> bool {
            false
        }

        pub(super) fn pauses(&self) -> u64 {
            0
        }
    }

    pub(super) fn send<R>(
        _: &mut Feed<R>,
        args: &SendArgs,
        _: &mut Wishes,
        _: &Progress,
    ) -> Result<Sent, Error> {
        Err(Cause::NoPorts.at(&text::name(&args.port)))
    }
}
