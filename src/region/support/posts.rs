//! Support of a layer -> that of the next: posts go down while they carry something, and grow until they stand.
//!
//! Words: a *post* is a piece of support that goes down from layer to layer; its *height* is measured
//! from its top. Its *thickness* is that of its section ([`mod@crate::geom::section`]): a bent strip
//! stands where a straight one would not. It is *thin* if it is less than a fixed width, of low posts
//! half of their height, of high ones a fifth of it. Its *load* is that of it which something hangs over.
//! The load *lands* where it ends on the part: there are the *feet* of the post. They are *firm* if
//! they are thick enough for it to stand on them alone.
//!
//! A thin piece grows to all sides on each layer further down, as far as the part leaves room, until
//! it is no longer thin, and meets its neighbours on the way: then they are one piece. So does a
//! place that is left narrower than a bead below what is printed: that would begin in the air.
//!
//! So support is wider than its load: by the outset, and by what has grown. Where the load has landed,
//! the rest would go on beside the part, down to the bed, and carry nothing. Therefore
//!
//! 1. a load begins below what hangs. Where there is no room right below it, as under a ledge that is
//!    narrower than the clearance, it begins beside it;
//! 2. it goes down, and steps aside where the part pushes it;
//! 3. near firm feet it has landed as well: support reaches out again above them, before it gets to
//!    what hangs;
//! 4. a piece without any load is left out, but not below feet that are not firm: they need it.

use super::params::{LEAN, SupportParams};
use super::pieces::{Pieces, without_narrow};
use crate::geom::section::Section;
use crate::geom::spans::{Rows, Span};
use crate::units::{Bounded as _, Coord, to_mm};

/// The least width of a post, as a part of its height: half of the slenderness of 10 at which
/// posts begin to whip under the nozzle.
const PART_OF_HEIGHT: f64 = 0.2;

/// The same of low posts, which may be thinner than others: many land on the part before long.
const PART_OF_LOW: f64 = 0.5;

/// The same of firm feet. They are a little thinner than their post, whose sides end beside the part.
const PART_OF_FEET: f64 = 0.15;

/// Posts grow no wider than this (20 mm), however high: a piece as wide stands by its own weight.
const MOST_WIDTH: Coord = 200_000;

/// No post is thinner than so many lines at its thickest place, however long it is.
const LEAST_LINES: Coord = 3;

/// How far a thin piece grows on a layer, in pitches of half a line: the beads at its edge lie with
/// half of their width on those of the wider layer below.
const STEP: Coord = 1;

/// The posts of the layer above.
#[derive(Default)]
pub(super) struct Posts {
    rows: Rows,
    /// By piece of the rows.
    posts: Vec<Post>,
    load: Rows,
    /// Where loads have landed.
    feet: Rows,
}

/// What is known of a post.
#[derive(Debug, Clone, Copy)]
struct Post {
    /// The height of its top.
    top: Coord,
    /// The height of the lowest layer where a load of it begins.
    last: Coord,
    /// What of its load has landed.
    feet: Section,
}

impl Post {
    /// One whose top lies at `z`.
    fn new(z: Coord) -> Self {
        Self { top: z, last: Coord::MAX, feet: Section::default() }
    }

    /// Adds one that it is joined with.
    fn join(&mut self, other: &Self) {
        self.top = self.top.max(other.top);
        self.last = self.last.min(other.last);
        self.feet.join(&other.feet);
    }

    /// Whether it stands on its feet, at height `z`.
    fn is_firm(&self, z: Coord, params: &SupportParams) -> bool {
        let asked =
            (PART_OF_FEET * to_mm(self.top - z)).at_least(to_mm(LEAST_LINES * params.least));
        // Rows show the middle of the outermost lines.
        self.feet.thickness() + to_mm(params.least) >= asked
    }
}

/// Where loads begin on support over which `hangs` begins to hang.
pub(super) fn begins(all: &Rows, hangs: &Rows, params: &SupportParams) -> Rows {
    if hangs.is_empty() {
        return Rows::default();
    }
    let (outset, pitch) = (params.outset, params.raster().pitch);
    let below = all.and(hangs);
    let bare = hangs.minus(&below.dilate(outset, pitch));
    below.or(&all.and(&bare.dilate(outset, pitch)))
}

