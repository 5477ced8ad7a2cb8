//! Heat partition of both stages of a lumped step.
//!
//! Theory: docs/theory.md, sections 6.8, 2.4.

use super::stage::{Matrix, Pair, apply, inverse, product, sum};

/// Contact temperature of a body at both stages under the contact's stage fluxes q into it: `level + gain q`.
#[derive(Clone, Copy)]
pub(crate) struct Response {
    /// Without these fluxes, K above the reference.
    pub level: Pair,
    /// K m2/W.
    pub gain: Matrix,
}

impl Response {
    /// Temperature under the fluxes `into`, K above the reference.
    #[inline(always)]
    pub(crate) fn at(&self, into: Pair) -> Pair {
        sum(self.level, apply(&self.gain, into))
    }
}

/// Linear map from the friction heats of both stages to the fluxes and the contact temperatures.
#[derive(Clone, Copy)]
pub(super) struct StageHeatPartition {
    /// Punch and strip.
    contact: [Response; 2],
    conducts: [bool; 2],
    /// Fluxes into the punch for the friction heats h: `level + gain h`.
    into_punch: Response,
    half_resistance: f64,
}

impl StageHeatPartition {
    /// Map for punch and strip with these responses.
    #[inline(always)]
    pub(crate) fn new(contact: [Response; 2], conducts: [bool; 2], half_resistance: f64, closed: bool) -> Self {
        let [punch, strip] = &contact;
        let share = |part: f64| Response { level: [0.0; 2], gain: [[part, 0.0], [0.0, part]] };
        let into_punch = match conducts {
            [true, true] if closed && half_resistance > 0.0 => {
                let with = |gain: &Matrix, own: f64| [[gain[0][0] + own, gain[0][1]], [gain[1][0], gain[1][1] + own]];
                let both = [sum(punch.gain[0], strip.gain[0]), sum(punch.gain[1], strip.gain[1])];
                let exchange = inverse(&with(&both, 2.0 * half_resistance));
                let above = [strip.level[0] - punch.level[0], strip.level[1] - punch.level[1]];
                let gain = product(&exchange, &with(&strip.gain, half_resistance));
                Response { level: apply(&exchange, above), gain }
            }
            [true, true] => share(0.5),
            [true, false] => share(1.0),
            [false, _] => share(0.0),
        };
        StageHeatPartition { contact, conducts, into_punch, half_resistance }
    }

    /// Fluxes into punch and strip at both stages for the friction heats `heat`.
    #[inline(always)]
    pub(crate) fn fluxes(&self, heat: Pair) -> [Pair; 2] {
        self.both(self.into_punch.at(heat), heat)
    }

    #[inline(always)]
    fn both(&self, punch: Pair, heat: Pair) -> [Pair; 2] {
        [punch, if self.conducts[1] { [heat[0] - punch[0], heat[1] - punch[1]] } else { [0.0; 2] }]
    }

    /// Contact temperatures at both stages without friction heat, K above the reference, and their gain from it, K m2/W.
    #[inline(always)]
    pub(crate) fn temperature_by_heat(&self) -> Response {
        let Response { level, gain } = self.into_punch;
        let mean = |[punch, strip]: [Pair; 2]| [0.5 * (punch[0] + strip[0]), 0.5 * (punch[1] + strip[1])];
        let mut alone = *self;
        (alone.contact[0].level, alone.contact[1].level) = ([0.0; 2], [0.0; 2]);
        let column = |punch: Pair, heat: Pair| mean(alone.surfaces(&alone.both(punch, heat)));
        let (first, last) =
            (column([gain[0][0], gain[1][0]], [1.0, 0.0]), column([gain[0][1], gain[1][1]], [0.0, 1.0]));
        Response {
            level: mean(self.surfaces(&self.both(level, [0.0; 2]))),
            gain: [[first[0], last[0]], [first[1], last[1]]],
        }
    }

    /// Temperatures of punch and strip at both stages under these fluxes, K above the reference.
    #[inline(always)]
    pub(crate) fn surfaces(&self, [punch, strip]: &[Pair; 2]) -> [Pair; 2] {
        let of = [self.contact[0].at(*punch), self.contact[1].at(*strip)];
        let stage = |i: usize| self.beside_insulator([of[0][i], of[1][i]], [punch[i], strip[i]]);
        let (first, last) = (stage(0), stage(1));
        [[first[0], last[0]], [first[1], last[1]]]
    }

    /// Surface temperature of an insulator: that of the other surface and the jump across the contact resistance.
    #[inline(always)]
    pub(crate) fn beside_insulator(&self, [punch, strip]: [f64; 2], into: [f64; 2]) -> [f64; 2] {
        match self.conducts {
            [true, false] => [punch, punch + self.half_resistance * into[0]],
            [false, true] => [strip + self.half_resistance * into[1], strip],
            _ => [punch, strip],
        }
    }
}
