//! Print + Part -> findings of a layer: outline, top and bottom surfaces, lines outside the part.
//!
//! Words used here: a layer's *cut* is the model's section at the middle of the layer; its *rim* is
//! what of the cut lies near the outline; *exposed* is what of the cut has nothing of the model
//! above it or below it; *closed* is what walls and skins cover; a *stray* is a line so far from its
//! layer's height that it is judged with the layer it lies at.
//!
//! Everything is drawn into rows a twentieth of a mm apart, one set for each layer, and compared there:
//! - rim less what is printed, in patches that are wide and large enough: an open outline;
//! - islands of which nothing is printed: open outlines too, however small, if a line has room there;
//! - exposed less closed, away from the rim: an open surface, where the file's own settings want skins;
//! - lines less the cut, grown by what lines may stick out: lines outside the part.
//!
//! Only places that are wide enough for a line count. Thick lines, and lines that vary in height,
//! also cover the layers that they reach down into. Strays, as lines of non-planar skin, cover the
//! layers at which they lie, piece by piece: they close what is exposed there. Those that lie above the
//! model's surface, or beside it, lie outside it: the height of a slope belongs to no layer. Volumes of plastic are summed up on the way.

use super::part::Section;
use super::roof::Roof;
use crate::check::beads::place;
use crate::check::belongs::{SAME_HEIGHT, is_of_part, is_stray};
use crate::check::capsule::Capsule;
use crate::check::finding::{Code, Finding, Place, short};
use crate::check::rows::{Lattice, Patch};
use crate::check::samples::Samples;
use crate::check::stack::bead::Bead;
use crate::check::stack::laid::Seen;
use crate::check::stack::runs::united;
use crate::check::survey::Survey;
use crate::check::terms::Terms;
use crate::check::window::Window;
use crate::geom::segment::distance2;
use crate::geom::spans::Rows;
use crate::reader::Role;
use crate::reader::print::Step;

/// Width of the rim that must be printed, mm: three quarters of a usual line. A wider one would ask
/// for walls where sparse infill is right.
const RIM: f64 = 0.3;

/// How far lines may stick out of the part, mm: three quarters of a usual line, for coarse contours
/// and round corners of other slicers. More hides layers that are shifted.
const MOST_OUT: f64 = 0.3;

/// Open places narrower than twice this are ignored, mm: gaps between neighbouring round lines.
const NARROW: f64 = 0.1;

/// Smaller patches are ignored, mm²: corners and ends of lines are round. A missing line of 2 mm is
/// larger.
const LEAST_AREA: f64 = 0.6;

/// Smaller islands may be left out, mm²: less than a short line.
const LEAST_ISLAND: f64 = 0.3;

/// Islands narrower than this many line widths may be left out: the narrowest bead is a little narrower.
const ISLAND: f64 = 0.9;

/// Places narrower than this many line widths count as too narrow to print.
pub(crate) const PRINTABLE: f64 = 1.2;

/// How far from walls and skins sparse infill is measured, mm: its lines end in them, …
const FROM_WALLS: f64 = 0.5;

/// … and how wide a place must be for its lines to show their density, mm.
const LEAST_WIDE: f64 = 6.0;

/// Length of the pieces in which lines are looked at, mm: half of a line's width; and of those of sparse
/// infill, of which the density is asked for over many lines.
pub(crate) const PIECE: f64 = 0.2;
const LONG_PIECE: f64 = 0.5;

/// Layers above that strays are looked for in which reach down into one: their lines are hardly
/// higher than two layers.
const MOST_DEEP: usize = 3;

/// A stray may lie above the surface by this part of its height, and by rounding, mm; and so long a piece
/// of it counts, mm.
const MOST_ABOVE: f64 = 0.5;
const ROUNDING: f64 = 0.05;
const LEAST_STRAY: f64 = 1.0;

/// Findings and measures of one layer.
#[derive(Debug, Clone, Default)]
pub(crate) struct Verdict {
    pub(crate) findings: Vec<Finding>,
    pub(crate) areas: Areas,
    /// Whether the layer was left out.
    pub(crate) is_unsure: bool,
}

