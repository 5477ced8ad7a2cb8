//! Thermal distortion of an active set in the steady state, from the heat partition of a stage.
//!
//! ```text
//! u_T = d_1 + d_2 + (D_1 - D_2) y + E_0 Q,    E_0 = (D_1 - D_2) Y + D_2 on the cells in contact
//! ```
//!
//! The time step holds E_0 of all cells and a low-rank update by few open ones ([`model::line::heat::partition`]); a steady state is
//! computed once, so that E_0 of its active set, whatever its size, may cost N^3.
//!
//! Theory: docs/theory.md, sections 6.2, 9.4.

use crate::SteadyError;
use conduction::line::contact_parts::ContactParts;
use conduction::line::{Step, SurfaceInfluence, ThermalBody};
use conduction::properties::Scales;
use elasticity::Cells;
use elasticity::discretization::punch_block;
use model::line::heat::bodies::Bodies;
use model::line::heat::partition::HeatPartition;
use nalgebra::DMatrix;
use scene::Scene;

/// Punch and strip; `None`: an insulator.
pub(super) type Heat = [Option<Box<dyn ThermalBody>>; 2];

/// Bodies of a scene in a step so much longer than the longest of their time constants that they respond to a flux with their steady
/// temperatures and distortion, to 1e-8; and their cooled lengths beside the contact, m.
pub(super) fn steady_bodies(scene: &Scene, cells: &Cells, velocity: f64) -> Result<(Heat, [f64; 2]), SteadyError> {
    let block = punch_block(scene, cells, true).map_err(|error| SteadyError::Heat(error.to_string()))?;
    let made = Bodies::new(scene, cells, block.as_deref(), &mut Default::default()).map_err(SteadyError::Heat)?;
    let mut bodies = made.prototypes.clone();
    let step = Step::new(1e8 * scene.nominal_duration, [velocity; 2]);
    bodies.iter_mut().flatten().for_each(|body| body.prepare(&step));
    Ok((bodies, made.cooled_length))
}

/// Corrections of a flux by its residual.
const CORRECTIONS: usize = 3;

/// Heat partition of an active set, with its distortion.
#[derive(Clone, Debug)]
pub(crate) struct ActivePartition {
    partition: HeatPartition,
    closed: Vec<bool>,
    /// 1/(2 h_c), K m2/W; `None`: the surfaces do not exchange heat.
    half_resistance: Option<f64>,
    /// E_0, m per W/m2; columns of open cells are 0.
    pub distortion: DMatrix<f64>,
}

impl ActivePartition {
    /// Heat partition between bodies of these influence matrices (`None`: an insulator), on `count` cells, with the
    /// contact conductance `conductance` (W/(m2 K)). No cell is in contact.
    pub(crate) fn new(influence: [Option<&SurfaceInfluence>; 2], count: usize, conductance: f64) -> ActivePartition {
        let mut partition = HeatPartition::new(&vec![1.0; count], conductance);
        partition.build((0.0, 0.0, [Scales::ONE; 2]), &ContactParts::whole(count), influence);
        ActivePartition {
            partition,
            closed: vec![false; count],
            half_resistance: (conductance > 0.0).then(|| 0.5 / conductance),
            distortion: DMatrix::zeros(count, count),
        }
    }

    /// Sets the cells in contact.
    pub(crate) fn set_active_set(&mut self, influence: [Option<&SurfaceInfluence>; 2], closed: &[bool]) {
        if self.closed == closed {
            return;
        }
        let count = closed.len();
        self.closed.copy_from_slice(closed);
        self.partition.set_active_set(closed);
        self.distortion.fill(0.0);
        let (mut unit, mut flux, still) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        for j in (0..count).filter(|&j| closed[j]) {
            match influence {
                [Some(_), Some(strip)] => {
                    unit[j] = 1.0;
                    self.punch_flux(influence, [&still, &still], &unit, &mut flux);
                    unit[j] = 0.0;
                    let mut column = self.distortion.column_mut(j);
                    column.copy_from(&strip.distortion.column(j));
                    self.partition.distort_relatively(&flux, column.as_mut_slice());
                }
                [Some(only), None] | [None, Some(only)] => {
                    self.distortion.column_mut(j).copy_from(&only.distortion.column(j));
                }
                [None, None] => {}
            }
        }
    }

