//! Solids that hang -> prints with support: each piece of it carries something, and is gone where that has landed.
//!
//! Words: an *island* is support of a layer that touches. What *hangs* is a place of the part with
//! nothing printed near it on the layer below.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::damage::judge_made;
use crate::common::{Kind, Move, Print, Solid, fixture, slice, solid::circle};
use slicer::check::finding::Code;
use std::collections::{BTreeMap, BTreeSet};

/// Side of a cell, mm: what touches is at most a cell apart.
const CELL: f64 = 0.4;

/// Layers between support and what it carries: the gap, and two that are too small to print.
const GAP: usize = 3;

/// Smaller islands are bits of a line between the outlines of its piece, in cells: no post is as thin.
const BIT: usize = 10;

/// Points by the cell that they lie in.
#[derive(Default)]
struct Cells(BTreeMap<(i32, i32), Vec<[f64; 2]>>);

impl Cells {
    /// The ends of beads, and points between them.
    fn of<'a>(beads: impl Iterator<Item = &'a Move>) -> Self {
        let mut cells = Self::default();
        for bead in beads {
            let steps = (bead.length() / (0.5 * CELL)).ceil().max(1.0);
            (0..=steps as usize).for_each(|i| cells.add(bead.at(i as f64 / steps)));
        }
        cells
    }

    fn cell(at: [f64; 2]) -> (i32, i32) {
        let [i, j] = at.map(|x| (x / CELL).floor() as i32);
        (i, j)
    }

    fn add(&mut self, at: [f64; 2]) {
        self.0.entry(Self::cell(at)).or_default().push(at);
    }

    fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        self.0.values().flatten().copied()
    }

    /// Whether a point lies within `far` of `at`.
    fn near(&self, at: [f64; 2], far: f64) -> bool {
        let ((i, j), n) = (Self::cell(at), (far / CELL).ceil() as i32);
        let rows = (i - n..=i + n).map(|i| self.0.range((i, j - n)..=(i, j + n)));
        let mut points = rows.flatten().flat_map(|(_, points)| points);
        points.any(|p| (p[0] - at[0]).hypot(p[1] - at[1]) <= far)
    }

    /// The parts that touch.
    fn islands(&self) -> Vec<Self> {
        let mut left: BTreeSet<(i32, i32)> = self.0.keys().copied().collect();
        let mut out = Vec::new();
        while let Some(first) = left.pop_first() {
            let (mut island, mut next) = (Self::default(), vec![first]);
            while let Some((i, j)) = next.pop() {
                island.0.insert((i, j), self.0[&(i, j)].clone());
                let around = (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).map(move |j| (i, j)));
                next.extend(around.filter(|cell| left.remove(cell)));
            }
            out.push(island);
        }
        out
    }
}

/// What the beads of some kinds cover of each layer.
fn layers(print: &Print, is: impl Fn(Kind) -> bool) -> Vec<Cells> {
    let mut lists: Vec<Vec<&Move>> = vec![Vec::new(); print.layers.len()];
    print.beads().filter(|bead| is(bead.kind)).for_each(|b| lists[b.layer.unwrap()].push(b));
    lists.into_iter().map(|list| Cells::of(list.into_iter())).collect()
}

/// Islands of support over which nothing hangs, and no island that carries something: the layer, and
/// a place of each.
fn idle(print: &Print, outset: f64) -> Vec<(usize, [f64; 2])> {
    let count = print.layers.len();
    let support = layers(print, Kind::is_support);
    let part = layers(print, |kind| !kind.is_support() && kind != Kind::Brim);
    let mut hangs: Vec<Cells> = (0..count).map(|_| Cells::default()).collect();
    for k in 1..count {
        // What the threshold allows, and a little more.
        let free = part[k].points().filter(|&p| !part[k - 1].near(p, 0.25));
        free.for_each(|p| hangs[k].add(p));
    }
    let (mut found, mut above) = (Vec::new(), Cells::default());
    for k in (0..count).rev() {
        let mut carries = Cells::default();
        for island in support[k].islands().into_iter().filter(|island| island.0.len() > BIT) {
            // Within the outset and a line of the edge of what hangs, which lies half a line outside, and
            // the distance of rows.
            let hangs = &hangs[(k + 1).min(count)..(k + 2 + GAP).min(count)];
            let is_below = |p| hangs.iter().any(|hangs| hangs.near(p, outset + 0.8));
            if island.points().any(|p| above.near(p, 0.8) || is_below(p)) {
                carries.0.extend(island.0);
            } else {
                found.push((k, island.points().next().unwrap()));
            }
        }
        above = carries;
    }
    found
}

