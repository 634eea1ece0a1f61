//! A damaged stream of steps -> a refusal, or the very stream: no damaged block is ever played.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use super::{config, damage, damaged, fixture, in_time, properties};
use proptest::prelude::*;
use slicer::profile::{self, Override, ValueOrigin};
use slicer::reader::Reading;
use slicer::steps::{Form, Options, make, play};
use std::sync::LazyLock;

/// A stream of a few blocks, of steps and of coils.
static STREAMS: LazyLock<[Vec<u8>; 2]> = LazyLock::new(|| {
    let set = |(key, value): (&str, &str)| Override {
        key: key.to_owned(),
        value: value.to_owned(),
        origin: ValueOrigin::Set,
    };
    let motors = [("steps.x", "80"), ("steps.y", "80"), ("steps.z", "400"), ("steps.e", "93")];
    let settings = profile::load(["generic-marlin"], &motors.map(set)).unwrap().settings;
    let text = "G1 X3 Y7 Z1 E2 F3000\nG1 X0 Y0\nG1 E1\nG4 P300\nG1 X1 Y1 Z0\n";
    [Form::Steps, Form::Coils([false, true, false, true])].map(|form| {
        let options = Options { reading: Reading::default(), form, start: None };
        let mut bytes = Vec::new();
        make(&mut text.as_bytes(), "x", &settings, options, &mut bytes).unwrap();
        bytes
    })
});

proptest! {
    #![proptest_config(config(2000))]
    #[test]
    fn no_damaged_stream_is_accepted(which in 0_usize..2, damages in damage()) {
        let good = &STREAMS[which];
        let bytes = damaged(good, &damages, STREAMS.as_slice());
        in_time("steps", || {
            let played = play(&mut bytes.as_slice(), "x.steps", |_| {}, |_, _| {});
            match played {
                Ok(_) => assert!(STREAMS.contains(&bytes), "{damages:?} is not seen"),
                Err(error) => {
                    assert!(!STREAMS.contains(&bytes), "{error}");
                    let text = error.to_string();
                    assert!(text.starts_with("x.steps: ") && !text.contains(char::is_control));
                }
            }
        });
    }
}

#[test]
fn every_bit_and_every_length_counts() {
    for good in STREAMS.iter() {
        let accepts = |bytes: &[u8]| play(&mut { bytes }, "x", |_| {}, |_, _| {}).is_ok();
        assert!(accepts(good));
        for at in 0..good.len() {
            let mut bytes = good.clone();
            bytes[at] ^= 1 << (at % 8);
            assert!(!accepts(&bytes), "byte {at}");
            if at % 7 == 0 {
                assert!(!accepts(&good[..at]), "{at} bytes");
            }
        }
    }
}

/// The header of a stream, and each of its blocks.
fn parts(stream: &[u8]) -> Vec<&[u8]> {
    let (header, mut rest) = stream.split_at(216);
    let mut parts = vec![header];
    while !rest.is_empty() {
        let length = 14 + usize::from(u16::from_le_bytes([rest[2], rest[3]]));
        let (block, after) = rest.split_at(length);
        parts.push(block);
        rest = after;
    }
    parts
}

/// The part with its checksum made right.
fn sealed(part: &[u8]) -> Vec<u8> {
    let mut bytes = part[..part.len() - 4].to_vec();
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

#[test]
fn blocks_that_are_lost_or_come_twice_or_out_of_order_are_seen() {
    let accepts = |parts: &[&[u8]]| play(&mut &*parts.concat(), "x", |_| {}, |_, _| {}).is_ok();
    for good in STREAMS.iter() {
        let parts = parts(good);
        assert!(parts.len() > 4 && accepts(&parts));
        for k in 0..parts.len() {
            let (mut lost, mut twice) = (parts.clone(), parts.clone());
            lost.remove(k);
            twice.insert(k, parts[k]);
            assert!(!accepts(&lost) && !accepts(&twice), "part {k}");
            for j in 0..k {
                let mut swapped = parts.clone();
                swapped.swap(j, k);
                let mut moved = parts.clone();
                let part = moved.remove(k);
                moved.insert(j, part);
                assert!(!accepts(&swapped) && !accepts(&moved), "parts {j} and {k}");
            }
        }
        for more in [&[0][..], b"\n", parts[1], parts[parts.len() - 1], good] {
            assert!(!accepts(&[&parts[..], &[more]].concat()), "{} bytes more", more.len());
        }
    }
}

/// Numbers at an edge of something, as the eight bytes of a field or the first of them.
fn edges() -> impl Strategy<Value = [u8; 8]> {
    let edges = [0, 1, -1, 7, 1 << 29, 1 << 31, 1 << 32, 1_000_000_000_000_000_000];
    let edges = edges.into_iter().chain([i64::MIN, i64::MAX]).map(i64::to_le_bytes);
    prop_oneof![prop::sample::select(edges.collect::<Vec<_>>()), any::<[u8; 8]>()]
}

proptest! {
    #![proptest_config(config(500))]
    #[test]
    fn headers_that_are_sealed_may_say_anything(
        which in 0_usize..2,
        fields in prop::collection::vec((8_usize..212, 1_usize..9, edges()), 1..6),
    ) {
        let parts = parts(&STREAMS[which]);
        let mut header = parts[0].to_vec();
        for (at, bytes, number) in fields {
            let end = (at + bytes).min(212);
            header[at..end].copy_from_slice(&number[..end - at]);
        }
        let bytes = [&sealed(&header)[..], &parts[1..].concat()].concat();
        in_time("a header", || properties::stream(&bytes));
    }

    #[test]
    fn blocks_that_are_changed_and_sealed_may_hold_anything(
        which in 0_usize..2,
        at in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 1_usize..9, edges()), 1..4),
    ) {
        let parts = parts(&STREAMS[which]);
        let k = 1 + at.index(parts.len() - 1);
        let mut block = parts[k].to_vec();
        for (at, bytes, number) in changes {
            let at = at.index(block.len() - 4);
            let end = (at + bytes).min(block.len() - 4);
            block[at..end].copy_from_slice(&number[..end - at]);
        }
        let sealed = sealed(&block);
        let bytes = [&parts[..k].concat()[..], &sealed, &parts[k + 1..].concat()].concat();
        in_time("a block", || properties::stream(&bytes));
    }
}

