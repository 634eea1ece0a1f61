//! Role: what a path is printed for, with everything specific to each role in one table.
//!
//! - A *role* is what a path is for, such as outer wall or sparse infill.
//! - Its *facts* are all that is particular to it: name, annotation, speed, acceleration, filament, and
//!   where in a layer it is printed. To add a role, add a variant, put it into [`Role::ALL`], and give its facts.
//! - A *thick* bead is printed for several layers at once; [`Both`] holds a value for thin and thick.
//! - A [`RoleTable`] holds a value for each role.
//!
//! Roles that differ little from another one take its facts and change what differs.

use crate::profile::{Acceleration, Cooling, Extrusion, Jerk, Speed};
use std::ops::{Index, IndexMut};

/// What a path is printed for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// The outermost wall.
    OuterWall,
    /// Walls inside it.
    InnerWall,
    /// Walls where they hang over nothing. No path has it: it is told by the points.
    Overhang,
    /// Solid lines at tops and bottoms.
    Skin,
    /// Solid lines over places where nothing is printed below.
    Bridge,
    /// Sparse infill.
    Infill,
    /// Beads along gaps that no line of skin reaches, if they have a speed of their own.
    Gap,
    /// Skin that is seen from above; last in its island, so that the nozzle does not pass over it.
    TopSkin,
    /// The nozzle goes over such skin once more, with little plastic.
    Ironing,
    /// Skin that follows a slope, laid when all under it is whole.
    NonPlanar,
    /// Support.
    Support,
    /// Dense support next to the part.
    SupportInterface,
    /// Loops around everything, which fill the nozzle.
    Skirt,
    /// Lines beside the first layer, which hold it.
    Brim,
    /// The lowest layer of a raft.
    RaftBase,
    /// The layers of a raft above it.
    RaftInterface,
}

/// Where a role has its place in the order of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Before everything else of its island, by depth.
    Walls,
    /// Inside the walls of its island, role after role.
    Inside,
    /// Not part of the model: before everything else of the layer, in the order given.
    First,
    /// Not part of the model: after all islands of the layer.
    Helper,
    /// On what the layer has printed: after everything else of it.
    Last,
}

impl Order {
    /// Whether what is there is part of the model.
    #[must_use]
    pub fn is_of_part(self) -> bool {
        matches!(self, Self::Walls | Self::Inside)
    }
}

/// When a role is slowed down where a layer would take too little time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slows {
    /// Infill, skins and support, before all else. A slower top skin looks no worse: all of a layer's
    /// top has one speed.
    First,
    /// Walls that are not seen.
    Second,
    /// What is seen beside that of other layers, and what hangs: its speed shows.
    Last,
}

/// What is particular to a role.
#[derive(Debug, Clone, Copy)]
pub struct RoleFacts {
    /// Its name in reports.
    pub name: &'static str,
    /// Its annotation in G-code, after `;TYPE:`, as viewers know it.
    pub annotation: &'static str,
    /// Its place in the order of a layer.
    pub order: Order,
    /// Whether it may be printed for several layers at once.
    pub may_be_thick: bool,
    /// The settings keys of its speed, thin and thick.
    pub speed_keys: fn(&Speed) -> Both<&'static str>,
    /// Its speed, thin and thick.
    pub speed: fn(&Speed) -> Both<f64>,
    /// Its acceleration, mm/s²; none where it is the machine's.
    pub acceleration: fn(&Acceleration) -> Option<f64>,
    /// Its jerk, mm/s; none where it is the machine's.
    pub jerk: fn(&Jerk) -> Option<f64>,
    /// When it is slowed down for a layer's least time.
    pub slows: Slows,
    /// Power of the fan on it, %; none where it is as usual.
    pub fan: fn(&Cooling) -> Option<f64>,
    /// Filament per length of path, mm/mm, for profiles that set it explicitly.
    pub factor: fn(&Extrusion) -> f64,
}

impl Role {
    /// All roles, in the order of reports and of what lies inside an island.
    pub const ALL: [Self; 16] = [
        Self::OuterWall,
        Self::InnerWall,
        Self::Overhang,
        Self::Skin,
        Self::Bridge,
        Self::Infill,
        Self::Gap,
        Self::TopSkin,
        Self::Ironing,
        Self::NonPlanar,
        Self::Support,
        Self::SupportInterface,
        Self::Skirt,
        Self::Brim,
        Self::RaftBase,
        Self::RaftInterface,
    ];

