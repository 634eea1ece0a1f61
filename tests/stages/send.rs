//! Sender and a simulated board on a bad line, in virtual time -> the steps of the file, once, or an error.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::common::board::{self, Board, Kind, Step};
use proptest::prelude::*;
use slicer::steps::send::event::{Action, Want};
use slicer::steps::send::frame::{Hearing, Job, Order, Request};
use slicer::steps::send::{Cause, Ended, Event, Feed, Sender};
use slicer::steps::{Decoder, Encoder, Form, Header, Item, Machine};
use std::collections::BTreeMap;
use std::io::Cursor;

const SECOND: u64 = 1_000_000;

/// Numbers that look random.
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % most.max(1)
    }

    fn hits(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }
}

/// A stream of so many steps, some ms apart, with pauses.
pub(crate) fn stream(steps: u64, seed: u64) -> Vec<u8> {
    let scale = slicer::steps::axis::Scale::new(80.0).unwrap();
    let machine = Machine {
        scale: [scale; 4],
        interval: [100; 4],
        turn: 0,
        pulse: 2,
        start: [0; 4],
        ends: [[i64::MIN; 4], [i64::MAX; 4]],
    };
    let (mut bytes, mut dice) = (Vec::new(), Dice(seed));
    let mut encoder = Encoder::new(&mut bytes, &Header { form: Form::Steps, machine }).unwrap();
    let mut at = 0;
    for _ in 0..steps {
        at += 500 + dice.below(5000) as i64;
        if dice.hits(1) {
            at += 700_000;
        }
        encoder.step(at, 1 + dice.below(15) as u8, dice.below(16) as u8).unwrap();
    }
    encoder.finish(at + 1000).unwrap();
    bytes
}

/// The steps of a stream, by the decoder.
pub(crate) fn steps(stream: &[u8]) -> Vec<Step> {
    let (mut decoder, mut steps) = (Decoder::new(stream).unwrap(), Vec::new());
    while let Some((_, items)) = decoder.block().unwrap() {
        steps.extend(items.iter().filter_map(|item| match item {
            Item::Step { mask, backwards, .. } => Some((*mask, *backwards)),
            Item::Mark { .. } => None,
        }));
    }
    steps
}

/// How bad a line is: percent of frames, and delays in ms.
#[derive(Debug, Clone, Copy, Default)]
struct Faults {
    drop: u64,
    twice: u64,
    damage: u64,
    delay: u64,
    overtakes: bool,
}

/// What happens besides, at times in ms.
#[derive(Debug, Clone, Default)]
struct Script {
    restarts: Vec<u64>,
    pauses: Vec<(u64, u64)>,
    stop: Option<u64>,
    /// From then on nothing gets through.
    cut: Option<u64>,
}

/// One direction of a line.
#[derive(Default)]
struct Way {
    under_way: BTreeMap<(u64, u64), Vec<u8>>,
    count: u64,
    last: u64,
}

impl Way {
    fn put(&mut self, frame: &[u8], now: u64, faults: &Faults, dice: &mut Dice) {
        if dice.hits(faults.drop) {
            return;
        }
        for _ in 0..1 + u64::from(dice.hits(faults.twice)) {
            let mut frame = frame.to_vec();
            if dice.hits(faults.damage) {
                let at = dice.below(frame.len() as u64) as usize;
                match dice.below(4) {
                    0 => frame[at] ^= 1 << dice.below(8),
                    1 => drop(frame.drain(at..)),
                    2 => frame.insert(at, dice.below(256) as u8),
                    _ => drop(frame.drain(..at)),
                }
            }
            let mut at = now + 1000 + 1000 * dice.below(faults.delay + 1);
            if !faults.overtakes {
                at = at.max(self.last);
            }
            self.last = self.last.max(at);
            self.count += 1;
            self.under_way.insert((at, self.count), frame);
        }
    }

    fn next(&self) -> Option<u64> {
        self.under_way.keys().next().map(|(at, _)| *at)
    }

    fn arrived(&mut self, now: u64) -> Vec<Vec<u8>> {
        let later = self.under_way.split_off(&(now + 1, 0));
        std::mem::replace(&mut self.under_way, later).into_values().collect()
    }
}