impl Posts {
    /// The support above.
    pub(super) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Takes the support of the next layer down, whose top lies at `z` and over which `hangs` begins to
    /// hang. That of the layer above stands on the part at `foot`. Removes what carries nothing, and
    /// returns it; then thin pieces grow. `cut` removes what would be in the part.
    pub(super) fn next(
        &mut self,
        rows: &Rows,
        [hangs, foot]: [&Rows; 2],
        z: Coord,
        params: &SupportParams,
        cut: impl Fn(Rows) -> Rows,
    ) -> Rows {
        let begins = begins(rows, hangs, params);
        let over = Pieces::new(&self.rows);
        let landed = self.go_down((rows, foot), &over, z, params);
        let pieces = Pieces::new(rows);
        let posts = self.of_pieces((rows, &pieces), &over, [&landed, &begins], z, params);
        let (kept, posts) = self.loaded((rows, &pieces), posts, &begins, z, params);
        let pieces = Pieces::new(&kept);
        let thin = thin(&kept, &pieces, |piece| posts[piece].top - z, params);
        let pitch = params.raster().pitch;
        // Rounded corners are not narrow.
        let narrow = kept.minus(&without_narrow(&kept, params).dilate(pitch, pitch));
        let grows = thin.or(&narrow.and(&without_narrow(&self.rows, params)));
        let grown = if grows.is_empty() {
            kept.clone()
        } else {
            cut(kept.or(&grows.dilate(STEP * pitch, pitch)))
        };
        // Each of the grown pieces has some of those from before in it.
        let after = Pieces::new(&grown);
        let mut of_grown = vec![Post::new(z); after.count()];
        for (piece, from) in meets((&grown, &after), (&kept, &pieces)) {
            of_grown[piece].join(&posts[from]);
        }
        (self.rows, self.posts) = (grown, of_grown);
        rows.minus(&kept)
    }

    /// Takes the load down to the layer whose support is `rows`. Returns what of it lands.
    fn go_down(
        &mut self,
        (rows, foot): (&Rows, &Rows),
        over: &Pieces,
        z: Coord,
        params: &SupportParams,
    ) -> Rows {
        let ends = self.load.minus(rows);
        if ends.is_empty() {
            return ends;
        }
        // Support ends at the clearance from a floor.
        let pitch = params.raster().pitch;
        let landed = ends.and(&foot.dilate(params.clearance, pitch));
        let aside = ends.minus(&landed).dilate(LEAN * params.least, pitch);
        self.load = self.load.or(&aside).and(rows);
        // Only far below what hangs support reaches out again above a foot: a layer is no higher than a line is wide.
        let rise = 2 * params.clearance + params.least;
        let high = over.keep(&self.rows, |piece| self.posts[piece].last - z >= rise);
        // Where there is support again, there is no foot.
        self.feet = self.feet.or(&landed.and(&high)).minus(rows);
        landed
    }

    /// The posts of the pieces of `rows`, of which some have `landed` and some begin here. There is none
    /// of a piece that has nothing above it.
    fn of_pieces(
        &self,
        (rows, pieces): (&Rows, &Pieces),
        over: &Pieces,
        [landed, begins]: [&Rows; 2],
        z: Coord,
        params: &SupportParams,
    ) -> Vec<Option<Post>> {
        let pitch = params.raster().pitch;
        let mut old = self.posts.clone();
        let spans: Vec<(i32, Span)> =
            landed.iter().flat_map(|(j, row)| row.iter().map(move |&span| (j, span))).collect();
        over.meeting(&self.rows, landed, |piece, k| {
            let (j, span) = spans[k];
            old[piece].feet.add(span, to_mm(j * pitch), to_mm(pitch));
        });
        let mut posts = vec![None; pieces.count()];
        for (piece, from) in meets((rows, pieces), (&self.rows, over)) {
            posts[piece].get_or_insert(Post::new(z)).join(&old[from]);
        }
        pieces.meeting(rows, begins, |piece, _| {
            posts[piece].get_or_insert(Post::new(z)).last = z;
        });
        posts
    }

    /// The pieces that carry something or that their post needs, and the posts of these.
    fn loaded(
        &mut self,
        (rows, pieces): (&Rows, &Pieces),
        posts: Vec<Option<Post>>,
        begins: &Rows,
        z: Coord,
        params: &SupportParams,
    ) -> (Rows, Vec<Post>) {
        let is = |what: &dyn Fn(&Post) -> bool| -> Vec<bool> {
            posts.iter().map(|post| post.as_ref().is_some_and(what)).collect()
        };
        // What hangs lies so high above that support reaches it again.
        let near = params.clearance + params.least;
        let stands = is(&|post| post.is_firm(z, params) && post.last - z >= near);
        if stands.contains(&true) {
            let stands = pieces.keep(rows, |piece| stands[piece]);
            let lands = self.feet.dilate(near, params.raster().pitch).and(&stands);
            self.load = self.load.minus(&lands);
        }
        self.load = self.load.or(begins);
        let mut is_kept = vec![false; pieces.count()];
        pieces.meeting(rows, &self.load, |piece, _| is_kept[piece] = true);
        let needs = is(&|post| !post.is_firm(z, params));
        let needed = pieces.keep(rows, |piece| needs[piece] && !is_kept[piece]);
        self.load = self.load.or(&needed);
        is_kept.iter_mut().zip(needs).for_each(|(kept, needs)| *kept |= needs);
        let kept = pieces.keep(rows, |piece| is_kept[piece]);
        let posts = posts.into_iter().zip(is_kept).filter(|(_, kept)| *kept);
        (kept, posts.map(|(post, _)| post.unwrap_or(Post::new(z))).collect())
    }
}

