//! Commands for heaters -> whether the nozzle is hot.

use crate::reader::{Heater, Heating};

/// Nothing melts below this, °C.
const COLDEST: f64 = 60.0;

/// The nozzles' temperatures so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Heat {
    /// By tool (`None` is the one in use), °C.
    targets: Vec<(Option<u32>, f64)>,
    hot: bool,
}

impl Heat {
    /// Of a printer that heats the nozzle by itself before it reads the file.
    pub(crate) fn by_printer() -> Self {
        Self { hot: true, ..Self::default() }
    }

    /// A command for a heater.
    pub(crate) fn set(&mut self, heating: &Heating) {
        if heating.heater == Heater::Bed {
            return;
        }
        if let (Heater::Nozzle(tool), Some(celsius)) = (heating.heater, heating.celsius) {
            self.targets.retain(|(known, _)| *known != tool);
            self.targets.push((tool, celsius));
        }
        let wanted = self.is_wanted();
        self.hot = wanted && (self.hot || heating.waits);
    }

    /// Whether some nozzle is set to melt plastic.
    pub(crate) fn is_wanted(&self) -> bool {
        self.targets.iter().any(|(_, celsius)| *celsius >= COLDEST)
    }

    /// Whether it is, and has been waited for.
    pub(crate) fn is_hot(&self) -> bool {
        self.hot
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hot_is_what_was_set_and_waited_for() {
        let nozzle =
            |tool, celsius, waits| Heating { heater: Heater::Nozzle(tool), celsius, waits };
        let mut heat = Heat::default();
        heat.set(&nozzle(Some(1), Some(200.0), false));
        assert!(heat.is_wanted() && !heat.is_hot());
        heat.set(&Heating { heater: Heater::Bed, celsius: Some(60.0), waits: true });
        assert!(!heat.is_hot());
        heat.set(&Heating { heater: Heater::All, celsius: None, waits: true });
        assert!(heat.is_hot());
        // Another temperature later keeps it hot, none does not.
        heat.set(&nozzle(Some(1), Some(190.0), false));
        assert!(heat.is_hot());
        heat.set(&nozzle(Some(1), Some(0.0), false));
        assert!(!heat.is_hot());
    }
}
