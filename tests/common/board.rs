//! A board as src/steps/send/PROTOCOL.md has it -> what its motors did: made from that page and the format's
//! alone, with code of its own, in virtual time.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::collections::VecDeque;

pub(crate) const PREPARING: u8 = 1;
pub(crate) const RUNNING: u8 = 2;
pub(crate) const PAUSED: u8 = 3;
pub(crate) const DONE: u8 = 4;
pub(crate) const STOPPED: u8 = 5;
pub(crate) const REFUSED: u8 = 6;
pub(crate) const FAILED: u8 = 7;

/// A step of some axes: which, and which go backwards.
pub(crate) type Step = (u8, u8);

/// What a board is like.
#[derive(Debug, Clone)]
pub(crate) struct Kind {
    pub(crate) version: u16,
    /// Blocks that it can hold.
    pub(crate) room: u32,
    /// How much faster than the stream it executes; 0 for nothing at all.
    pub(crate) haste: u64,
    /// How long it heats, µs.
    pub(crate) heats_for: u64,
    /// Steps and mm of x, if it knows them.
    pub(crate) scale: Option<(u64, u64)>,
    /// Least time between two steps of x that it can do, µs.
    pub(crate) interval: u32,
    /// It has no way to know where its axes stand.
    pub(crate) is_lost: bool,
    /// It fails at this block.
    pub(crate) fails_at: Option<u32>,
    /// It says that it has blocks that were never sent.
    pub(crate) lies: bool,
    /// Blocks do not reach it.
    pub(crate) is_deaf: bool,
    /// It obeys no order.
    pub(crate) is_stubborn: bool,
}

impl Default for Kind {
    fn default() -> Self {
        Self {
            version: 1,
            room: 4,
            haste: 1,
            heats_for: 0,
            scale: None,
            interval: 1,
            is_lost: false,
            fails_at: None,
            lies: false,
            is_deaf: false,
            is_stubborn: false,
        }
    }
}

/// See the head of this file. Times are µs.
#[derive(Debug, Default)]
pub(crate) struct Board {
    pub(crate) kind: Kind,
    pub(crate) state: u8,
    pub(crate) is_hot: bool,
    pub(crate) has_motors_on: bool,
    pub(crate) next: u32,
    pub(crate) done: u32,
    /// Frames that it heard.
    pub(crate) heard: u64,
    /// Of these, orders.
    pub(crate) orders: u64,
    /// What its motors did, in each of its lives.
    pub(crate) lives: Vec<Vec<Step>>,
    reason: u8,
    axis: u8,
    owner: u32,
    job: u32,
    order: u32,
    blocks: u32,
    wants_pause: bool,
    held: VecDeque<Vec<u8>>,
    /// What is left of the block that is executed: time since the step before, and the step.
    todo: Option<VecDeque<(u64, Option<Step>)>>,
    /// When the step before was made; nothing while it stands.
    at: Option<u64>,
    /// When the first of that, or the heat, is due.
    due: Option<u64>,
    /// Time of the stream that was executed.
    elapsed: u64,
    line: Vec<u8>,
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
}

fn is_whole(bytes: &[u8]) -> bool {
    bytes.len() > 4 && {
        let (rest, sum) = bytes.split_at(bytes.len() - 4);
        crc32fast::hash(rest).to_le_bytes() == *sum
    }
}

impl Board {
    pub(crate) fn new(kind: Kind) -> Self {
        Self { kind, lives: vec![Vec::new()], axis: 255, ..Self::default() }
    }

    /// Power goes and comes.
    pub(crate) fn restart(&mut self) {
        let (kind, mut lives) = (self.kind.clone(), std::mem::take(&mut self.lives));
        lives.push(Vec::new());
        *self = Self { kind, lives, axis: 255, ..Self::default() };
    }

    /// When it does something by itself.
    pub(crate) fn wakes_at(&self) -> Option<u64> {
        self.due
    }

    pub(crate) fn is_off(&self) -> bool {
        !self.is_hot && !self.has_motors_on
    }