    /// Flux into the punch, for the free response `base` (K) of both surfaces and the friction heat `friction` (W/m2), which is 0
    /// on open cells.
    pub(crate) fn punch_flux(
        &mut self,
        influence: [Option<&SurfaceInfluence>; 2],
        base: [&[f64]; 2],
        friction: &[f64],
        flux: &mut [f64],
    ) {
        flux.fill(0.0);
        match influence {
            [Some(punch), Some(strip)] => {
                self.partition.add_punch_flux_exactly(friction, flux);
                let Some(half_resistance) = self.half_resistance else { return };
                // The first correction adds the heat exchanged without friction; the others are iterative refinement, needed where
                // a body that loses hardly any heat has an influence matrix near to a singular one.
                let mut residual = vec![0.0; flux.len()];
                let mut strip_flux = vec![0.0; flux.len()];
                for _ in 0..CORRECTIONS {
                    for i in 0..flux.len() {
                        strip_flux[i] = flux[i] - friction[i];
                        residual[i] = base[1][i] - base[0][i] - half_resistance * (strip_flux[i] + flux[i]);
                    }
                    let fluxes = [(punch, &*flux), (strip, &strip_flux[..])];
                    for (body, flux) in fluxes {
                        for (column, q) in body.temperature.as_slice().chunks_exact(flux.len().max(1)).zip(flux) {
                            residual.iter_mut().zip(column).for_each(|(residual, entry)| *residual -= entry * q);
                        }
                    }
                    self.partition.exchange(&residual, flux);
                }
            }
            [Some(_), None] => flux.copy_from_slice(friction),
            [None, _] => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_laws_hold_on_the_cells_in_contact() {
        let count = 7;
        let influence = |scale: f64, skew: f64| SurfaceInfluence {
            temperature: DMatrix::from_fn(count, count, |i, j| {
                let distance = i as f64 - j as f64;
                scale * ((-0.7 * distance.abs()).exp() + if i == j { 0.1 } else { skew * distance.signum() })
            }),
            distortion: DMatrix::from_fn(count, count, |i, j| -scale * (1.0 + (i * j) as f64)),
        };
        let (punch, strip) = (influence(2.0, 0.0), influence(1.0, 0.05));
        let closed = [true, true, false, true, true, true, false];
        let few = [false, false, false, true, false, true, false];
        let base = [vec![3.0, 1.0, 9.0, 2.0, 0.0, -1.0, 5.0], vec![0.5; 7]];
        for (conductance, closed) in [(0.0, closed), (0.3, closed), (1e9, closed), (0.3, few)] {
            let influence = [Some(&punch), Some(&strip)];
            let mut partition = ActivePartition::new(influence, count, conductance);
            partition.set_active_set(influence, &closed);
            let heat: Vec<f64> = (0..count).map(|i| if closed[i] { 4.0 + i as f64 } else { 0.0 }).collect();
            let mut q1 = vec![0.0; count];
            partition.punch_flux(influence, [&base[0], &base[1]], &heat, &mut q1);
            let q2: Vec<f64> = (0..count).map(|i| if closed[i] { heat[i] - q1[i] } else { 0.0 }).collect();
            for i in 0..count {
                if !closed[i] {
                    assert_eq!(q1[i], 0.0);
                    continue;
                }
                let rise = |influence: &SurfaceInfluence, q: &[f64]| {
                    (0..count).map(|j| influence.temperature[(i, j)] * q[j]).sum::<f64>()
                };
                let jump = base[0][i] + rise(&punch, &q1) - base[1][i] - rise(&strip, &q2);
                let residual =
                    if conductance > 0.0 { jump - 0.5 * (q2[i] - q1[i]) / conductance } else { q2[i] - q1[i] };
                assert!(residual.abs() < 1e-11, "{conductance} {i}: {residual}");
            }
            // Distortion by the friction heat alone.
            let zero = vec![0.0; count];
            partition.punch_flux(influence, [&zero, &zero], &heat, &mut q1);
            for i in 0..count {
                let direct: f64 = (0..count)
                    .filter(|&j| closed[j])
                    .map(|j| punch.distortion[(i, j)] * q1[j] + strip.distortion[(i, j)] * (heat[j] - q1[j]))
                    .sum();
                let by_operator: f64 = (0..count).map(|j| partition.distortion[(i, j)] * heat[j]).sum();
                assert!((direct - by_operator).abs() < 1e-10 * direct.abs(), "{conductance} {i}");
            }
        }
    }
}