struct World {
    board: Board,
    faults: Faults,
    dice: Dice,
    now: u64,
    to: Way,
    from: Way,
    run: u32,
}

impl World {
    fn new(kind: Kind, faults: Faults, seed: u64) -> Self {
        let (board, dice) = (Board::new(kind), Dice(seed));
        let (to, from) = (Way::default(), Way::default());
        Self { board, faults, dice, now: 0, to, from, run: 6 }
    }

    /// Sends a stream; gives how that ended, and the sender.
    fn send(&mut self, bytes: &[u8], is_resume: bool, script: &Script) -> Result<Ended, Cause> {
        let mut feed = Feed::new(Cursor::new(bytes), "x", || true).unwrap().unwrap();
        let (header, job) = (feed.header().to_vec(), feed.job());
        assert_eq!(header, bytes[..216]);
        self.run += 1;
        let mut sender = Sender::new(job, self.run, feed.longest(), is_resume);
        let mut hearing = Hearing::default();
        let began = self.now;
        let mut events = script.events(began);
        let (mut actions, mut heard) = (Vec::new(), Vec::new());
        loop {
            assert!(self.now < began + 4000 * SECOND, "it does not end");
            let ms = self.now / 1000;
            let mut said = self.board.pass(self.now);
            for frame in self.to.arrived(self.now) {
                said.extend(self.board.hear(&frame, self.now));
            }
            let is_cut = script.cut.is_some_and(|cut| began / 1000 + cut <= ms);
            for frame in said.iter().filter(|_| !is_cut) {
                self.from.put(frame, self.now, &self.faults, &mut self.dice);
            }
            for frame in self.from.arrived(self.now) {
                hearing.hear(&frame, |answer| heard.push(answer));
            }
            let mut all: Vec<Event> = heard.drain(..).map(Event::Heard).collect();
            while let Some((_, event)) = events.first().filter(|(at, _)| *at <= self.now) {
                match event {
                    Some(event) => all.push(*event),
                    None => self.board.restart(),
                }
                events.remove(0);
            }
            all.push(Event::Pass);
            for event in all {
                sender.take(event, ms, &mut actions);
                for action in actions.drain(..) {
                    let (tag, want) = match action {
                        Action::End(end) => return end,
                        Action::Send(tag, want) => (tag, want),
                    };
                    let next = sender.next();
                    let request = match want {
                        Want::Ask => Request::Ask,
                        Want::Begin { boot } => Request::Begin { boot, job, header: &header },
                        Want::Join { boot } => Request::Join { boot, job },
                        Want::Block(number) => Request::Block(feed.block(number, next).unwrap()),
                        Want::Order { number, order } => Request::Order { number, order },
                    };
                    let frame = request.frame(self.run, tag);
                    if !is_cut {
                        self.to.put(&frame, self.now, &self.faults, &mut self.dice);
                    }
                }
            }
            let waits = [self.board.wakes_at(), self.to.next(), self.from.next()];
            let event = events.first().map(|(at, _)| *at);
            let wake = waits.into_iter().flatten().chain(event).min();
            let wake = wake.unwrap_or(u64::MAX).min(1000 * sender.wakes_at());
            self.now = wake.max(self.now + 1000);
        }
    }

    /// The board does what it can without hearing more.
    fn settle(&mut self) {
        while let Some(at) = self.board.wakes_at() {
            self.now = at.max(self.now);
            self.board.pass(self.now);
        }
    }

    /// What has to hold however it ended.
    fn judge(&self, bytes: &[u8], end: &Result<Ended, Cause>) {
        let (expected, lives) = (steps(bytes), &self.board.lives);
        assert!(lives.iter().all(|life| expected.starts_with(life)), "other steps");
        // A board that has stepped and restarted does not know where it stands.
        assert!(lives.iter().filter(|life| !life.is_empty()).count() <= 1, "begun in the middle");
        match end {
            Ok(Ended::Done) => {
                // It may restart after all was done.
                assert!(lives.contains(&expected) && self.board.is_off());
            }
            Ok(Ended::Stopped) => assert!(self.board.is_off()),
            Err(_) => {}
        }
    }
}