/// What is measured; areas in mm², volumes in mm³.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Areas {
    /// The part's cut.
    pub(crate) part: f64,
    /// The printable rim of it, and what of that is printed.
    pub(crate) rim: [f64; 2],
    /// The printable part of top and bottom surfaces, and what of that is closed.
    pub(crate) surface: [f64; 2],
    /// Walls and skins: area, and plastic.
    pub(crate) solid: [f64; 2],
    /// What sparse infill is measured on: area, and plastic.
    pub(crate) sparse: [f64; 2],
}

/// What judging a layer needs.
pub(crate) struct Judge<'a> {
    pub(crate) window: &'a Window<'a>,
    pub(crate) survey: &'a Survey,
    pub(crate) lattice: Lattice,
    pub(crate) terms: &'a Terms,
    /// Whether the file gives roles, so that the part's lines differ from others.
    pub(crate) has_roles: bool,
    /// The model's surface, if lines stray.
    pub(crate) roof: &'a Option<Roof>,
}

impl Judge<'_> {
    /// Judges layer `index`, whose cut and those below and above are given.
    pub(crate) fn layer(&self, index: usize, [below, cut, above]: [&Section; 3]) -> Verdict {
        let lattice = self.lattice;
        let lines = || self.lines_at(index);
        let solid = lines().filter(|step| step.role != Role::Infill);
        let solid = lattice.draw(solid.map(|step| Capsule::of(step, 1.0)));
        // Inside the part nothing depends on where sparse infill lies.
        let moved =
            self.terms.moved_at(self.window.facts.layers[index].z - self.survey.heights[index]);
        let most = MOST_OUT + moved;
        let strays = lattice.draw(self.strays_at(index).map(|step| Capsule::of(step, 1.0)));
        let sparse = lines().filter(|step| step.role == Role::Infill);
        let sparse = lattice.draw(near_outline(cut, lattice, most.max(RIM), sparse).into_iter());
        let (here, own) = (&cut.inside, sparse.or(&solid));
        let reaching = self.reaching_down(index).or(&strays);
        let (printed, closed) = (own.or(&reaching), solid.or(&reaching));
        let printable = cut.opened(lattice, self.survey.line_width * PRINTABLE / 2.0);
        let along = cut.along(lattice, RIM);

        let mut verdict = Verdict::default();
        let rim =
            if self.terms.has_walls { here.and(&along).and(&printable) } else { Rows::default() };
        let open = rim.minus(&printed);
        let beside =
            |open: Rows| if moved > 0.0 { open.minus(&cut.along(lattice, moved)) } else { open };
        let open = beside(open);
        verdict.areas.rim = self.shares(&rim, &open);
        let patches = self.patches(&open, index, Code::OpenOutline, |area| {
            format!("{area} mm² along the outline are not printed")
        });
        verdict.findings.extend(patches);
        self.add_islands(index, cut, &printed, &mut verdict);

        let exposed = self.exposed([below, cut, above]).and(&printable);
        let open = beside(exposed.minus(&closed));
        verdict.areas.surface = self.shares(&exposed, &open);
        // What the outline lacks is reported already.
        let open = open.minus(&rim);
        let patches = self.patches(&open, index, Code::OpenSurface, |area| {
            format!("{area} mm² of a top or bottom surface are not closed")
        });
        verdict.findings.extend(patches);

        if self.has_roles {
            let near = if RIM == most { along } else { cut.along(lattice, most) };
            let out = own.minus(&here.or(&near));
            let patches = self.patches(&out, index, Code::OutsidePart, |area| {
                format!("{area} mm² are printed beside the part")
            });
            verdict.findings.extend(patches);
        }
        verdict.findings.extend(self.above(index));
        let height = self.survey.heights[index];
        let all = lines().chain(self.strays_at(index));
        let solid = solid.or(&strays);
        self.amounts((all, height), here, [&solid, &closed], &mut verdict.areas);
        verdict
    }

    /// What of a cut has nothing of the model below it or above it, where the file's own settings close that.
    fn exposed(&self, [below, cut, above]: [&Section; 3]) -> Rows {
        let bare = |other: &Section, counts: bool| {
            if counts { cut.inside.minus(&other.inside) } else { Rows::default() }
        };
        let [bottoms, tops] = self.terms.closes;
        bare(above, tops).or(&bare(below, bottoms))
    }

    /// The lines at a layer that lie above the model's surface, or beside it: of each line of the file
    /// the piece that lies here.
    fn above(&self, index: usize) -> Vec<Finding> {
        let Some(roof) = self.roof else { return Vec::new() };
        let mut found = Vec::new();
        for step in self.strays_at(index) {
            let (mut length, mut most) = (0.0, 0.0_f64);
            let allowed = MOST_ABOVE * f64::from(step.height) + ROUNDING;
            for one in Samples::of(step, LONG_PIECE) {
                let [x, y] = one.at;
                let beside = || {
                    let around = [[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];
                    around.iter().find_map(|[u, v]| roof.at([x + MOST_OUT * u, y + MOST_OUT * v]))
                };
                let out = roof.at(one.at).or_else(beside).map_or(f64::INFINITY, |top| one.z - top);
                if out > allowed {
                    length += one.length;
                    most = most.max(if out.is_finite() { out } else { 0.0 });
                }
            }
            if length >= LEAST_STRAY {
                let where_to = if most > 0.0 {
                    format!("{} mm above the part's surface", short(most))
                } else {
                    "beside the part".to_owned()
                };
                let text = format!("{} mm of {} lie {where_to}", short(length), step.role.name());
                let area = length * f64::from(step.width);
                let finding = Finding::of(Code::OutsidePart, area, "mm²", text);
                found.push(finding.at(place(index, step)));
            }
        }
        found
    }

    /// The part's lines of a layer, without strays.
    fn lines_at(&self, index: usize) -> impl Iterator<Item = &Step> {
        let layer = &self.window.facts.layers[index];
        let own = self.window.moves(index).iter().filter(|step| !is_stray(step, layer));
        own.filter(|step| is_of_part(step, self.has_roles))
    }

    /// The pieces of the part's lines of any layer that stray and lie at the height of this one.
    fn strays_at(&self, index: usize) -> impl Iterator<Item = &Step> {
        let strays = self.survey.strays[index].iter();
        strays.filter(|step| is_of_part(step, self.has_roles))
    }

    /// What walls and skins of the layers above cover of this one: thick ones, and those that vary
    /// in height.
    fn reaching_down(&self, index: usize) -> Rows {
        let layer = &self.window.facts.layers[index];
        let (top, bottom) = (layer.z - SAME_HEIGHT, layer.z - layer.height + SAME_HEIGHT);
        let mut capsules = Vec::new();
        for above in index + 1..self.window.end() {
            if self.survey.floors[above] >= top {
                break;
            }
            let reaches = |step: &&Step| {
                let [low, high] = step.heights();
                step.role != Role::Infill && low - f64::from(step.height) < top && high > bottom
            };
            let steps = self.lines_at(above).filter(reaches);
            capsules.extend(steps.map(|step| Capsule::of(step, 1.0)));
        }
        let next = index + 1..(index + 1 + MOST_DEEP).min(self.survey.strays.len());
        let strays = next.flat_map(|above| self.strays_at(above));
        let strays = strays.filter(|step| step.heights()[0] - f64::from(step.height) < top);
        capsules.extend(strays.map(|step| Capsule::of(step, 1.0)));
        self.lattice.draw(capsules.into_iter())
    }

    /// An area, and it less what is open of it, mm².
    fn shares(&self, all: &Rows, open: &Rows) -> [f64; 2] {
        let area = self.lattice.area(all);
        [area, area - self.lattice.area(open)]
    }

    /// Adds islands of a cut of which nothing is printed, if a line has room there. What is known to be open
    /// along their outline is told once.
    fn add_islands(&self, index: usize, cut: &Section, printed: &Rows, verdict: &mut Verdict) {
        let (lattice, here) = (self.lattice, &cut.inside);
        // Such an island has no span with something printed: few layers have others.
        let all_bare = here.filter(|j, span| printed.overlapping(j, span).is_none());
        if lattice.area(&all_bare) < LEAST_ISLAND / 2.0 {
            return;
        }
        let bare = lattice.patches(&here.minus(printed));
        let bare: Vec<&Patch> = bare.iter().filter(|patch| patch.area >= LEAST_ISLAND).collect();
        if !self.terms.has_walls || bare.is_empty() {
            return;
        }
        let islands = lattice.patches(here);
        let is_whole = |one: &&&Patch| islands.iter().any(|island| island == **one);
        let missing: Vec<&Patch> = bare.iter().filter(is_whole).copied().collect();
        if missing.is_empty() {
            return;
        }
        let layer = &self.window.facts.layers[index];
        let moved = self.terms.moved_at(layer.z - self.survey.heights[index]);
        let printable = cut.opened(lattice, self.survey.line_width * ISLAND / 2.0 + moved);
        let told: Vec<[f64; 2]> = verdict.findings.iter().filter_map(|f| f.place.at_mm).collect();
        for patch in missing.into_iter().filter(|patch| lattice.has(&printable, patch.at)) {
            let near = |at: &[f64; 2]| distance2(*at, [patch.at; 2]) <= 2.0 * patch.area;
            if told.iter().any(near) {
                continue;
            }
            let text = format!("nothing is printed of an island of {} mm²", short(patch.area));
            let finding = Finding::of(Code::OpenOutline, short(patch.area), "mm²", text);
            verdict.findings.push(finding.at(self.place(index, patch.at)));
        }
    }

    /// A place of a layer.
    fn place(&self, index: usize, at: [f64; 2]) -> Place {
        Place {
            line: None,
            layer: Some(index + 1),
            z_mm: Some(short(self.window.facts.layers[index].z)),
            at_mm: Some(at.map(short)),
        }
    }

    /// The patches that are wide and large enough to be faults.
    fn patches(
        &self,
        open: &Rows,
        index: usize,
        code: Code,
        text: impl Fn(f64) -> String,
    ) -> Vec<Finding> {
        if self.lattice.area(open) < LEAST_AREA {
            return Vec::new();
        }
        let found = self.lattice.patches(&self.lattice.opened(open, NARROW));
        let large = found.iter().filter(|patch| patch.area >= LEAST_AREA);
        let finding = |area: f64| Finding::of(code, area, "mm²", text(short(area)));
        large.map(|patch| finding(patch.area).at(self.place(index, patch.at))).collect()
    }

    /// Areas and plastic of walls and skins, and of sparse infill away from them.
    fn amounts<'s>(
        &self,
        (lines, height): (impl Iterator<Item = &'s Step>, f64),
        here: &Rows,
        [solid, closed]: [&Rows; 2],
        areas: &mut Areas,
    ) {
        let lattice = self.lattice;
        let core = lattice.squares(&here.minus(closed), LEAST_WIDE / 2.0, FROM_WALLS);
        areas.part = lattice.area(here);
        areas.solid[0] = lattice.area(solid);
        areas.sparse[0] = lattice.area(&core);
        for step in lines {
            let plastic = self.terms.plastic(step);
            if step.role == Role::Infill {
                areas.sparse[1] += plastic * share_in(step, lattice, &core, LONG_PIECE);
            } else {
                // Of a thick line this layer's part: the rest lies in layers below.
                areas.solid[1] += plastic * (height / f64::from(step.height)).min(1.0);
            }
        }
    }
}

