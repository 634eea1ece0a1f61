//! Path of a serial port -> a line to a board: raw bytes at a rate.

use super::error::Cause;
use super::line::Line;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, open};
use rustix::io::{Errno, read, write};
use rustix::termios::{
    ControlModes, OptionalActions, QueueSelector, ioctl_tiocexcl, isatty, tcflush, tcgetattr,
    tcsetattr,
};
use std::io;
use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::Duration;

/// Bytes that are read at once.
const PIECE: usize = 4096;

/// A serial port that is open, for this process alone.
#[derive(Debug)]
pub struct Port {
    fd: OwnedFd,
}

impl Port {
    /// Opens a port, and sets it to eight bits, no parity, and so many bits a second.
    ///
    /// It is not hung up when it is closed: a board that takes that for a restart would lose its place.
    ///
    /// # Errors
    /// [`Cause::Open`], [`Cause::NotPort`].
    pub fn open(path: &Path, baud: u32) -> Result<Self, Cause> {
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let fail = |error: Errno| Cause::Open(error.into());
        let fd = match open(path, flags, Mode::empty()) {
            Err(Errno::ISDIR | Errno::NXIO) => return Err(Cause::NotPort),
            opened => opened.map_err(fail)?,
        };
        if !isatty(&fd) {
            return Err(Cause::NotPort);
        }
        ioctl_tiocexcl(&fd).map_err(fail)?;
        let mut modes = tcgetattr(&fd).map_err(fail)?;
        modes.make_raw();
        modes.control_modes |= ControlModes::CLOCAL | ControlModes::CREAD;
        modes.control_modes -= ControlModes::HUPCL | ControlModes::CRTSCTS | ControlModes::CSTOPB;
        modes.set_speed(baud).map_err(fail)?;
        tcsetattr(&fd, OptionalActions::Now, &modes).map_err(fail)?;
        tcflush(&fd, QueueSelector::IOFlush).map_err(fail)?;
        Ok(Self { fd })
    }
}

impl Line for Port {
    fn exchange(
        &mut self,
        out: &mut Vec<u8>,
        heard: &mut Vec<u8>,
        wait: Duration,
    ) -> io::Result<()> {
        let writes = if out.is_empty() { PollFlags::empty() } else { PollFlags::OUT };
        let mut polled = [PollFd::new(&self.fd, PollFlags::IN | writes)];
        let wait = Timespec {
            tv_sec: wait.as_secs() as i64,
            tv_nsec: i64::from(wait.subsec_nanos()) as _,
        };
        match poll(&mut polled, Some(&wait)) {
            // A signal: its wish is asked for next.
            Ok(0) | Err(Errno::INTR) => return Ok(()),
            other => other?,
        };
        let found = polled[0].revents();
        if found.contains(PollFlags::IN) {
            let mut piece = [0; PIECE];
            match read(&self.fd, &mut piece) {
                Ok(0) => return Err(gone()),
                Ok(count) => heard.extend(&piece[..count]),
                Err(Errno::AGAIN | Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        } else if found.intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL) {
            return Err(gone());
        }
        if found.contains(PollFlags::OUT) {
            match write(&self.fd, out) {
                Ok(count) => drop(out.drain(..count)),
                Err(Errno::AGAIN | Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }
}

fn gone() -> io::Error {
    io::Error::new(io::ErrorKind::UnexpectedEof, "it was unplugged or closed")
}
