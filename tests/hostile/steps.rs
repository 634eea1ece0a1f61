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
