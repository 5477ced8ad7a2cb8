//! Messages of the component: the plan and the warnings at the end of initialisation, and limits when they are reached.

use super::{Component, Subject, inputs_of};
use model::Inputs;
use model::lumped::limit;
use scene::message::Number;
use scene::variables::TOLERANCES;
use scene::{Scene, value};
use std::fmt::Arguments;

/// Bit for both velocities given in a step, beside those of [`limit`].
pub(super) const BOTH_VELOCITIES: u8 = 64;

/// Bit for an angular velocity that moves nothing.
pub(super) const WITHOUT_RADIUS: u8 = 128;

impl Component {
    /// Logs the plan and the warnings of the scene.
    pub(super) fn announce(&mut self, scene: &Scene) {
        let own = value!(self.values, "solver.tolerance") > 0.0;
        let source = match (own, self.run.tolerance, self.declared_tolerance) {
            (true, ..) => "solver.tolerance",
            (false, Some(_), _) => "the importer",
            (false, None, Some(_)) => "the scene's DefaultExperiment",
            (false, None, None) => "the default",
        };
        if let (false, Some(given)) = (own, self.run.tolerance)
            && given != scene.tolerance
        {
            let (least, largest) = (TOLERANCES.start(), TOLERANCES.end());
            self.messages.add(
                Subject::Warning,
                format_args!(
                    "the importer's tolerance {given:e} is outside {least:e} to {largest}: {:e} is used",
                    scene.tolerance
                ),
            );
        }
        let prepared = self.prepared.as_ref().expect("built just before");
        let mut lines = prepared.lines().into_iter();
        let first = lines.next().unwrap_or_default();
        self.messages.add(Subject::Plan, format_args!("tolerance {:e} from {source}; {first}", scene.tolerance));
        lines.for_each(|text| self.messages.add(Subject::Plan, format_args!("{text}")));
        let external =
            [value!(self.values, "strip.external_temperature"), value!(self.values, "punch.external_temperature")];
        let warnings = scene.warnings().into_iter().chain(scene.warnings_of_external(external));
        let warnings = warnings.chain(scene::without_effect(&self.values, &self.starts));
        for text in warnings.chain(prepared.operators.warnings()) {
            self.messages.add(Subject::Warning, format_args!("{text}"));
        }
    }

    /// Logs limits not logged before, after a step that began at the inputs `began`.
    pub(super) fn report(&mut self, limits: u8, began: &Inputs) {
        let (fresh, inputs) = (limits & !self.run.reported, inputs_of(&self.values));
        let [limit, radius] =
            [value!(self.values, "contact.temperature_limit"), value!(self.values, "contact.mean_radius")].map(Number);
        let Inputs { sliding_velocity, angular_velocity, .. } = *began;
        let [sliding, turning] = [sliding_velocity, angular_velocity].map(Number);
        let mut warn = |bit: u8, text: Arguments<'_>| {
            if fresh & bit != 0 {
                self.messages.add(Subject::Warning, text);
            }
        };
        warn(limit::WEAR, format_args!("a wear limit is reached (limit_reached bit 1)"));
        warn(
            limit::VALIDITY,
            format_args!(
                "the run is outside the model's validity (limit_reached bit 4): load or speed far above nominal, \
                 contact above 2500 K, half of a body worn off, or a return to a part of the worn track that is no longer stored"
            ),
        );
        warn(
            limit::TEMPERATURE,
            format_args!("contact.temperature_limit = {limit} K is exceeded (limit_reached bit 2)"),
        );
        warn(
            limit::NEGATIVE_LOAD,
            format_args!(
                "normal_load = {} N is below 0 N and counts as 0: the contact is open",
                Number(began.normal_load.min(inputs.normal_load))
            ),
        );
        warn(
            BOTH_VELOCITIES,
            format_args!(
                "sliding_velocity = {sliding} m/s and angular_velocity = {turning} rad/s are both given and add up: with \
                 contact.mean_radius = {radius} m the contact slides at {} m/s",
                Number(sliding_velocity + radius.0 * angular_velocity)
            ),
        );
        warn(
            WITHOUT_RADIUS,
            format_args!(
                "angular_velocity = {turning} rad/s has no effect: contact.mean_radius = 0 m; the contact slides at sliding_velocity = \
                 {sliding} m/s"
            ),
        );
        for bit in [limit::ACCELERATED, limit::UNSTABLE] {
            if let Some(model) = self.model.as_ref().filter(|_| fresh & bit != 0) {
                self.messages.compose(Subject::Warning, |text| model.write_warning(bit, &inputs, text));
            }
        }
        self.run.reported |= limits;
    }
}
