//! Laws of skins that are laid by hand.

use super::relief::Relief;
use super::skins::{Name, Skins};
use crate::check::finding::{Code, Findings};
use crate::check::terms::Terms;
use crate::reader::print::Step;
use crate::reader::{Facts, Role};

/// Lines along x, or along y, side by side over a square between two places, 0.4 mm wide.
fn rows([low, high]: [f32; 2], along: usize, z: f32, height: f32) -> Vec<Step> {
    let count = ((high - low) / 0.4).round() as u16;
    let row = |k: u16| {
        let across = low + 0.4 * (f32::from(k) + 0.5);
        let at = |way: f32| if along == 0 { [way, across, z] } else { [across, way, z] };
        let filament = 0.4 * height * (high - low);
        let (from, to) = (at(low), at(high));
        Step { from, to, filament, feed: 30.0, width: 0.4, height, role: Role::NonPlanar, line: 1 }
    };
    (0..count).map(row).collect()
}

#[test]
fn a_lower_skin_under_the_middle_of_the_upper_one_has_its_own_room() {
    // The base is larger than the skins.
    let (all, own) = ([0.0, 16.0], [0.8, 15.2]);
    let is_middle = |step: &Step| (6.0..10.0).contains(&step.from[1]);
    let mut terms = Terms::new(None, None, &Facts::default());
    terms.filament_area = 1.0;
    for flow in [1.0, 2.0] {
        let (mut relief, mut skins) = (Relief::default(), Skins::default());
        let higher = rows(all, 0, 1.2, 0.2).into_iter().filter(|step| !is_middle(step));
        let base = rows(all, 0, 0.94, 0.2).into_iter().chain(higher);
        base.for_each(|step| relief.lay(&step, false, [None; 2]));
        let lower = rows(own, 0, 1.2, 0.26).into_iter().filter(is_middle);
        let skin = lower.chain(rows(own, 1, 1.4, 0.2));
        for step in skin {
            let step = Step { filament: flow * step.filament, ..step };
            relief.lay(&step, true, [None; 2]);
            skins.line(Name::Patch(1), &step, (Some(0), true));
        }
        let mut found = Findings::default();
        skins.finish(&relief, &terms, &mut found);
        let codes: Vec<Code> = found.into_iter().map(|one| one.code).collect();
        let right: &[Code] = if flow > 1.0 { &[Code::DoubleSkin] } else { &[] };
        assert_eq!(codes, right, "{flow}");
    }
}
