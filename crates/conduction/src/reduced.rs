//! Modal reduction of a body's conduction to a few decaying states, as used by the time step.
//!
//! States `a` (K sqrt(J/(m2 K))), inputs `u` in the order of [`Port`]:
//!
//! ```text
//! da_k/dt = -rate_k a_k + sum_i input_ik u_i
//! y       =  sum_k output_k a_k + sum_i direct_i u_i          for every observed quantity y
//! ```
//!
//! All fluxes are per reference area of the body, temperatures relative to a common reference. The static correction of
//! modes faster than the resolved ones is the direct feedthrough `direct`.
//!
//! Theory: docs/theory.md, section 4.2.

/// Part of its share in the stationary field that a state of decay rate `rate` takes over at once where a prescribed temperature
/// jumps, and of a flux into the face opposite to the contact. The projection of either on the states oscillates at that face and
/// reaches the contact at once. The response at a real frequency s, which is in the space and lags behind, has the part
/// `s/(s + rate)`; this is the combination of two of them whose error in the slow states is of second order. By reciprocity it is
/// the part of its heat that counts as stored under a prescribed temperature: the rest has left through that face, so that a flux
/// into the contact does not pass there at once; and its part in the temperature of a face with a flux.
pub(crate) fn lagging(rate: f64, [first, second]: [f64; 2]) -> f64 {
    1.0 - rate / (rate + first) * (rate / (rate + second))
}

/// Largest number of states of a reduced slab.
pub(crate) const MAX_SLAB_STATES: usize = 24;

/// Largest number of states of a reduced body: the slab's and those of a stroke's track.
pub const MAX_STATES: usize = 32;

/// Inputs of a body.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Port {
    /// Heat flux through the contact, W/m2 of contact area (scaled by the coverage inside).
    Contact = 0,
    /// Heat flux through the cooled surface beyond the constant heat transfer, W/m2 of reference area.
    Cooling = 1,
    /// Ambient temperature, K relative to the reference.
    Ambient = 2,
    /// Boundary value of the face opposite to the contact: its temperature where that is prescribed, K relative to the
    /// reference; elsewhere the heat flux into it beyond its constant heat transfer, W/m2 of reference area.
    Base = 3,
}

/// Number of inputs.
pub const PORTS: usize = 4;

/// Linear observation of states and inputs.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct Observation {
    /// Weight of every state.
    pub states: [f64; MAX_STATES],
    /// Direct feedthrough (static correction) of every input.
    pub direct: [f64; PORTS],
}

impl Observation {
    /// Contribution of the states to the observation.
    #[inline]
    pub fn of_states(&self, states: &[f64; MAX_STATES], count: usize) -> f64 {
        // Four running sums for vector instructions, with a summation order that is the same on every machine.
        let groups = count.div_ceil(4);
        let mut sum = [0.0; 4];
        for (left, right) in self.states.as_chunks::<4>().0.iter().zip(states.as_chunks::<4>().0).take(groups) {
            for lane in 0..4 {
                sum[lane] += left[lane] * right[lane];
            }
        }
        (sum[0] + sum[2]) + (sum[1] + sum[3])
    }
}

/// Reduced body; equations in the module documentation.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct ReducedBody {
    /// Number of states.
    pub count: usize,
    /// Decay rates, 1/s, ascending; 0 for a body that cannot lose heat.
    pub rate: [f64; MAX_STATES],
    /// Input weights by [`Port`].
    pub input: [[f64; MAX_STATES]; PORTS],
    /// Temperature of the contact surface, K.
    pub contact_temperature: Observation,
    /// Mean temperature of the cooled surface, K.
    pub cooled_temperature: Observation,
    /// Temperature of the face opposite to the contact, K.
    pub base_temperature: Observation,
    /// Mean temperature of the body, K.
    pub mean_temperature: Observation,
    /// Heat stored, J/m2 of reference area.
    pub stored: Observation,
    /// States of the body at the uniform temperature 1 K.
    pub uniform: [f64; MAX_STATES],
    /// Heat flow to ambient by the constant heat transfer, W/m2 of reference area.
    pub ambient_flow: Observation,
    /// Total heat flow out of the face opposite to the contact, W/m2 of reference area.
    pub base_flow: Observation,
    /// Largest relative error of the contact impedance on the resolved frequencies.
    pub error: f64,
}