/// A block 14 mm deep with a round hole along y, whose middle is at z 10.
fn bored(radius: f64) -> Solid {
    let n = 48;
    let hole = circle(radius, n);
    let square = |[x, z]: [f64; 2]| {
        let far = 10.0 / x.abs().max(z.abs());
        [x * far, z * far]
    };
    let at = |[x, z]: [f64; 2], y: f64| [x, y, z + 10.0];
    let mut triangles = Vec::new();
    for i in 0..n {
        let [a, b] = [hole[i], hole[(i + 1) % n]];
        let [c, d] = [square(a), square(b)];
        let mut quad = |corners: [[f64; 3]; 4]| {
            let [p, q, r, s] = corners;
            triangles.extend([[p, q, r], [p, r, s]]);
        };
        quad([at(a, -7.0), at(c, -7.0), at(d, -7.0), at(b, -7.0)]);
        quad([at(a, 7.0), at(b, 7.0), at(d, 7.0), at(c, 7.0)]);
        quad([at(c, -7.0), at(c, 7.0), at(d, 7.0), at(d, -7.0)]);
        quad([at(a, -7.0), at(b, -7.0), at(b, 7.0), at(a, 7.0)]);
    }
    Solid { triangles }
}

/// Support of the roof of a hole stands on its floor, and gets no towers of its own outside.
#[test]
fn support_in_a_hole_stays_on_its_floor() {
    for radius in [1.5, 2.0, 3.0, 4.0] {
        let part = bored(radius);
        assert!(part.volume() > 0.0);
        let run = slice(&part.stl(), "generic-marlin", &[("support.enabled", "true")]);
        let [_, middle] = run.middle();
        let support = run.print.beads().filter(|line| line.kind.is_support());
        for p in support.flat_map(|line| [line.from, line.to]) {
            assert!(p[2] > 10.0 - radius && p[2] < 10.0 + radius, "{radius}: {p:?}");
            assert!((p[1] - middle).abs() < 7.0 + 0.8 + 0.2, "{radius}: {p:?}");
        }
    }
}

/// Parts that hang in ways of their own.
fn parts() -> Vec<(&'static str, Solid)> {
    let hat = Solid::cylinder(3.0, 12.0, 48)
        .and(&Solid::cylinder(9.0, 2.0, 48).shifted([0.0, 0.0, 10.0]));
    let far = 6.0 / 30.0_f64.to_radians().tan();
    let cone = Solid::tower(&[(circle(4.0, 48), 0.0), (circle(4.0 + far, 48), 6.0)]);
    // Hardly more than a line hangs out of a wall that leans over.
    let lip = Solid::tower(&[(circle(5.0, 48), 0.0), (circle(8.0, 48), 9.0)])
        .and(&Solid::cylinder(8.6, 2.0, 48).shifted([0.0, 0.0, 9.0]));
    let ledge =
        Solid::cylinder(8.0, 8.0, 48).and(&Solid::cylinder(8.5, 2.0, 48).shifted([0.0, 0.0, 6.0]));
    let stepped = Solid::cuboid([-6.0, -6.0, 0.0], [6.0, 6.0, 4.0])
        .and(&Solid::cuboid([-2.0, -2.0, 0.0], [2.0, 2.0, 12.0]))
        .and(&Solid::cuboid([-7.0, -4.0, 10.0], [7.0, 4.0, 12.0]));
    let drilled = bored(2.0).and(&Solid::cuboid([-10.0, 5.0, 18.0], [10.0, 14.0, 20.0]));
    vec![
        ("hat", hat),
        ("cone", cone),
        ("lip", lip),
        ("ledge", ledge),
        ("stepped", stepped),
        ("hole of 3 mm", bored(1.5)),
        ("hole of 4 mm", bored(2.0)),
        ("hole of 6 mm", bored(3.0)),
        ("drilled", drilled),
    ]
}

