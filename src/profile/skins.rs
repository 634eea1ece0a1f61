//! Settings -> verdict: whether skins that follow the surface, and the head over them, can be as they are set.

use super::Settings;
use super::blame::Blame;
use super::error::{Conflict, Result};

/// Slack for comparing lengths and angles that were written as decimals.
const SLACK: f64 = 1e-9;

/// Checks the head, and with `nonplanar.enabled` whether any skin can follow a surface.
///
/// # Errors
/// [`Conflict`] with the origin of one of the values concerned.
pub(super) fn check(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    parts(settings, blame)?;
    let skins = &settings.nonplanar;
    if !skins.enabled {
        return Ok(());
    }
    if !settings.has_top_skins() {
        let keys = ["nonplanar.enabled", "top_layers", "top_thickness"];
        return Err(blame.error(&keys, Conflict::NothingToFollow));
    }
    let (least, height) = (skins.min_height, settings.layer_height);
    if skins.contour && least > height + SLACK {
        let keys = ["nonplanar.min_height", "layer_height"];
        return Err(blame.error(&keys, Conflict::ContourTooHigh { least, height }));
    }
    let (least, most) = (skins.min_slope, settings.steepest_skin());
    if least > most + SLACK {
        let by_head = settings.head().steepest() <= most;
        let (by, remedy, keys) = if by_head {
            let keys = ["nonplanar.min_slope", "head.discs", "head.cone", "head.name"];
            ("the head leaves free", "name another head with head.name", keys)
        } else {
            let keys = ["nonplanar.min_slope", "head.flat", "layer_height", "head.name"];
            ("head.flat may press into a layer", "use thicker layers", keys)
        };
        return Err(blame.error(&keys, Conflict::NoSlope { least, most, by, remedy }));
    }
    Ok(())
}

