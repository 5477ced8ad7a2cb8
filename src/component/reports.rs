//! Messages of the component: the plan and the warnings at the end of initialisation, and limits when they are reached.

use super::{Component, Subject, inputs_of};
use model::Inputs;
use model::lumped::limit;
use scene::message::Number;
use scene::variables::TOLERANCES;
use scene::{Scene, value};

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
        let fresh = limits & !self.run.reported;
        let texts = [
            (limit::WEAR, "a wear limit is reached (limit_reached bit 1)"),
            (
                limit::VALIDITY,
                "the run is outside the model's validity (limit_reached bit 4): load or speed far above nominal, \
                 contact above 2500 K, half of a body worn off, or a return to a part of the worn track that is no longer stored",
            ),
        ];
        for (bit, text) in texts {
            if fresh & bit != 0 {
                self.messages.add(Subject::Warning, format_args!("{text}"));
            }
        }
        let inputs = inputs_of(&self.values);
        if fresh & limit::TEMPERATURE != 0 {
            let limit = value!(self.values, "contact.temperature_limit");
            let text = format_args!(
                "contact.temperature_limit = {limit} K is exceeded (limit_reached bit 2)",
                limit = Number(limit)
            );
            self.messages.add(Subject::Warning, text);
        }
        if fresh & limit::NEGATIVE_LOAD != 0 {
            let load = began.normal_load.min(inputs.normal_load);
            let text = format_args!(
                "normal_load = {load} N is below 0 N and counts as 0: the contact is open",
                load = Number(load)
            );
            self.messages.add(Subject::Warning, text);
        }
        if fresh & BOTH_VELOCITIES != 0 {
            let radius = value!(self.values, "contact.mean_radius");
            let text = format_args!(
                "sliding_velocity = {} m/s and angular_velocity = {} rad/s are both given and add up: with \
                 contact.mean_radius = {radius} m the contact slides at {} m/s",
                Number(began.sliding_velocity),
                Number(began.angular_velocity),
                Number(began.sliding_velocity + radius * began.angular_velocity),
                radius = Number(radius)
            );
            self.messages.add(Subject::Warning, text);
        }
        if fresh & WITHOUT_RADIUS != 0 {
            let text = format_args!(
                "angular_velocity = {} rad/s has no effect: contact.mean_radius = 0 m; the contact slides at sliding_velocity = {} m/s",
                Number(began.angular_velocity),
                Number(began.sliding_velocity)
            );
            self.messages.add(Subject::Warning, text);
        }
        for bit in [limit::ACCELERATED, limit::UNSTABLE] {
            if let Some(model) = self.model.as_ref().filter(|_| fresh & bit != 0) {
                self.messages.compose(Subject::Warning, |text| model.write_warning(bit, &inputs, text));
            }
        }
        self.run.reported |= limits;
    }
}
