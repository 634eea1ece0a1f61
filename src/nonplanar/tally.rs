//! Places -> Areas: how much of the part's top is skin, and why the rest is none.

/// Why a place gets no skin, in the order in which reasons are told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    /// Steeper than the head can follow.
    Slope,
    /// The flat face would press too deep.
    Press,
    /// The head would touch the surface itself, or its base.
    Cone,
    /// It would touch something else of the same body.
    Obstacle,
    /// It would touch another body, or support.
    Neighbour,
    /// Too little lies below.
    Overhang,
    /// Support would stand on it.
    Support,
    /// The head would have to rise higher than the machine can.
    ZLimit,
    /// The piece is too small.
    Area,
    /// Narrower than three lines.
    Thin,
}

impl Reason {
    /// All of them, in their order.
    pub const ALL: [Self; 10] = [
        Self::Slope,
        Self::Press,
        Self::Cone,
        Self::Obstacle,
        Self::Neighbour,
        Self::Overhang,
        Self::Support,
        Self::ZLimit,
        Self::Area,
        Self::Thin,
    ];

    /// As reports name it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Slope => "slope",
            Self::Press => "press",
            Self::Cone => "cone",
            Self::Obstacle => "obstacle",
            Self::Neighbour => "neighbour",
            Self::Overhang => "overhang",
            Self::Support => "support",
            Self::ZLimit => "z-limit",
            Self::Area => "area",
            Self::Thin => "thin",
        }
    }
}

/// True areas of surface, mm².
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Areas {
    /// Printed as skins that follow the surface.
    pub skin: f64,
    /// Printed with lines that rise and fall within their layer.
    pub contour: f64,
    /// Flatter than the least slope.
    pub level: f64,
    /// Printed flat, by the reasons of [`Reason::ALL`].
    pub flat: [f64; 10],
}

impl Areas {
    /// Adds what is printed flat.
    pub fn add(&mut self, reason: Reason, mm2: f64) {
        self.flat[reason as usize] += mm2;
    }

    /// So much of what was flat for a reason has lines that rise and fall instead.
    pub fn contoured(&mut self, reason: Reason, mm2: f64) {
        let moved = mm2.clamp(0.0, self.flat[reason as usize].max(0.0));
        self.flat[reason as usize] = (self.flat[reason as usize] - moved).max(0.0);
        self.contour += moved;
    }

    /// What is printed flat for a reason.
    #[must_use]
    pub fn of(&self, reason: Reason) -> f64 {
        self.flat[reason as usize]
    }

    /// All of it.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.skin + self.contour + self.level + self.flat.iter().sum::<f64>()
    }
}
