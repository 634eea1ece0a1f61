//! Difference -> Findings: what makes two files unequal, worst first.
//!
//! A cause is reported once, where it says most:
//! - a print that moved as a whole is one finding, a part of a plate that moved alone likewise, and all else is
//!   looked at as if it had not;
//! - limits that only one file sets are one finding, whatever they do to how many layers;
//! - layers that only one file has, and roles that only one file has in a layer, are one finding for
//!   all layers together, not one for each;
//! - layers at other heights likewise, with the one that differs most; seams with the farthest;
//! - lines that are far or unlike are a finding for each layer and role, with the worst place; travels
//!   one for each layer;
//! - where the lines are the same in another order, other travels follow: one finding for all such
//!   layers, but for those where the nozzle also goes lower or higher;
//! - a sum of a layer is a finding only if no line of it is: lines that are drawn twice lie nowhere
//!   else, and only their sum shows;
//! - sums of the file come last.
//!
//! Findings are sorted by [`Kind`](super::Kind), in the order of what spoils a print most, and in a
//! kind by how far, how much or how long.

use super::codes::Orders;
use super::finding::{File, Finding, Ordered, Quantity};
use super::pair::{PairOfLayers, RoleOfPair};
use super::place::Place;
use super::seams::WALLS;
use super::sums::{Both, Sum};
use super::travels::TravelsOfPair;
use super::{Difference, Tolerances};
use crate::reader::Role;

/// What in this difference makes the files unequal, worst first.
pub(super) fn findings(difference: &Difference, tolerances: &Tolerances) -> Vec<Finding> {
    let mut found = Vec::new();
    for file in [File::A, File::B] {
        found.extend(only_in(file, &difference.pairs));
        let roles = Role::ALL.into_iter();
        found.extend(roles.filter_map(|role| role_only_in(file, role, &difference.pairs)));
    }
    found.extend(difference.moved_mm.map(|by_mm| Finding::Moved { by_mm }));
    found.extend(difference.parts_moved.iter().copied().map(Finding::PartMoved));
    found.extend(difference.limits_told.clone().map(|difference| Finding::Limits { difference }));
    let raised = difference.moved_mm.map_or(0.0, |[_, _, z]| z);
    found.extend(heights(&difference.pairs, raised, tolerances.place));
    for pair in &difference.pairs {
        if let Both { a: Some(a), b: Some(b) } = pair.layer {
            of_layer(pair, Both { a, b }, &mut found);
        }
    }
    of_orders(&difference.end, None, &mut found);
    of_travels(difference, &mut found);
    found.extend(WALLS.iter().filter_map(|wall| seams(*wall, &difference.pairs)));
    of_file(difference, &mut found);
    if tolerances.settings {
        found.extend(difference.settings.iter().cloned().map(Finding::Setting));
    }
    // Of equals the first in the file comes first: sorting keeps their order.
    found.sort_by(|a, b| {
        let ([a1, a2], [b1, b2]) = (a.weight(), b.weight());
        a.kind().cmp(&b.kind()).then(b1.total_cmp(&a1)).then(b2.total_cmp(&a2))
    });
    found
}

fn only_in(file: File, pairs: &[PairOfLayers]) -> Option<Finding> {
    let (mut layers, mut length_mm) = (Vec::new(), 0.0);
    for pair in pairs {
        let own = match (file, pair.layer) {
            (File::A, Both { a: own, b: None }) | (File::B, Both { a: None, b: own }) => own,
            _ => None,
        };
        let Some(own) = own else { continue };
        layers.push(own);
        let length = |role: &RoleOfPair| role.length_mm.a + role.length_mm.b;
        length_mm += pair.roles.iter().map(length).sum::<f64>();
    }
    (!layers.is_empty()).then_some(Finding::LayersOnlyIn { file, layers, length_mm })
}