    /// Bytes that came; gives the frames that it answers with.
    pub(crate) fn hear(&mut self, bytes: &[u8], now: u64) -> Vec<Vec<u8>> {
        let mut said = Vec::new();
        for &byte in bytes {
            if byte != 0 {
                self.line.push(byte);
                continue;
            }
            let frame = unstuffed(&std::mem::take(&mut self.line));
            if frame.len() >= 13 && is_whole(&frame) {
                self.heard += 1;
                let (run, tag) = (u32_at(&frame, 1), u32_at(&frame, 5));
                self.take(frame[0], run, &frame[9..frame.len() - 4], now);
                said.push(self.status(run, tag));
                self.go(now, &mut said);
            }
        }
        said
    }

    /// Time passes; gives what it says by itself.
    pub(crate) fn pass(&mut self, now: u64) -> Vec<Vec<u8>> {
        let mut said = Vec::new();
        self.go(now, &mut said);
        said
    }

    fn is_active(&self) -> bool {
        [PREPARING, RUNNING, PAUSED].contains(&self.state)
    }

    fn take(&mut self, kind: u8, run: u32, payload: &[u8], now: u64) {
        let is_own = run == self.owner;
        self.orders += u64::from(kind == 5);
        match kind {
            4 if self.kind.is_deaf => {}
            5 if self.kind.is_stubborn => {}
            2 if payload.len() == 228
                && u32_at(payload, 0) == self.boot()
                && !is_own
                && !self.is_active() =>
            {
                self.begin(run, payload, now);
            }
            3 if !is_own
                && u32_at(payload, 0) == self.boot()
                && u32_at(payload, 4) == self.job
                && self.is_active() =>
            {
                (self.owner, self.order) = (run, 0);
            }
            4 if is_own && self.is_active() && is_whole(payload) => {
                let is_next = u32_at(payload, 4) == self.next;
                if is_next && self.next < self.done + self.kind.room {
                    self.held.push_back(payload.to_vec());
                    self.next += 1;
                }
            }
            5 if is_own && self.is_active() && u32_at(payload, 0) > self.order => {
                self.order = u32_at(payload, 0);
                match payload[4] {
                    2 => self.end(STOPPED, 0),
                    what => self.wants_pause = what == 1,
                }
                if !self.wants_pause && self.state == PAUSED {
                    self.state = RUNNING;
                }
            }
            5 if !is_own && !self.is_active() && payload[4] == 2 => {
                self.owner = run;
                self.end(STOPPED, 0);
            }
            _ => {}
        }
    }

    /// Another number in each life.
    fn boot(&self) -> u32 {
        self.lives.len() as u32
    }

    fn begin(&mut self, run: u32, payload: &[u8], now: u64) {
        (self.owner, self.job, self.blocks) = (run, u32_at(payload, 4), u32_at(payload, 8));
        (self.order, self.next, self.done, self.elapsed) = (0, 0, 0, 0);
        (self.reason, self.axis, self.wants_pause) = (0, 255, false);
        self.held.clear();
        let header = &payload[12..];
        let is_known = is_whole(header) && header[..9] == *b"\x89STEPS\r\n\x01" && header[12] == 0;
        let is_other = |scale| scale != (u64_at(header, 20), u64_at(header, 28));
        let refusal = match () {
            () if !is_known => Some((1, 255)),
            () if self.kind.scale.is_some_and(is_other) => Some((2, 0)),
            () if u32_at(header, 40) < self.kind.interval => Some((3, 0)),
            () if self.kind.is_lost => Some((4, 255)),
            () => None,
        };
        if let Some((reason, axis)) = refusal {
            self.end(REFUSED, reason);
            self.axis = axis;
            return;
        }
        (self.state, self.is_hot, self.has_motors_on) = (PREPARING, true, true);
        self.due = Some(now + self.kind.heats_for);
    }

    fn end(&mut self, state: u8, reason: u8) {
        (self.state, self.reason) = (state, reason);
        (self.is_hot, self.has_motors_on) = (false, false);
        (self.todo, self.at, self.due) = (None, None, None);
    }

