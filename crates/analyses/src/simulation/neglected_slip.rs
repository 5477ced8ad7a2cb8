//! Slip that a run counts although elastic displacement takes it, where `contact.tangential_compliance` = neglected.

use super::quantity::{Shown, number};
use super::run::Recording;
use elasticity::tangential::tangential_stiffness;
use scene::Scene;
use serde_json::{Value, json};

/// Part of the tolerance up to which it is not stated.
const LEAST_STATED: f64 = 0.1;

/// Slip lost at the reversals of a run.
#[derive(Clone, PartialEq, Debug)]
pub struct NeglectedSlip {
    /// Number of reversals.
    pub reversals: usize,
    /// Elastic displacement of the faces against each other at all of them, m: friction force before and after over the stiffness.
    pub lost: f64,
    /// The same over the sliding distance.
    pub share: f64,
}

impl NeglectedSlip {
    /// Of the run, where it is above a tenth of the tolerance.
    pub(super) fn of(scene: &Scene, recording: &Recording) -> Option<NeglectedSlip> {
        if scene.elastic_slip {
            return None;
        }
        let velocity = recording.values("sliding_velocity").iter().zip(recording.values("angular_velocity"));
        let sliding = velocity.map(|(along, around)| along + scene.mean_radius * around);
        let moving = sliding.zip(recording.values("friction_force")).filter(|(velocity, _)| *velocity != 0.0);
        let moving: Vec<(f64, f64)> = moving.map(|(velocity, force)| (velocity, force.abs())).collect();
        let reversals = moving.windows(2).filter(|pair| pair[0].0 * pair[1].0 < 0.0).map(|pair| pair[0].1 + pair[1].1);
        let (reversals, force) = reversals.fold((0, 0.0), |(count, sum), both| (count + 1, sum + both));
        let distance = recording.values("sliding_distance").last().copied().unwrap_or_default();
        if reversals == 0 || distance == 0.0 {
            return None;
        }
        let lost = force / tangential_stiffness(scene);
        let share = lost / distance;
        (share > LEAST_STATED * scene.tolerance).then_some(NeglectedSlip { reversals, lost, share })
    }

    /// As JSON, SI units.
    pub(super) fn record(&self) -> Value {
        json!({ "reversals": self.reversals, "lost": self.lost, "part_of_distance": self.share })
    }

    pub(super) fn text(&self) -> String {
        let each = self.lost / self.reversals as f64;
        format!(
            "{} % of the sliding distance: {} before the bodies slide at each of {}; \
             contact.tangential_compliance = elastic includes it",
            number(100.0 * self.share),
            Shown::of_difference("m", each).text(each),
            counted(self.reversals, "reversal")
        )
    }
}

pub(super) fn counted(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}
