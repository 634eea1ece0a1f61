//! Head -> Shape: the head with what its underside is computed from, for many questions in a row.

use super::{Head, Part, furthest, length};

/// A head, and the numbers of its nozzle.
#[derive(Debug, Clone, Copy)]
pub struct Shape<'a> {
    head: &'a Head,
    /// Radius of the flat.
    face: f64,
    /// Tangent of the cone's flank.
    tan: f64,
    /// Radius where the cone ends; that of the flat, or less, where there is no cone.
    pub(super) cone_end: f64,
}

impl<'a> Shape<'a> {
    /// What is computed once of a head.
    #[must_use]
    pub fn of(head: &'a Head) -> Self {
        let face = head.flat / 2.0;
        let flares = head.cone > 0.0 && head.cone < 90.0 && head.cone_length > 0.0;
        let tan = if flares { libm::tan(head.cone.to_radians()) } else { f64::INFINITY };
        let cone_end = if flares { face + head.cone_length / tan } else { 0.0 };
        Self { head, face, tan, cone_end }
    }

    /// As [`Head::press_radius`].
    pub(super) fn press_radius(&self) -> f64 {
        self.head.press_radius()
    }

    /// Radius of flat and cone.
    pub(super) fn nozzle(&self) -> f64 {
        self.face.max(self.cone_end)
    }

    /// How far sideways it can touch what stands no higher than this above the tip, or further.
    pub(super) fn reach_below(&self, height: f64) -> f64 {
        let cone =
            if self.cone_end > self.face { self.face + height / self.tan } else { self.face };
        let discs = self.head.discs.iter().filter(|disc| disc[1] < height).map(|disc| disc[0]);
        let boxes = self.head.boxes.iter().filter(|area| area[4] < height);
        let boxes = boxes.map(|&area| furthest(area));
        discs.chain(boxes).fold(cone.min(self.nozzle()), f64::max)
    }

    /// The cone's height at this distance from the axis, which lies beside the flat.
    pub(super) fn rise(&self, distance: f64) -> f64 {
        (distance - self.face) * self.tan
    }

    /// The lowest place of the underside over a rectangle from `low` to `high` beside the tip, mm above it, and
    /// its part; infinite and `None` beyond the head's reach. All that is round rises outwards:
    /// it hangs lowest at the rectangle's nearest point. The distance of that is monotone in its bounds, even
    /// as rounded, so what is told of a rectangle holds for each one inside it, to the last digit.
    #[must_use]
    #[inline]
    pub fn lowest(&self, low: [f64; 2], high: [f64; 2]) -> (f64, Option<Part>) {
        let near = |axis: usize| {
            let (low, high) = (low[axis], high[axis]);
            if low > 0.0 {
                low
            } else if high < 0.0 {
                high
            } else {
                0.0
            }
        };
        let distance = length([near(0), near(1)]);
        let mut lowest = self.nozzle_at(distance);
        for (number, &[radius, z]) in self.head.discs.iter().enumerate() {
            if distance <= radius && z < lowest.0 {
                lowest = (z, Some(Part::Disc(number)));
            }
        }
        for (number, &[x0, y0, x1, y1, z]) in self.head.boxes.iter().enumerate() {
            let meets = x0 <= high[0] && x1 >= low[0] && y0 <= high[1] && y1 >= low[1];
            if meets && z < lowest.0 {
                lowest = (z, Some(Part::Box(number)));
            }
        }
        lowest
    }

    fn nozzle_at(&self, distance: f64) -> (f64, Option<Part>) {
        if distance <= self.face {
            (0.0, Some(Part::Flat))
        } else if distance <= self.cone_end {
            (self.rise(distance), Some(Part::Cone))
        } else {
            (f64::INFINITY, None)
        }
    }
}