    /// What is particular to it.
    #[must_use]
    pub const fn facts(self) -> RoleFacts {
        match self {
            Self::OuterWall => OUTER_WALL,
            Self::InnerWall => RoleFacts {
                name: "inner wall",
                annotation: "Perimeter",
                may_be_thick: true,
                speed_keys: |speed| own(speed.inner_wall, "speed.inner_wall", "speed.wall"),
                speed: |speed| Both::same(speed.inner_wall.unwrap_or(speed.wall)),
                acceleration: |a| a.inner_wall.or(a.wall),
                jerk: |j| j.inner_wall.or(j.wall),
                slows: Slows::Second,
                ..OUTER_WALL
            },
            Self::Overhang => RoleFacts {
                name: "overhanging wall",
                annotation: "Overhang perimeter",
                speed_keys: |_| Both::same("speed.overhang"),
                speed: |speed| Both::same(speed.overhang),
                acceleration: |a| a.overhang.or(a.outer_wall).or(a.wall),
                jerk: |j| j.overhang.or(j.outer_wall).or(j.wall),
                fan: |cooling| Some(cooling.overhang_fan.unwrap_or(cooling.bridge_fan)),
                ..OUTER_WALL
            },
            Self::Skin => SKIN,
            Self::Bridge => BRIDGE,
            Self::Infill => INFILL,
            Self::TopSkin => TOP_SKIN,
            Self::Ironing => IRONING,
            Self::NonPlanar => NON_PLANAR,
            Self::Gap => GAP,
            Self::Support => SUPPORT,
            Self::SupportInterface => SUPPORT_INTERFACE,
            Self::Skirt => SKIRT,
            Self::Brim => RoleFacts { name: "brim", ..SKIRT },
            Self::RaftBase => RAFT_BASE,
            Self::RaftInterface => RAFT_INTERFACE,
        }
    }
}

/// The key of a speed that is `usual` where it has none of its own.
fn own(speed: Option<f64>, key: &'static str, usual: &'static str) -> Both<&'static str> {
    Both::same(if speed.is_some() { key } else { usual })
}

const OUTER_WALL: RoleFacts = RoleFacts {
    name: "outer wall",
    annotation: "External perimeter",
    order: Order::Walls,
    may_be_thick: false,
    speed_keys: |speed| own(speed.outer_wall, "speed.outer_wall", "speed.wall"),
    speed: |speed| Both::same(speed.outer_wall.unwrap_or(speed.wall)),
    acceleration: |a| a.outer_wall.or(a.wall),
    jerk: |j| j.outer_wall.or(j.wall),
    slows: Slows::Last,
    fan: |_| None,
    factor: |extrusion| extrusion.wall_factor,
};

// As fast as walls: what holds a part on the bed is laid with care.
const SKIRT: RoleFacts =
    RoleFacts { name: "skirt", annotation: "Skirt/Brim", order: Order::First, ..OUTER_WALL };

const SKIN: RoleFacts = RoleFacts {
    name: "skin",
    annotation: "Solid infill",
    order: Order::Inside,
    may_be_thick: true,
    speed_keys: |_| Both::same("speed.skin"),
    speed: |speed| Both::same(speed.skin),
    acceleration: |a| a.skin,
    jerk: |j| j.skin,
    slows: Slows::First,
    fan: |_| None,
    factor: |extrusion| extrusion.skin_factor,
};

const BRIDGE: RoleFacts = RoleFacts {
    name: "bridge",
    annotation: "Bridge infill",
    may_be_thick: false,
    speed_keys: |_| Both::same("speed.bridge"),
    speed: |speed| Both::same(speed.bridge),
    acceleration: |a| a.bridge.or(a.skin),
    jerk: |j| j.bridge.or(j.skin),
    slows: Slows::Last,
    fan: |cooling| Some(cooling.bridge_fan),
    ..SKIN
};

const TOP_SKIN: RoleFacts = RoleFacts {
    name: "top skin",
    annotation: "Top solid infill",
    may_be_thick: false,
    speed_keys: |speed| own(speed.top_skin, "speed.top_skin", "speed.skin"),
    speed: |speed| Both::same(speed.top_skin.unwrap_or(speed.skin)),
    acceleration: |a| a.top_skin.or(a.skin),
    jerk: |j| j.top_skin.or(j.skin),
    ..SKIN
};

// Its speed shows, as that of walls does.
const IRONING: RoleFacts = RoleFacts {
    name: "ironing",
    annotation: "Ironing",
    order: Order::Last,
    may_be_thick: false,
    speed_keys: |_| Both::same("speed.ironing"),
    speed: |speed| Both::same(speed.ironing),
    acceleration: |a| a.top_skin.or(a.skin),
    jerk: |j| j.top_skin.or(j.skin),
    slows: Slows::Last,
    ..SKIN
};

// Viewers draw it as what it is seen as.
const NON_PLANAR: RoleFacts = RoleFacts {
    name: "non-planar skin",
    annotation: TOP_SKIN.annotation,
    order: Order::Last,
    speed_keys: |_| Both::same("speed.nonplanar"),
    speed: |speed| Both::same(speed.nonplanar),
    slows: Slows::Last,
    ..TOP_SKIN
};