/// The pieces of two sets of rows that overlap, as pairs, each once.
fn meets((a, pieces): (&Rows, &Pieces), (b, others): (&Rows, &Pieces)) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    pieces.meeting(a, b, |piece, span| pairs.push((piece, others.of(span))));
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// The pieces that are too thin for their height.
fn thin(
    rows: &Rows,
    pieces: &Pieces,
    height: impl Fn(usize) -> Coord,
    params: &SupportParams,
) -> Rows {
    if params.min_width <= 0 || rows.is_empty() {
        return Rows::default();
    }
    let pitch = params.raster().pitch;
    // Rows show the middle of the outermost lines.
    let core = rows.erode((LEAST_LINES - 1) * params.least / 2, pitch);
    let mut has_core = vec![false; pieces.count()];
    pieces.meeting(rows, &core, |piece, _| has_core[piece] = true);
    let wide = |(piece, section): (usize, Section)| {
        let asked = to_mm(asked(height(piece), params.min_width));
        has_core[piece] && section.thickness() + to_mm(params.least) >= asked
    };
    let wide: Vec<bool> = pieces.sections(rows, pitch).into_iter().enumerate().map(wide).collect();
    pieces.keep(rows, |piece| !wide[piece])
}

/// The least thickness of a piece of some height.
fn asked(height: Coord, min_width: Coord) -> Coord {
    let height = f64::from(height);
    let low = (height * PART_OF_LOW).at_most(f64::from(min_width));
    (height * PART_OF_HEIGHT).at_most(f64::from(MOST_WIDTH)).at_least(low) as Coord
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile;

    /// Rows of the raster, 0.2 mm apart.
    fn block(rows: std::ops::Range<i32>, start: Coord, end: Coord) -> Rows {
        let mut out = Rows::starting_at(rows.start);
        rows.for_each(|_| out.push_row(|spans| spans.push(Span { start, end })));
        out
    }

    fn params() -> SupportParams {
        let mut settings = profile::load(["generic-marlin"], &[]).unwrap().settings;
        settings.support.enabled = true;
        SupportParams::new(&settings).unwrap()
    }

    /// A post of 10 mm × 8 mm whose load is `wide`, and that lands beside the rest of it after so many
    /// layers. Whether the rest goes on.
    fn goes_on(wide: Coord, layers: Coord) -> bool {
        let params = params();
        let (all, none) = (block(0..40, 0, 100_000), Rows::default());
        let hangs = block(0..40, 0, wide);
        let mut posts = Posts::default();
        for k in 0..layers {
            let hangs = if k == 0 { &hangs } else { &none };
            let z = 2000 * (layers - k);
            let idle = posts.next(&all, [hangs, &none], z, &params, |rows| rows.and(&all));
            assert!(idle.is_empty());
        }
        let rest = block(0..40, wide + 8000, 100_000);
        let idle = posts.next(&rest, [&none, &hangs], 0, &params, |rows| rows.and(&rest));
        assert!(idle.is_empty() || posts.rows().is_empty());
        idle.is_empty()
    }

    #[test]
    fn a_post_that_has_landed_ends_unless_its_feet_are_too_thin() {
        assert!(!goes_on(30_000, 20));
        assert!(!goes_on(30_000, 100));
        // 23 mm high on 3 mm.
        assert!(goes_on(30_000, 115));
        assert!(goes_on(4_000, 20));
    }

    #[test]
    fn what_hangs_over_no_support_is_carried_from_beside() {
        let params = params();
        let (all, ledge) = (block(0..40, 8_000, 11_000), block(0..40, 0, 3_000));
        assert_eq!(begins(&all, &ledge, &params), all);
        // Where there is room below a tongue of it, support near that is enough.
        let tongue = block(10..20, 3_000, 20_000);
        let begins = begins(&all, &ledge.or(&tongue), &params);
        assert!(begins.row(15) == all.row(15) && begins.row(30) == all.row(30), "{begins:?}");
    }

    #[test]
    fn a_load_steps_aside_and_one_far_from_all_support_is_none() {
        let (params, none) = (params(), Rows::default());
        let mut posts = Posts::default();
        let strip = |start: Coord| block(0..40, start, start + 3_000);
        for (k, start) in [0, 0, 2_000, 4_000, 6_000].into_iter().enumerate() {
            let hangs = if k == 0 { strip(0) } else { Rows::default() };
            let rows = strip(start);
            let z = 2000 * (9 - k as Coord);
            let idle = posts.next(&rows, [&hangs, &none], z, &params, |rows| rows);
            assert!(idle.is_empty(), "{k}");
        }
        let other = strip(400_000);
        assert_eq!(posts.next(&other, [&none, &none], 0, &params, |rows| rows), other);
    }
}
