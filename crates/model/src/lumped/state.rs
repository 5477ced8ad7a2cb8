//! State of the lumped level, as it is saved.
//!
//! Theory: docs/theory.md, section 1.3.

use super::operators::LumpedOperators;
use conduction::flash::MAX_FLASH_STATES;
use conduction::reduced::{MAX_STATES, ReducedBody};
use contact::wear::track::Track;
use scene::{Body, Path};

/// Thermal state and wear of one body.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct BodyState {
    /// States of the reduced conduction problem.
    pub heat: [f64; MAX_STATES],
    /// Time integrals of the fluxes through the ports since initialisation, by port.
    pub received: [f64; 4],
    /// Heat that has left by the path to the neighbour since initialisation, J/m2 of reference area.
    pub external: f64,
    /// Heat that has left by the constant heat transfer since initialisation, J/m2 of reference area; counted where the properties follow
    /// the temperature.
    pub lost: f64,
    /// Rate of the mean temperature over the last step, K/s; likewise.
    pub trend: f64,
    /// Worn depth under a contact that stays on its material, m: of the punch, or of the strip on a closed path.
    pub depth: f64,
    /// Worn volume per face over the contact area, m.
    pub worn: f64,
}

/// State of the lumped level.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct LumpedState {
    /// Of the punch.
    pub punch: BodyState,
    /// Of the strip.
    pub strip: BodyState,
    /// States of the moving source, K.
    pub flash: [f64; MAX_FLASH_STATES],
    /// Worn track of a straight path; `None` without a track.
    pub track: Option<Track>,
    /// Position of the punch on the strip, m.
    pub position: f64,
    /// Distance slid, m.
    pub distance: f64,
    /// Friction heat per contact area, J/m2.
    pub dissipated: f64,
    /// Bristle deflection, m.
    pub bristle: f64,
    /// Stiffness of the bristle, N/m; 0: none.
    pub stiffness: f64,
    /// Prescribed temperatures of the far faces (punch, strip) at initialisation, K above the reference.
    pub far_start: [f64; 2],
    /// The same now.
    pub far: [f64; 2],
    /// Largest temperature rise at the contact so far, K.
    pub peak_rise: f64,
    /// Largest friction heat flux so far, W/m2.
    pub peak_flux: f64,
    /// Largest wear rate so far, m/s.
    pub peak_wear: f64,
    /// Exponent by which pressure perturbations may have grown so far; see [`crate::growth`].
    pub growth: f64,
    /// Bits of `limit_reached` set so far.
    pub limits: u8,
    /// log2 of the number of parts of the last communication step.
    pub refinement: u8,
    /// Reference temperature: ambient temperature at initialisation, K.
    pub reference: f64,
    /// Contact temperature at the end of the last step, K above the reference.
    pub end_temperature: f64,
    /// Friction force at the end of the last step, N.
    pub end_force: f64,
    /// Running estimate of the relative error.
    pub error: f64,
    /// Accepted steps, for work-precision charts.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
}

impl LumpedState {
    /// Initial state: bodies at their initial temperatures, unworn. `ambient` in K.
    pub(crate) fn new(operators: &LumpedOperators, ambient: f64) -> LumpedState {
        let reference = ambient;
        let scene = &operators.scene;
        let start = |heat: Option<&ReducedBody>, body: &Body| {
            let mut state = BodyState::default();
            if let Some(heat) = heat {
                let initial = if body.initial_temperature > 0.0 { body.initial_temperature } else { ambient };
                for k in 0..heat.count {
                    state.heat[k] = heat.uniform[k] * (initial - reference);
                }
            }
            state
        };
        let punch = start(operators.punch.heat.as_ref(), &scene.punch);
        let strip = start(operators.strip.heat.as_ref().filter(|_| operators.strip_remembers), &scene.strip);
        let straight = scene.path == Path::Straight;
        let track = straight.then(|| Track::new(0.5 * scene.sliding_extent(), scene.nominal_stroke));
        // Bodies that start at temperatures of their own have that rise already; an insulator has none.
        let conduct = [&scene.punch, &scene.strip].into_iter().filter(|body| body.conductivity > 0.0);
        let initial = conduct.map(|body| body.initial_temperature).filter(|initial| *initial > 0.0);
        let peak_rise = initial.map(|initial| (initial - reference).abs()).fold(0.0, f64::max);
        let stiffness = operators.stick_stiffness(operators.tangential_stiffness);
        LumpedState { punch, strip, track, reference, peak_rise, stiffness, ..LumpedState::default() }
    }

    /// Adds the worn depths `worn` (m; punch, strip) under a contact that moves by `travel` (m).
    #[inline(always)]
    pub(crate) fn wear(&mut self, operators: &LumpedOperators, worn: [f64; 2], travel: f64) {
        self.punch.worn += worn[0];
        self.punch.depth += worn[0];
        self.strip.worn += worn[1];
        match &mut self.track {
            Some(track) if worn[1] > 0.0 => track.wear(self.position, self.position + travel, worn[1]),
            Some(_) => {}
            None => self.strip.depth += worn[1] * operators.strip_coverage,
        }
        self.position += travel;
    }

    /// Whether the state is compatible with `operators`.
    pub(crate) fn fits(&self, operators: &LumpedOperators) -> bool {
        let within = |heat: &[f64], body: &super::operators::BodyOperators| {
            let count = body.heat.as_ref().map_or(0, |heat| heat.count);
            heat[count..].iter().all(|value| *value == 0.0)
        };
        within(&self.punch.heat, &operators.punch)
            && within(&self.strip.heat, &operators.strip)
            && self.track.is_some() == (operators.scene.path == Path::Straight)
            && (self.stiffness > 0.0) == operators.has_bristle()
            && self.refinement <= 60
    }
}