const GAP: RoleFacts = RoleFacts {
    name: "gap",
    annotation: "Gap fill",
    speed_keys: |speed| own(speed.gap, "speed.gap", "speed.skin"),
    speed: |speed| Both::same(speed.gap.unwrap_or(speed.skin)),
    acceleration: |a| a.gap.or(a.skin),
    jerk: |j| j.gap.or(j.skin),
    ..SKIN
};

const INFILL: RoleFacts = RoleFacts {
    name: "infill",
    annotation: "Internal infill",
    order: Order::Inside,
    may_be_thick: true,
    speed_keys: |_| Both { thin: "speed.infill", thick: "speed.thick_infill" },
    speed: |speed| Both { thin: speed.infill, thick: speed.thick_infill },
    acceleration: |a| a.infill,
    jerk: |j| j.infill,
    slows: Slows::First,
    fan: |_| None,
    factor: |extrusion| extrusion.infill_factor,
};

const SUPPORT: RoleFacts = RoleFacts {
    name: "support",
    annotation: "Support material",
    order: Order::Helper,
    may_be_thick: true,
    speed_keys: |_| Both::same("speed.support"),
    speed: |speed| Both::same(speed.support),
    acceleration: |a| a.support,
    jerk: |j| j.support,
    slows: Slows::First,
    fan: |_| None,
    factor: |extrusion| extrusion.support_factor,
};

const SUPPORT_INTERFACE: RoleFacts = RoleFacts {
    name: "support interface",
    annotation: "Support material interface",
    fan: |cooling| cooling.interface_fan,
    may_be_thick: false,
    ..SUPPORT
};

// Support of all that is printed: other slicers and viewers call it that, too.
const RAFT_BASE: RoleFacts = RoleFacts {
    name: "raft base",
    speed_keys: |_| Both::same("speed.raft_base"),
    speed: |speed| Both::same(speed.raft_base),
    may_be_thick: false,
    ..SUPPORT
};

const RAFT_INTERFACE: RoleFacts = RoleFacts {
    name: "raft interface",
    annotation: SUPPORT_INTERFACE.annotation,
    speed_keys: |_| Both::same("speed.raft_interface"),
    speed: |speed| Both::same(speed.raft_interface),
    ..RAFT_BASE
};

/// A value for each role.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RoleTable<T>([T; Role::ALL.len()]);

impl<T> RoleTable<T> {
    /// The table with the value `of(role)` for each role.
    #[must_use]
    pub fn new(of: impl FnMut(Role) -> T) -> Self {
        Self(Role::ALL.map(of))
    }

    /// The roles with their values, in the order of [`Role::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Role, &T)> {
        Role::ALL.into_iter().zip(&self.0)
    }
}

impl<T> Index<Role> for RoleTable<T> {
    type Output = T;

    fn index(&self, role: Role) -> &T {
        &self.0[role as usize]
    }
}

impl<T> IndexMut<Role> for RoleTable<T> {
    fn index_mut(&mut self, role: Role) -> &mut T {
        &mut self.0[role as usize]
    }
}

/// A value for beads of one layer's height, and one for thick beads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Both<T> {
    /// For one layer's height.
    pub thin: T,
    /// For several layers' height.
    pub thick: T,
}

impl<T> Both<T> {
    /// The value for thick beads if `thick`, else that for thin ones.
    pub fn of(&self, thick: bool) -> &T {
        if thick { &self.thick } else { &self.thin }
    }

    /// Like [`Self::of`], mutable.
    pub fn of_mut(&mut self, thick: bool) -> &mut T {
        if thick { &mut self.thick } else { &mut self.thin }
    }

    /// Thin, then thick.
    pub fn iter(&self) -> impl Iterator<Item = (bool, &T)> {
        [(false, &self.thin), (true, &self.thick)].into_iter()
    }
}

impl<T: Copy> Both<T> {
    /// The same value for both.
    #[must_use]
    pub const fn same(value: T) -> Self {
        Self { thin: value, thick: value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_finds_each_role_at_its_own_place() {
        let table = RoleTable::new(|role| role);
        assert!(Role::ALL.into_iter().all(|role| table[role] == role));
        assert!(table.iter().all(|(role, value)| role == *value));
    }

    #[test]
    fn viewers_know_every_annotation() {
        // Those that PrusaSlicer writes and reads; others have its list, or a part of it.
        let known = [
            "Perimeter",
            "External perimeter",
            "Overhang perimeter",
            "Internal infill",
            "Solid infill",
            "Top solid infill",
            "Ironing",
            "Bridge infill",
            "Gap fill",
            "Skirt/Brim",
            "Support material",
            "Support material interface",
            "Wipe tower",
        ];
        for role in Role::ALL {
            let annotation = role.facts().annotation;
            assert!(known.contains(&annotation), "{annotation} of {role:?}");
        }
    }
}
