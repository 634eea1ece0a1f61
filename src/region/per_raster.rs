//! Rasters -> PerRaster: a value for each raster, found by the raster itself.

use crate::geom::raster::Raster;

/// The rasters in use, each once. The first two carry the skins of even and odd layers.
#[derive(Debug, Clone, PartialEq)]
pub struct Rasters(Vec<Raster>);

impl Rasters {
    /// The rasters of skins, and `others`.
    #[must_use]
    pub fn new(skin: [Raster; 2], others: impl Iterator<Item = Raster>) -> Self {
        let mut all = skin.to_vec();
        for raster in others {
            if !all.contains(&raster) {
                all.push(raster);
            }
        }
        Self(all)
    }

    /// One of the two rasters of skins.
    #[must_use]
    pub fn skin(&self, index: usize) -> Raster {
        self.0[index]
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = Raster> {
        self.0.iter().copied()
    }
}

/// Which of the two rasters of skins carries the lines of layer `k`, and which lies across.
#[must_use]
pub fn skin_turn(k: usize) -> (usize, usize) {
    (k % 2, 1 - k % 2)
}

/// Values for the two rasters of skins, and for others that were requested.
#[derive(Debug, Clone)]
pub struct PerRaster<T> {
    skins: [T; 2],
    others: Vec<(Raster, T)>,
    rasters: [Raster; 2],
}

impl<T> PerRaster<T> {
    /// The values that `make` gives for the rasters of skins and for `others`.
    #[must_use]
    pub fn new(
        rasters: &Rasters,
        others: impl Iterator<Item = Raster>,
        mut make: impl FnMut(Raster) -> T,
    ) -> Self {
        let skins = [0, 1].map(|index| rasters.skin(index));
        let mut out = Self { skins: skins.map(&mut make), others: Vec::new(), rasters: skins };
        for raster in others {
            if out.on(raster).is_none() {
                out.others.push((raster, make(raster)));
            }
        }
        out
    }

    /// Changes each value.
    #[must_use]
    pub fn map_on(self, mut make: impl FnMut(Raster, T) -> T) -> Self {
        let Self { skins: [a, b], others, rasters } = self;
        let skins = [make(rasters[0], a), make(rasters[1], b)];
        let others = others.into_iter().map(|(raster, value)| (raster, make(raster, value)));
        Self { skins, others: others.collect(), rasters }
    }

    /// The value for one of the two rasters of skins.
    #[must_use]
    pub fn skin(&self, index: usize) -> &T {
        &self.skins[index]
    }

    /// The value for `raster`; `None` if it was not requested.
    #[must_use]
    pub fn on(&self, raster: Raster) -> Option<&T> {
        if let Some(index) = self.rasters.iter().position(|r| *r == raster) {
            return Some(&self.skins[index]);
        }
        self.others.iter().find(|(r, _)| *r == raster).map(|(_, value)| value)
    }

    /// The value for the raster of skins across `raster`, that raster, and whether it is turned by
    /// +90° (else by −90°); `None` if `raster` is not parallel to one of skins.
    #[must_use]
    pub fn across(&self, raster: Raster) -> Option<(&T, Raster, bool)> {
        let along = self.rasters.iter().position(|r| r.frame == raster.frame)?;
        Some((&self.skins[1 - along], self.rasters[1 - along], along == 0))
    }

    /// All values, those for the rasters of skins first.
    pub fn iter(&self) -> impl Iterator<Item = (Raster, &T)> {
        let skins = self.rasters.iter().copied().zip(&self.skins);
        skins.chain(self.others.iter().map(|(raster, value)| (*raster, value)))
    }
}