/// Parts of a head have a size, and hang no lower than its tip.
fn parts(settings: &Settings, blame: &Blame<'_>) -> Result<()> {
    let wrong = |key: &'static str, index: usize, why: &'static str| {
        Err(blame.error(&[key], Conflict::NoSuchPart { key, number: index + 1, why }))
    };
    for (index, &[radius, _]) in settings.head.discs.iter().flatten().enumerate() {
        if radius <= 0.0 {
            return wrong("head.discs", index, "its radius must be more than 0");
        }
    }
    for (index, &[x0, y0, x1, y1, z]) in settings.head.boxes.iter().flatten().enumerate() {
        if x0 >= x1 || y0 >= y1 {
            let why = "write the lower x and y first, then the higher, then z";
            return wrong("head.boxes", index, why);
        }
        if z < 0.0 {
            return wrong(
                "head.boxes",
                index,
                "it must not hang below the tip, z must be 0 or more",
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::head::named;
    use crate::profile::{
        DEFAULT, HeadName, Override, Profile, ValueOrigin, dump, load, recorded_with,
    };
    use std::fs;

    fn given(list: &[(&str, &str)]) -> Vec<Override> {
        let one = |(key, value): &(&str, &str)| Override {
            key: (*key).to_owned(),
            value: (*value).to_owned(),
            origin: ValueOrigin::Set,
        };
        list.iter().map(one).collect()
    }

    fn made(profiles: &[&str], set: &[(&str, &str)]) -> Result<Profile, String> {
        load(profiles, &given(set)).map_err(|error| error.to_string())
    }

    #[test]
    fn what_cannot_be_printed_is_refused_in_one_line() {
        let on = ("nonplanar.enabled", "true");
        for (set, text) in [
            (
                &[on, ("top_layers", "0")][..],
                "--set: nonplanar.enabled lets tops follow the surface, and there are",
            ),
            (
                &[on, ("layer_height", "0.05")],
                "--set: nonplanar.min_height = 0.06 mm is more than layer_height = 0.05 mm",
            ),
            (
                &[on, ("nonplanar.min_slope", "5")],
                "--set: nonplanar.min_slope = 5 degrees is more than the 4.3 degrees that the head leaves free; make it smaller, or name another head",
            ),
            (
                &[on, ("head.name", "long-0.6"), ("nonplanar.min_slope", "25")],
                "--set: nonplanar.min_slope = 25 degrees is more than the 21.8 degrees that head.flat may press",
            ),
            (
                &[on, ("head.discs", "[[300, 1]]")],
                "--set: nonplanar.min_slope = 0.5 degrees is more than the 0.2 degrees that the head",
            ),
            (
                &[("head.boxes", "[[1,1,2,2,5],[1,1,0,2,5]]")],
                "--set: head.boxes, number 2 of them: write the lower",
            ),
            (
                &[("head.boxes", "[[1,1,2,2,-5]]")],
                "--set: head.boxes, number 1 of them: it must not hang",
            ),
            (&[("head.discs", "[[0,2]]")], "--set: head.discs, number 1 of them: its radius"),
            (
                &[("head.cone", "90")],
                "--set: head.cone = 90 is out of range; it must be 1 to 89 degrees",
            ),
        ] {
            let error = made(&[DEFAULT], set).unwrap_err();
            assert!(error.starts_with(text), "{error}");
            assert!(!error.contains('\n'));
        }
        // Without skins that follow the surface none of it matters.
        assert!(made(&[DEFAULT], &[("nonplanar.min_slope", "45"), ("top_layers", "0")]).is_ok());
        let low = [on, ("layer_height", "0.05"), ("nonplanar.contour", "false")];
        assert!(made(&[DEFAULT], &low).is_ok());
    }

    #[test]
    fn a_named_head_is_the_one_of_its_name() {
        let words: Vec<&str> = named::names().collect();
        let key = crate::profile::keys::find("head.name").unwrap();
        assert_eq!(key.allowed(), words.join(" | "));
        for word in words {
            let head = made(&[DEFAULT], &[("head.name", word)]).unwrap().settings.head();
            assert_eq!(Some(head), named::named(word));
        }
        assert_eq!(made(&[DEFAULT], &[]).unwrap().settings.head(), named::cautious());
    }

    #[test]
    fn a_name_replaces_the_head_of_profiles_before_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("own.toml");
        let text =
            "inherits = \"generic-marlin\"\n[head]\ncone = 30\nname = \"v6\"\ndiscs = [[7, 3]]\n";
        fs::write(&path, text).unwrap();
        let own = path.to_str().unwrap();
        // In one profile they go together, whatever their order.
        let head = made(&[own], &[]).unwrap().settings.head();
        assert_eq!(
            (head.cone, &head.discs[..], head.boxes),
            (30.0, &[[7.0, 3.0]][..], named::v6().boxes)
        );
        let head = made(&[own], &[("head.flat", "0.6")]).unwrap().settings.head();
        assert_eq!((head.cone, head.flat), (30.0, 0.6));
        // `--set` before the flag's name holds too.
        let head = made(&[own], &[("head.cone", "3"), ("head.name", "long-0.6")]).unwrap();
        let long = named::long();
        assert_eq!(head.settings.head(), crate::head::Head { cone: 3.0, ..long });
        // So it is over what a file holds.
        let lines = dump(&made(&[own], &[]).unwrap().settings);
        let over = recorded_with(&lines, &given(&[("head.name", "v6")])).unwrap().unwrap();
        assert_eq!(over.settings.head(), named::v6());
        let over = recorded_with(&lines, &given(&[("head.cone", "3")])).unwrap().unwrap();
        assert_eq!((over.settings.head().cone, over.settings.head.name), (3.0, HeadName::V6));
    }

    #[test]
    fn files_from_before_there_was_a_head_have_the_cautious_one() {
        let mut lines = dump(&made(&[DEFAULT], &[]).unwrap().settings);
        lines.retain(|(key, _)| {
            !["head.", "nonplanar.", "speed.nonplanar"].iter().any(|new| key.starts_with(new))
        });
        let read = recorded_with(&lines, &[]).unwrap().unwrap().settings;
        assert_eq!(read.head(), named::cautious());
        assert!(!read.nonplanar.enabled);
    }
}