fn role_only_in(file: File, role: Role, pairs: &[PairOfLayers]) -> Option<Finding> {
    let (mut layers, mut length_mm) = (Vec::new(), 0.0);
    let mut patches = Vec::new();
    for pair in pairs {
        let Both { a: Some(a), b: Some(b) } = pair.layer else { continue };
        for found in pair.roles.iter().filter(|one| one.role == role) {
            let patch = found.patch.unwrap_or_default();
            let (number, own, patch) = match file {
                File::A => (a, found.far_mm.a, patch.a),
                File::B => (b, found.far_mm.b, patch.b),
            };
            if own > 0.0 && found.farthest.is_none() {
                if layers.last() != Some(&number) {
                    layers.push(number);
                }
                patches.extend(patch);
                length_mm += own;
            }
        }
    }
    (!layers.is_empty()).then_some(Finding::RoleOnlyIn { file, role, layers, patches, length_mm })
}

fn heights(pairs: &[PairOfLayers], raised: f64, tolerance: f64) -> Option<Finding> {
    let mut count = 0;
    let mut worst: Option<(f64, Both<usize>, Both<f64>)> = None;
    for pair in pairs {
        let (Both { a: Some(a), b: Some(b) }, Both { a: Some(low), b: Some(high) }) =
            (pair.layer, pair.z_mm)
        else {
            continue;
        };
        let apart = (low + raised - high).abs();
        if apart <= tolerance + super::apart::SLACK {
            continue;
        }
        count += 1;
        if worst.is_none_or(|(most, ..)| apart > most) {
            worst = Some((apart, Both { a, b }, Both { a: low, b: high }));
        }
    }
    worst.map(|(_, layer, z_mm)| Finding::Heights { count, layer, z_mm })
}

/// Where the nozzle goes between lines, and what it pulls back.
fn of_travels(difference: &Difference, found: &mut Vec<Finding>) {
    let mut lines: Option<Finding> = None;
    let mut travels: Option<Finding> = None;
    let mut retractions: Option<Finding> = None;
    let pairs = difference.pairs.iter().filter_map(|pair| {
        let Both { a: Some(a), b: Some(b) } = pair.layer else { return None };
        let z = pair.z_mm;
        Some((Some(Both { a, b }), z, pair.travels.as_ref()?))
    });
    let none = Both { a: None, b: None };
    let end = difference.end_travels.iter().map(|travels| (None, none, travels));
    let mut other_before = false;
    for (layer, z, own) in pairs.chain(end) {
        let z = Both { a: z.a.unwrap_or_default(), b: z.b.unwrap_or_default() };
        let own_order = own.lines_other_from;
        // Where the layer before ends elsewhere, the way from there is another one.
        let way_from_there =
            own.other_from.filter(|_| other_before && own.is_far() && own.has_same_lines);
        other_before = own_order.is_some();
        let other_lines = own_order.or(way_from_there);
        let is_as_high = own.is_as_high(z, difference.tolerance_mm);
        if let Some(farthest) = own.farthest.filter(|_| other_lines.is_none() || !is_as_high) {
            let TravelsOfPair { length_mm, far_mm, z_mm, .. } = *own;
            let layer = if own.is_before_layers { Some(Both::default()) } else { layer };
            found.push(Finding::Travels { layer, length_mm, far_mm, z_mm, farthest });
        }
        if let Some(line) = other_lines {
            order(&mut lines, Ordered::Lines, layer, line, own.farthest);
        } else if let Some(line) = own.other_from.filter(|_| !own.is_far()) {
            order(&mut travels, Ordered::Travels, layer, line, None);
        }
        if !(own.is_far() || own.pulled_mm.equal && own.pushed_mm.equal) {
            retracted(&mut retractions, layer, own);
        }
    }
    found.extend([lines, travels, retractions].into_iter().flatten());
    let count = difference.firmware_retractions;
    if difference.travels && count.a != count.b {
        found.push(Finding::FirmwareRetractions { count });
    }
}

/// Adds a layer to those with another order.
fn order(
    known: &mut Option<Finding>,
    of: Ordered,
    layer: Option<Both<usize>>,
    line: Both<u32>,
    place: Option<Place>,
) {
    let first = Finding::Order { of, layers: Vec::new(), layer, line, farthest: None };
    if let Finding::Order { layers, farthest, .. } = known.get_or_insert(first) {
        layers.extend(layer.map(|layer| layer.a));
        let is_farther = |place: &Place| {
            farthest.is_none_or(|known: Place| place.distance_mm > known.distance_mm)
        };
        *farthest = place.filter(is_farther).or(*farthest);
    }
}