impl Script {
    /// In their order; `None` is a restart.
    fn events(&self, began: u64) -> Vec<(u64, Option<Event>)> {
        let mut all: Vec<(u64, Option<Event>)> = Vec::new();
        all.extend(self.restarts.iter().map(|at| (*at, None)));
        for (at, long) in &self.pauses {
            all.extend([(*at, Some(Event::Pause)), (at + long, Some(Event::Go))]);
        }
        all.extend(self.stop.map(|at| (at, Some(Event::Stop))));
        all.sort_by_key(|(at, _)| *at);
        all.into_iter().map(|(at, event)| (began + 1000 * at, event)).collect()
    }
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

fn faults(most: u64, delay: u64) -> impl Strategy<Value = Faults> {
    let percent = || 0..=most;
    (percent(), percent(), percent(), 0..=delay, any::<bool>()).prop_map(
        |(drop, twice, damage, delay, overtakes)| Faults { drop, twice, damage, delay, overtakes },
    )
}

fn kind() -> impl Strategy<Value = Kind> {
    (1_u32..9, prop_oneof![Just(1_u64), Just(20)], prop_oneof![Just(0), Just(9 * SECOND)])
        .prop_map(|(room, haste, heats_for)| Kind { room, haste, heats_for, ..Kind::default() })
}

proptest! {
    #![proptest_config(config(1000))]

    /// A line that is poor, and all that a person may do: it ends well.
    #[test]
    fn a_poor_line_executes_each_step_once(
        (kind, faults) in (kind(), faults(5, 300)),
        (steps, seed) in (0_u64..3000, any::<u64>()),
        pauses in prop::collection::vec((0_u64..9000, 0_u64..40_000), 0..3),
    ) {
        let bytes = stream(steps, seed);
        let mut world = World::new(kind, faults, seed);
        let end = world.send(&bytes, false, &Script { pauses, ..Script::default() });
        world.judge(&bytes, &end);
        prop_assert!(matches!(end, Ok(Ended::Done)), "{end:?}");
    }

    /// Whatever happens: no step twice, none in another place, none after a restart, and it ends.
    #[test]
    fn a_bad_line_and_restarts_end_in_time_and_print_nothing_wrong(
        (kind, faults) in (kind(), faults(40, 3000)),
        (steps, seed) in (0_u64..2000, any::<u64>()),
        restarts in prop::collection::vec(0_u64..20_000, 0..3),
        pauses in prop::collection::vec((0_u64..9000, 0_u64..5000), 0..2),
        stop in prop::option::of(0_u64..20_000),
        cut in prop::option::of(0_u64..20_000),
    ) {
        let bytes = stream(steps, seed);
        let mut world = World::new(kind, faults, seed);
        let has_stop = stop.is_some();
        let script = Script { restarts: restarts.clone(), pauses, stop, cut };
        let end = world.send(&bytes, false, &script);
        world.judge(&bytes, &end);
        match end {
            Ok(Ended::Done) => {}
            Ok(Ended::Stopped) | Err(Cause::Unstopped) => prop_assert!(has_stop),
            Err(Cause::NoAnswer { .. } | Cause::NotTaken { .. }) => {}
            Err(Cause::Restarted { .. }) => prop_assert!(!restarts.is_empty()),
            Err(other) => prop_assert!(false, "{other:?}"),
        }
    }

    /// The line fails, the board does not: another sender goes on, and each step is made once.
    #[test]
    fn another_sender_goes_on_where_the_line_failed(
        (kind, faults) in (kind(), faults(5, 100)),
        (steps, seed) in (300_u64..3000, any::<u64>()),
        cut in 100_u64..6000,
    ) {
        let bytes = stream(steps, seed);
        let mut world = World::new(kind, faults, seed);
        let script = Script { cut: Some(cut), ..Script::default() };
        let mut end = world.send(&bytes, false, &script);
        world.settle();
        let holds = [board::RUNNING, board::PAUSED].contains(&world.board.state);
        if holds && let Err(Cause::NoAnswer { begun: true }) = end {
            prop_assert!(!world.board.is_off());
            // Who begins anew is refused, and so is another file.
            let anew = world.send(&bytes, false, &Script::default());
            prop_assert!(matches!(anew, Err(Cause::Busy(_))), "{anew:?}");
            let other = world.send(&stream(steps + 1, seed), true, &Script::default());
            prop_assert!(matches!(other, Err(Cause::NothingHeld)), "{other:?}");
            end = world.send(&bytes, true, &Script::default());
            prop_assert!(matches!(end, Ok(Ended::Done)), "{end:?}");
        }
        world.judge(&bytes, &end);
    }
}

/// What a kind of board and a script lead to on a good line, and after how many seconds.
fn on_a_good_line(kind: Kind, steps: u64, script: &Script) -> (Result<Ended, Cause>, World, u64) {
    let bytes = stream(steps, 5);
    let mut world = World::new(kind, Faults::default(), 1);
    let end = world.send(&bytes, false, script);
    world.judge(&bytes, &end);
    let seconds = world.now / SECOND;
    (end, world, seconds)
}

#[test]
fn a_board_that_does_not_answer_ends_the_run_in_twelve_seconds() {
    let cut = Script { cut: Some(0), ..Script::default() };
    let (end, _, seconds) = on_a_good_line(Kind::default(), 100, &cut);
    assert!(matches!(end, Err(Cause::NoAnswer { begun: false })), "{end:?}");
    assert_eq!(seconds, 12);
    let cut = Script { cut: Some(2000), ..Script::default() };
    let (end, world, _) = on_a_good_line(Kind::default(), 3000, &cut);
    assert!(matches!(end, Err(Cause::NoAnswer { begun: true })), "{end:?}");
    // It executes what it holds, and waits.
    assert!(world.board.state == board::RUNNING && world.board.done == world.board.next);
}

#[test]
fn boards_that_refuse_fail_or_do_nothing_are_told_apart() {
    let kind = |change: fn(&mut Kind)| {
        let mut kind = Kind::default();
        change(&mut kind);
        on_a_good_line(kind, 1000, &Script::default())
    };
    let refused = |change| match kind(change).0 {
        Err(Cause::Refused { reason, axis }) => (reason, axis),
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(|kind| kind.scale = Some((100, 1))), (2, Some(0)));
    assert_eq!(refused(|kind| kind.interval = 101), (3, Some(0)));
    assert_eq!(refused(|kind| kind.is_lost = true), (4, None));
    assert!(matches!(kind(|kind| kind.version = 2).0, Err(Cause::Protocol(2))));
    let (end, world, _) = kind(|kind| kind.fails_at = Some(2));
    assert!(matches!(end, Err(Cause::Failed { reason: 16, axis: Some(1), done: 2 })), "{end:?}");
    assert!(world.board.is_off());
    let (end, _, seconds) = kind(|kind| kind.is_deaf = true);
    assert!(matches!(end, Err(Cause::NotTaken { begun: true, .. })) && seconds < 12, "{end:?}");
    let (end, world, _) = kind(|kind| kind.lies = true);
    assert!(matches!(end, Err(Cause::Nonsense(_))) && world.board.is_off(), "{end:?}");
    let (end, world, seconds) = kind(|kind| kind.haste = 0);
    assert!(end.unwrap_err().to_string().contains("runs but executes nothing"));
    assert!(world.board.is_off() && seconds < 40);
    let (end, world, seconds) = kind(|kind| kind.heats_for = 9000 * SECOND);
    assert!(end.unwrap_err().to_string().contains("does not get ready"));
    assert!(world.board.is_off() && seconds < 1810);
    let busy = Cause::Open(std::io::ErrorKind::ResourceBusy.into()).to_string();
    assert!(busy.contains("another program has it open"), "{busy}");
    assert!(matches!(kind(|kind| kind.heats_for = 1700 * SECOND).0, Ok(Ended::Done)));
}

#[test]
fn a_restart_ends_the_print_once_a_block_was_sent_and_not_before() {
    let at = |ms| Script { restarts: vec![ms], ..Script::default() };
    for ms in [0, 1, 2] {
        let (end, world, _) = on_a_good_line(Kind::default(), 1000, &at(ms));
        assert!(matches!(end, Ok(Ended::Done)) && world.board.lives.len() == 2, "{ms}: {end:?}");
    }
    for ms in [10, 100, 2500] {
        let (end, world, _) = on_a_good_line(Kind::default(), 1000, &at(ms));
        assert!(matches!(end, Err(Cause::Restarted { .. })), "{ms}: {end:?}");
        assert!(world.board.is_off() && world.board.lives[1].is_empty());
    }
}

#[test]
fn a_pause_stands_still_and_a_stop_turns_all_off() {
    let script = Script { pauses: vec![(1000, 600_000)], ..Script::default() };
    let (end, world, seconds) = on_a_good_line(Kind::default(), 1000, &script);
    assert!(matches!(end, Ok(Ended::Done)) && seconds >= 601, "{end:?} {seconds}");
    assert_eq!(world.board.state, board::DONE);
    for ms in [0, 1, 3, 5, 1000, 1001] {
        let script = Script { stop: Some(ms), pauses: vec![(500, 9000)], ..Script::default() };
        let (end, mut world, seconds) = on_a_good_line(Kind::default(), 1000, &script);
        assert!(matches!(end, Ok(Ended::Stopped)) && seconds <= 1 && world.board.is_off());
        // What is under way still comes, and nothing begins of it.
        for frame in world.to.arrived(u64::MAX - 1) {
            world.board.hear(&frame, world.now);
        }
        world.board.pass(world.now + 9 * SECOND);
        assert!(world.board.is_off());
    }
}

#[test]
fn who_joins_a_board_that_stands_still_lets_it_go_on() {
    let script = Script { pauses: vec![(900, 999_000)], cut: Some(2000), ..Script::default() };
    let (end, mut world, _) = on_a_good_line(Kind::default(), 3000, &script);
    assert!(matches!(end, Err(Cause::NoAnswer { begun: true })), "{end:?}");
    assert_eq!(world.board.state, board::PAUSED);
    let bytes = stream(3000, 5);
    let end = world.send(&bytes, true, &Script::default());
    world.judge(&bytes, &end);
    assert!(matches!(end, Ok(Ended::Done)), "{end:?}");
}

#[test]
fn the_example_of_the_protocol_is_what_is_sent_and_said() {
    let page = include_str!("../../src/steps/send/PROTOCOL.md");
    let (_, example) = page.split_once("from it:").unwrap();
    let of_line = |line: &str| -> Vec<u8> {
        let bytes = line.split("  ").next().unwrap_or_default().split(' ');
        bytes.map_while(|byte| u8::from_str_radix(byte, 16).ok()).collect()
    };
    let told: Vec<u8> = example.lines().flat_map(of_line).collect();
    let format = include_str!("../../src/steps/FORMAT.md");
    let (_, stream) = format.split_once("is this stream:").unwrap();
    let stream: Vec<u8> = stream.lines().skip(3).flat_map(of_line).collect();
    let (mut board, mut made) = (Board::new(Kind { room: 8, ..Kind::default() }), Vec::new());
    let job = Job { sum: crc32fast::hash(&stream), blocks: 2 };
    let second = 216 + 10 + 41 + 4;
    let order = Order::Pause;
    let requests = [
        Request::Ask,
        Request::Begin { boot: 1, job, header: &stream[..216] },
        Request::Block(&stream[216..second]),
        Request::Block(&stream[second..]),
        Request::Order { number: 1, order },
    ];
    for (k, request) in requests.iter().enumerate() {
        let frame = request.frame(7, k as u32 + 1);
        if k == 0 {
            let inner = board::unstuffed(&frame[1..frame.len() - 1]);
            let plain: Vec<String> = inner.iter().map(|byte| format!("{byte:02X}")).collect();
            assert!(page.contains(&format!("\n{}\n", plain.join(" "))), "{plain:?}");
        }
        made.extend(&frame);
        made.extend(board.hear(&frame, 0).concat());
    }
    if told != made && std::env::var_os("SHOW_EXAMPLE").is_some() {
        let lines: Vec<String> = made
            .split_inclusive(|byte| *byte == 0)
            .map(|part| part.iter().map(|byte| format!("{byte:02X} ")).collect())
            .collect();
        panic!("{}", lines.join("\n"));
    }
    assert_eq!(told, made);
}