/// What of lines lies within `mm` of the outline of a cut, or outside it.
fn near_outline<'s>(
    cut: &Section,
    lattice: Lattice,
    mm: f64,
    lines: impl Iterator<Item = &'s Step>,
) -> Vec<Capsule> {
    let outline = cut.outline();
    let (mut pieces, mut seen, mut ways) = (Vec::new(), Seen::default(), Vec::new());
    for step in lines {
        let line = Bead::of(step);
        let reach = line.radius + mm + lattice.pitch();
        ways.clear();
        outline.near(&line, reach, &mut seen, |_, border| ways.extend(line.way(border, reach)));
        united(&mut ways, 0.0);
        // Where it does not come near, it lies inside or outside all along.
        let (mut at, count) = (0.0, ways.len());
        for k in 0..=count {
            let [from, to] = ways.get(k).copied().unwrap_or([1.0, 1.0]);
            if from > at && !lattice.has(&cut.inside, line.place(0.5 * (at + from))) {
                ways.push([at, from]);
            }
            at = to;
        }
        let piece = |&[from, to]: &[f64; 2]| Capsule {
            from: line.place(from),
            to: line.place(to),
            radius: line.radius,
        };
        pieces.extend(ways.iter().map(piece));
    }
    pieces
}

/// What part of a line lies in an area.
/// It is looked at in pieces of about `piece` mm.
pub(crate) fn share_in(step: &Step, lattice: Lattice, area: &Rows, piece: f64) -> f64 {
    if area.is_empty() {
        return 0.0;
    }
    let inside = Samples::of(step, piece).filter(|one| lattice.has(area, one.at)).count();
    inside as f64 / Samples::of(step, piece).count() as f64
}