/// Adds a layer to those with other retractions.
fn retracted(known: &mut Option<Finding>, layer: Option<Both<usize>>, own: &TravelsOfPair) {
    let both = |sum: &Sum| Both { a: sum.a, b: sum.b };
    let (pulled_mm, pushed_mm) = (both(&own.pulled_mm), both(&own.pushed_mm));
    let first = Finding::Retractions { layers: Vec::new(), layer, pulled_mm, pushed_mm };
    if let Finding::Retractions { layers, .. } = known.get_or_insert(first) {
        layers.extend(layer.map(|layer| layer.a));
    }
}

/// Walls of a role that begin elsewhere, in all layers together.
fn seams(role: Role, pairs: &[PairOfLayers]) -> Option<Finding> {
    let mut worst: Option<(Both<usize>, Place)> = None;
    let (mut layers, mut moved) = (Vec::new(), Both::default());
    for pair in pairs {
        let Both { a: Some(a), b: Some(b) } = pair.layer else { continue };
        let Some(own) = pair.seams.iter().find(|own| own.role == role) else { continue };
        let Some(place) = own.farthest else { continue };
        layers.push(a);
        moved = Both { a: moved.a + own.moved.a, b: moved.b + own.moved.b };
        if worst.is_none_or(|(_, known)| place.distance_mm > known.distance_mm) {
            worst = Some((Both { a, b }, place));
        }
    }
    worst.map(|(layer, farthest)| Finding::Seams { role, layers, moved, layer, farthest })
}

fn of_layer(pair: &PairOfLayers, layer: Both<usize>, found: &mut Vec<Finding>) {
    of_orders(&pair.orders, Some(layer), found);
    for role in &pair.roles {
        of_role(role, layer, found);
    }
}

fn of_orders(orders: &Orders, layer: Option<Both<usize>>, found: &mut Vec<Finding>) {
    let Orders { heaters, commands } = orders.clone();
    found.extend(heaters.map(|difference| Finding::Heaters { layer, difference }));
    found.extend(commands.map(|difference| Finding::Commands { layer, difference }));
}

fn of_role(pair: &RoleOfPair, layer: Both<usize>, found: &mut Vec<Finding>) {
    let RoleOfPair { role, patch, far_mm, farthest, unlike_mm, .. } = *pair;
    if far_mm.a + far_mm.b > 0.0 && farthest.is_none() {
        // Reported for all layers together.
        return;
    }
    let before = found.len();
    if let Some(farthest) = farthest {
        let length_mm = Both { a: pair.length_mm.a, b: pair.length_mm.b };
        found.push(Finding::Lines { layer, role, patch, length_mm, far_mm, farthest });
    }
    if let Some(most_unlike) = pair.most_unlike {
        found.push(Finding::Flow { layer, role, patch, unlike_mm, most_unlike });
    }
    // Lines that are drawn twice lie nowhere else: only the sums show it.
    if found.len() == before {
        for (quantity, sum) in [
            (Quantity::Length, pair.length_mm),
            (Quantity::Filament, pair.filament_mm),
            (Quantity::AskedTime, pair.asked_time_s),
        ] {
            if !sum.equal {
                found.push(Finding::Sum { layer: Some(layer), role: Some(role), quantity, sum });
            }
        }
    }
}

fn of_file(difference: &Difference, found: &mut Vec<Finding>) {
    let mut offer = |role, quantity, sum: Sum| {
        if !sum.equal {
            found.push(Finding::Sum { layer: None, role, quantity, sum });
        }
    };
    offer(None, Quantity::Time, difference.time_s);
    offer(None, Quantity::Filament, difference.filament_mm);
    for row in difference.roles.iter().filter(|row| row.decides) {
        offer(Some(row.role), Quantity::Length, row.length_mm);
        offer(Some(row.role), Quantity::Filament, row.filament_mm);
    }
}