/// The header of a stream of steps, then a block with this payload and these directions.
fn of_block(payload: &[u8], backwards: u8, count: u8) -> Vec<u8> {
    let mut block = vec![1, backwards, payload.len() as u8, 0, 0, 0, 0, 0, count, 0];
    block.extend(payload);
    block.extend([0; 4]);
    [&STREAMS[0][..216], &sealed(&block)].concat()
}

#[test]
fn numbers_that_no_board_can_hold_are_refused() {
    let error = |bytes: &[u8]| {
        play(&mut { bytes }, "x", |_| {}, |_, _| {}).expect_err("it has no end").to_string()
    };
    // Without a last block each of them is cut off; what is wrong in the block itself comes first.
    let far = |high: u8| [0xF1, 0xFF, 0xFF, 0xFF, 0xFF, high];
    let cut = error(&of_block(&far(7), 0, 1));
    assert!(error(&of_block(&far(8), 0, 1)) != cut, "2^31 µs");
    assert!(error(&of_block(&[0x10, 0xFF, 0xFF, 0xFF, 0xFF, 8], 0, 0)) != cut, "a pause");
    assert!(error(&of_block(&[&far(7)[..], &[0x81]].concat(), 0, 2)) != cut, "one more");
    assert!(error(&of_block(&far(7), 16, 1)) != cut, "a fifth axis");
    let mut parts = parts(&STREAMS[0]);
    let mut last = parts.pop().unwrap().to_vec();
    last[82..90].copy_from_slice(&u64::MAX.to_le_bytes());
    let bytes = [parts.concat(), sealed(&last)].concat();
    assert!(play(&mut &*bytes, "x", |_| {}, |_, _| {}).is_err(), "584 000 years");
}

#[test]
fn no_feed_and_no_wait_make_a_stream_without_end() {
    let set = |(key, value): (&str, &str)| Override {
        key: key.to_owned(),
        value: value.to_owned(),
        origin: ValueOrigin::Set,
    };
    let motors = [("steps.x", "8"), ("steps.y", "8"), ("steps.z", "40"), ("steps.e", "9")];
    for ramps in ["true", "false"] {
        let keys = motors.into_iter().chain([("steps.ramps", ramps)]).map(set);
        let settings =
            profile::load(["generic-marlin"], &keys.collect::<Vec<_>>()).unwrap().settings;
        for text in [
            "G1 X10 F0.0000000000000001\nG1 X0\n",
            "M220 S-50\nG1 X10 F600\nG1 X0\n",
            "M220 S0\nG1 X10 F600\nG1 X0\n",
            "G4 S999999999\nG1 X10 F600\nG4 S999999999\nG1 X0\n",
        ] {
            let options =
                Options { reading: Reading::default(), form: Form::Coils([false; 4]), start: None };
            let mut bytes = Vec::new();
            in_time("a wait", || {
                match make(&mut text.as_bytes(), "x", &settings, options, &mut bytes) {
                    Ok(made) => {
                        assert!(made.totals.time > 1_000_000, "{text}: {}", made.totals.time)
                    }
                    Err(error) => {
                        assert!(error.to_string().starts_with("x: it takes more than"), "{error}")
                    }
                }
            });
            assert!(bytes.len() < 1 << 22, "{text}: {} bytes", bytes.len());
        }
    }
}

proptest! {
    #![proptest_config(config(500))]
    #[test]
    fn blocks_that_are_sealed_may_hold_anything(
        which in 0_usize..2,
        kind in 0_u8..3,
        count in 0_u16..9,
        payload in prop::collection::vec(prop_oneof![any::<u8>(), 0_u8..64], 0..80),
    ) {
        let mut bytes = STREAMS[which][..216].to_vec();
        let mut block = vec![kind, 0];
        block.extend((payload.len() as u16).to_le_bytes());
        block.extend(0_u32.to_le_bytes());
        block.extend(count.to_le_bytes());
        block.extend(payload);
        block.extend(crc32fast::hash(&block).to_le_bytes());
        bytes.extend(block);
        properties::stream(&bytes);
    }
}

#[test]
fn damaged_gcode_becomes_a_stream_or_is_refused() {
    let files = ["clock.gcode", "bent.gcode"].map(fixture);
    proptest!(config(60), |(which in 0..files.len(), damages in damage())| {
        let file = damaged(&files[which], &damages, &files);
        in_time("steps of a file", || properties::steps(&file));
    });
}