#[test]
fn each_island_of_support_carries_something() {
    let of_parts = parts().into_iter().map(|(name, part)| (name, part.stl()));
    let fixtures = ["overhang.stl", "two_shells.stl", "sphere_20.stl", "bracket.stl"];
    let all = of_parts.chain(fixtures.map(|name| (name, fixture(name))));
    let mut failures = Vec::new();
    for (name, stl) in all {
        for more in ["0", "0.8", "2"] {
            let set = [("support.enabled", "true"), ("support.expansion", more)];
            let run = slice(&stl, "generic-marlin", &set);
            let idle = idle(&run.print, more.parse().unwrap());
            if let Some(first) = idle.first() {
                failures.push(format!("{name}, {more}: {} {first:?}", idle.len()));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// How much support a plate on a column over a floor gets where it reaches out by so much, mm of lines, and
/// whether any of it hangs all the same.
fn beyond_a_floor(out: f64, low: f64, set: &[(&str, &str)]) -> (f64, bool) {
    let far = 10.0 + out;
    let part = Solid::cuboid([-10.0, -10.0, 0.0], [10.0, 10.0, 4.0])
        .and(&Solid::cuboid([-3.0, -3.0, 0.0], [3.0, 3.0, low + 2.0]))
        .and(&Solid::cuboid([-far, -far, low], [far, far, low + 2.0]));
    let set: Vec<(&str, &str)> = [&[("support.enabled", "true")], set].concat();
    let stl = part.stl();
    let run = slice(&stl, "generic-marlin", &set);
    let counts = judge_made(&run.text, &stl).counts;
    let hangs = counts.iter().any(|count| count.code == Code::Unanchored);
    let support = run.print.beads().filter(|line| line.kind.is_support());
    (support.map(Move::length).sum(), hangs)
}

/// Islands of support of a layer with neither support nor the part below any of it: the layer, and a place of each.
fn hanging(print: &Print) -> Vec<(usize, [f64; 2])> {
    let count = print.layers.len();
    let support = layers(print, Kind::is_support);
    let part = layers(print, |kind| !kind.is_support());
    let mut found = Vec::new();
    for k in 1..count {
        // Beside the part as far as support may lean.
        let floors = &part[k.saturating_sub(2)..k];
        let lies =
            |p| support[k - 1].near(p, 0.45) || floors.iter().any(|floor| floor.near(p, 0.8));
        let islands = support[k].islands().into_iter().filter(|island| island.0.len() > BIT);
        let islands = islands.filter(|island| !island.points().any(lies));
        found.extend(islands.map(|island| (k, island.points().next().unwrap())));
    }
    found
}

/// Steps with a slab on a column above: support stands on the steps, and goes down beside the lowest.
fn temple(low: f64, out: f64) -> Solid {
    let step = |k: i32| {
        let (k, half) = (f64::from(k), 16.0 - 2.34 * f64::from(k));
        Solid::cuboid([-half, -half, k], [half, half, k + 1.0])
    };
    let steps = (0..5).fold(Solid::default(), |all, k| all.and(&step(k)));
    steps
        .and(&Solid::cuboid([-1.3, -1.3, 4.9], [1.3, 1.3, low + 2.0]))
        .and(&Solid::cuboid([-16.0 - out, -16.0 - out, low], [16.0 + out, 16.0 + out, low + 2.0]))
}

/// A square tower whose roofs have flat undersides and steep flanks.
fn pagoda(flank: f64) -> Solid {
    let square = |half: f64| vec![[-half, -half], [half, -half], [half, half], [-half, half]];
    let floor = |k: i32| {
        let (z, half) = (11.0 * f64::from(k), 9.0 - 0.6 * f64::from(k));
        let wall = Solid::cuboid([-half, -half, z], [half, half, z + 7.0]);
        let roof = [(half - 0.01, 6.0), (half + 5.0, 7.5), (half + 5.0, 8.2), (half - 0.8, flank)];
        let roof: Vec<_> = roof.iter().map(|&(half, up)| (square(half), z + up)).collect();
        wall.and(&Solid::tower(&roof))
    };
    (0..5).fold(Solid::default(), |all, k| all.and(&floor(k)))
}

/// A figure of eight that stands upright: between its two rounds and beside the lower there is little
/// room for support of the upper.
fn eight(upper: f64) -> Solid {
    let lying = |radius: f64, high: f64| {
        Solid::prism(&circle(radius, 48), -5.0, 5.0).map(|[x, y, z]| [x, -z, y + high])
    };
    lying(5.0, 4.8).and(&lying(upper, 9.2 + upper))
}

#[test]
fn each_island_of_support_lies_on_something() {
    let mut failures = Vec::new();
    let parts = parts().into_iter().map(|(name, part)| (name.to_owned(), part));
    let temples = [(6.5, 1.0), (8.0, -2.0), (9.5, 3.0), (11.6, 2.0)];
    let temples = temples.map(|(low, out)| (format!("temple {low} {out}"), temple(low, out)));
    let pagodas = [11.5, 12.0, 13.0].map(|flank| (format!("pagoda {flank}"), pagoda(flank)));
    let eights = [4.4, 4.9, 5.4, 5.8].map(|upper| (format!("eight {upper}"), eight(upper)));
    for (name, part) in parts.chain(temples).chain(pagodas).chain(eights) {
        for angle in ["0", "45", "75"] {
            let set = [("support.enabled", "true"), ("angle", angle)];
            let run = slice(&part.stl(), "generic-marlin", &set);
            let found = hanging(&run.print);
            if let Some(first) = found.first() {
                failures.push(format!("{name}, {angle}: {} {first:?}", found.len()));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn support_beside_a_floor_that_may_not_carry_it_stands_on_the_bed() {
    for out in [1.0, 1.5] {
        // The middle of the plate has to hang.
        let (length, _) = beyond_a_floor(out, 12.0, &[("support.stands_on", "bed")]);
        assert!(length > 1000.0, "{out}: {length}");
    }
}

/// From a floor right below, support can not reach out again to where it is needed beside the floor.
#[test]
fn support_beside_a_floor_right_below_stands_on_the_bed() {
    for out in ["2.5", "3"] {
        let set = [("support.xy_distance", "2"), ("layer_height", "0.3")];
        let (length, hangs) = beyond_a_floor(out.parse().unwrap(), 6.0, &set);
        assert!(length > 3000.0 && !hangs, "{out}: {length}");
    }
}
