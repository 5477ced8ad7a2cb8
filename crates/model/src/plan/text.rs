//! Plan as readable lines, for the command line and the log.
//!
//! Theory: docs/theory.md, section 8.2.

use super::model_level::ModelLevel;
use super::{Candidate, Plan};
use scene::HeatResolution;

impl Plan {
    /// The plan's level in one line.
    pub fn summary(&self) -> String {
        let heat = match self.model_level {
            ModelLevel::Lumped => "lumped heat",
            ModelLevel::Line { heat: HeatResolution::Lumped, .. } => "lumped heat",
            ModelLevel::Line { .. } => "resolved heat",
        };
        format!(
            "auto takes {}, {heat}, order {}, thermal states: punch {}, strip {}, moving source {}: {}",
            self.model_level, self.order, self.states[0], self.states[1], self.states[2], self.reason
        )
    }

    /// All lines: the summary, effects, groups and the levels considered.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![self.summary()];
        lines.push(format!(
            "estimated error {} of a tolerance of {}, {} by the reduced bodies; {:.1} µs for an internal step, {} s for {} s \
             of the run; compared in {} internal steps over {:.3} % of it, {} s",
            self.estimated_error.map_or("that of the steps".into(), short),
            short(self.tolerance),
            short(self.reduction_error),
            self.cost_per_step,
            short(1e-6 * self.run_cost),
            self.duration,
            self.compared_steps,
            100.0 * self.covered,
            short(1e-6 * self.planning_cost)
        ));
        lines.extend(self.after_release());
        for effect in &self.effects {
            lines.push(format!(
                "{:28} {:34} {:>9}  {}",
                effect.name,
                effect.measure,
                short(effect.number),
                if effect.kept { "kept".into() } else { format!("dropped, error {}", short(effect.error)) }
            ));
        }
        for (name, value) in self.groups() {
            lines.push(format!("{name:63} {:>9}", short(value)));
        }
        for candidate in &self.candidates {
            let [wear, temperature, force] = candidate.errors.map(short);
            let model_level = candidate.model_level.to_string();
            let chosen = if candidate.model_level == self.model_level { "  <" } else { "" };
            lines.push(format!(
                "{model_level:28} errors of wear {wear}, temperature {temperature}, force {force}; {:.1} µs a step{chosen}",
                candidate.cost
            ));
        }
        lines
    }

    /// Error after a release of the load, where it exceeds the tolerance, and the level that keeps it then too.
    fn after_release(&self) -> Option<String> {
        let released = self.released_error.filter(|error| self.meets && *error > self.tolerance)?;
        let within = |candidate: &&Candidate| candidate.released <= self.tolerance;
        let better = match self.candidates.iter().find(within) {
            Some(candidate) => format!("solver.fidelity = {} is within the tolerance then too", candidate.model_level),
            None => "no level that was compared is within the tolerance then".into(),
        };
        Some(format!("once the load has been released its error is up to {}; {better}", short(released)))
    }

    /// Dimensionless groups with their names.
    pub fn groups(&self) -> [(&'static str, f64); 16] {
        let groups = &self.groups;
        [
            ("Peclet number of the strip", groups.peclet),
            ("Fourier number of the punch", groups.fourier[0]),
            ("Fourier number of the strip", groups.fourier[1]),
            ("Biot number of the punch", groups.biot[0]),
            ("Biot number of the strip", groups.biot[1]),
            ("Dundurs parameter", groups.dundurs),
            ("compliance of the strip over that of both", groups.strip_compliance),
            ("thermal distortion over elastic approach", groups.distortion_over_approach),
            ("wear over elastic approach", groups.wear_over_approach),
            ("wear of the strip over that of both", groups.strip_wear),
            ("speed over critical speed", groups.speed_over_critical),
            ("exponent of the growth of perturbations", self.growth[1]),
            ("lever of the friction force over half-width", groups.lever),
            ("pressure exponent less 1", groups.exponent),
            ("change of friction by fade", groups.fade[0]),
            ("change of wear by fade", groups.fade[1]),
        ]
    }
}

fn short(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if (0.01..1e4).contains(&value.abs()) {
        format!("{value:.3}")
    } else {
        format!("{value:.1e}")
    }
}