    /// Does what is due.
    fn go(&mut self, now: u64, said: &mut Vec<Vec<u8>>) {
        if self.state == PREPARING && self.due.is_some_and(|due| due <= now) {
            (self.state, self.due) = (RUNNING, None);
            said.push(self.status(self.owner, 0));
        }
        while self.state == RUNNING && self.kind.haste > 0 {
            if self.wants_pause {
                (self.state, self.at, self.due) = (PAUSED, None, None);
                said.push(self.status(self.owner, 0));
                return;
            }
            let Some(todo) = &mut self.todo else {
                match self.held.pop_front() {
                    Some(block) => self.todo = Some(self.records(&block)),
                    None => {
                        self.at = None;
                        return;
                    }
                }
                continue;
            };
            let Some((wait, step)) = todo.front().copied() else {
                self.executed(said);
                continue;
            };
            let due = *self.at.get_or_insert(now) + wait / self.kind.haste;
            self.due = Some(due);
            if due > now {
                return;
            }
            todo.pop_front();
            (self.at, self.due) = (Some(due), None);
            self.elapsed += wait;
            assert!(self.has_motors_on && self.is_hot);
            self.lives.last_mut().unwrap().extend(step);
        }
    }

    fn executed(&mut self, said: &mut Vec<Vec<u8>>) {
        self.todo = None;
        self.done += 1;
        if self.kind.fails_at == Some(self.done) {
            self.end(FAILED, 16);
            self.axis = 1;
        } else if self.done == self.blocks {
            self.end(DONE, 0);
        }
        said.push(self.status(self.owner, 0));
    }

    /// What a block asks for, each with the time before it.
    fn records(&self, block: &[u8]) -> VecDeque<(u64, Option<Step>)> {
        let (payload, mut at, mut out) = (&block[10..block.len() - 4], 0, VecDeque::new());
        if block[0] == 2 {
            out.push_back((u64_at(payload, 72) - self.elapsed, None));
            return out;
        }
        let number = |at: &mut usize| {
            let (mut number, mut shift) = (0, 0);
            loop {
                let byte = payload[*at];
                *at += 1;
                number |= i64::from(byte & 127) << shift;
                shift += 7;
                if byte < 128 {
                    return number;
                }
            }
        };
        let (mut backwards, mut interval, mut pause) = (block[1], 0, 0);
        while at < payload.len() {
            let byte = payload[at];
            at += 1;
            match byte {
                0x00 => {
                    backwards = payload[at];
                    at += 1;
                }
                0x10 => pause += number(&mut at),
                0x20 => at += 12,
                _ => {
                    let high = i64::from(byte >> 4);
                    interval = if high == 15 { number(&mut at) } else { interval + high - 7 };
                    out.push_back(((interval + pause) as u64, Some((byte & 15, backwards))));
                    pause = 0;
                }
            }
        }
        out.push_back((pause as u64, None));
        out
    }

    fn status(&self, run: u32, tag: u32) -> Vec<u8> {
        let mut frame = vec![128];
        frame.extend([run, tag].map(u32::to_le_bytes).as_flattened());
        frame.extend(self.kind.version.to_le_bytes());
        frame.extend(self.boot().to_le_bytes());
        frame.extend([self.state, self.reason, self.axis]);
        let next = self.next + if self.kind.lies { 7 } else { 0 };
        let numbers =
            [self.owner, self.job, self.order, next, self.done, self.done + self.kind.room];
        frame.extend(numbers.map(u32::to_le_bytes).as_flattened());
        frame.extend(crc32fast::hash(&frame).to_le_bytes());
        stuffed(&frame)
    }
}

/// As the page says: each 0 and the beginning become the distance to the next 0.
fn stuffed(frame: &[u8]) -> Vec<u8> {
    let (mut out, mut mark) = (vec![0, 0], 1);
    for (k, &byte) in frame.iter().enumerate() {
        if byte != 0 {
            out.push(byte);
        }
        let is_full = out.len() - mark == 255;
        if byte == 0 || (is_full && k + 1 < frame.len()) {
            out[mark] = (out.len() - mark) as u8;
            mark = out.len();
            out.push(0);
        }
    }
    out[mark] = (out.len() - mark) as u8;
    out.push(0);
    out
}

pub(crate) fn unstuffed(bytes: &[u8]) -> Vec<u8> {
    let (mut out, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let next = at + usize::from(bytes[at]);
        if next > bytes.len() {
            // Cut off.
            return Vec::new();
        }
        out.extend(&bytes[at + 1..next]);
        if bytes[at] < 255 && next < bytes.len() {
            out.push(0);
        }
        at = next;
    }
    out
}
