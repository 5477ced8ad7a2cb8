//! Steady states as minima of their functionals over the whole set of admissible pressures.

use contact::Tilt;
use contact::wear::law::PressureLaw;
use contact::wear::line::{CellRate, Coefficient, WearTerm};
use elasticity::{Base, Cells, Compliance, ElasticBody, Extent, Material, Rigid, Strip};
use nalgebra::{DMatrix, DVector};
use steady::{BoxProgramme, ReciprocatingProblem, punch_run_in};
use test_support::Random;

const COUNT: usize = 33;

struct Noise(Random);

impl Noise {
    /// Uniform from -1/2 to 1/2.
    fn next(&mut self) -> f64 {
        self.0.between(-0.5, 0.5)
    }

    /// A random point between the bounds that satisfies the constraints: the one nearest to a random target, in a random
    /// measure, so that random bounds are active.
    fn admissible(&mut self, programme: &BoxProgramme) -> DVector<f64> {
        let count = programme.linear.len();
        let random = BoxProgramme {
            quadratic: DMatrix::from_diagonal(&DVector::from_fn(count, |_, _| 1.0 + self.next())),
            linear: DVector::from_fn(count, |_, _| 6.0 * self.next()),
            ..programme.clone()
        };
        random.solve().unwrap().values
    }
}

fn layer(cells: &Cells) -> Compliance {
    let material = Material::new(0.91, 0.3).unwrap();
    Strip::new(material, 0.8, Base::Bonded, Extent::Straight).unwrap().compliance(cells)
}

#[test]
fn no_pair_that_wears_evenly_has_less_strain_energy_than_the_cycle() {
    let cells = Cells::graded(1.0, COUNT).unwrap();
    let (punch, strip) = (Rigid.compliance(&cells), layer(&cells));
    let mut noise = Noise(Random(11));
    for pivot_height in [None, Some(1.0)] {
        let problem = |friction| ReciprocatingProblem {
            cells: &cells,
            punch: &punch,
            strip: &strip,
            friction,
            load: 2.0,
            pivot_height,
            wear_per_stroke: 0.0,
        };
        let cycle = problem(0.3).solve().unwrap();
        let programme = problem(0.3).programme().unwrap();
        let energy = |d: &DVector<f64>| 0.5 * (&programme.quadratic * d).dot(d) + programme.linear.dot(d);
        let difference = |pressure: &[f64]| DVector::from_iterator(COUNT, pressure.iter().map(|p| p - 1.0));
        let least = difference(&cycle.forward);
        let scale = energy(&DVector::from_fn(COUNT, |i, _| cells.centres()[i])).abs();
        assert!((energy(&least) - cycle.energy).abs() < 1e-12 * scale);
        // A solution that is not the minimum: one of a stronger shear coupling, moved to this moment.
        let wrong = BoxProgramme { linear: &programme.linear * 1.5, ..programme.clone() }.solve().unwrap().values;
        let (mut beaten, mut distance) = (0, 0.0f64);
        for _ in 0..1000 {
            let target = noise.admissible(&programme);
            assert!((programme.constraints.transpose() * &target - &programme.right).amax() < 1e-10);
            let share = (noise.next() + 0.5).powi(4);
            let other = &least + (&target - &least) * share;
            distance = distance.max((&other - &least).amax());
            assert!(energy(&other) >= cycle.energy - 1e-12 * scale, "{:e}", energy(&other) - cycle.energy);
            // The same perturbations find a better pair than the wrong one, towards the right one.
            let mixed = &wrong + (&least + (&target - &least) * 1e-3 - &wrong) * share;
            beaten += usize::from(energy(&mixed) < energy(&wrong));
        }
        assert!(distance > 1.0 && beaten > 100, "{pivot_height:?}: {distance} {beaten}");
    }
}

#[test]
fn no_pressure_in_balance_dissipates_less_by_wear_than_the_run_in_one() {
    let cells = Cells::graded(1.0, COUNT).unwrap();
    let (x, w) = (cells.centres(), cells.widths());
    let mut noise = Noise(Random(5));
    for exponent in [0.3, 0.5, 1.0, 2.0, 3.0] {
        // A speed that differs from cell to cell, as on an annulus, and a lever beyond a third: part of it is empty.
        let law = |exponent: f64| CellRate {
            reference_pressure: 1.0,
            terms: vec![WearTerm {
                coefficient: Coefficient::PerCell(x.iter().map(|x| 1.0 + 0.4 * x).collect()),
                law: PressureLaw::power(exponent),
            }],
        };
        let rate = law(exponent);
        let run_in = |exponent| punch_run_in(&cells, w, &law(exponent), 2.0, Tilt::ResultantAt(0.4)).unwrap();
        let state = run_in(exponent);
        let power = |p: &DVector<f64>| (0..COUNT).map(|i| w[i] * p[i] * rate.rate(i, p[i])).sum::<f64>();
        let pressure = DVector::from_column_slice(&state.pressure);
        assert!((power(&pressure) / state.dissipation - 1.0).abs() < 1e-13);
        // The larger b, the more tilt the lever takes.
        assert!(pressure.min() == 0.0 || exponent < 1.0, "b {exponent}");
        let admissible = BoxProgramme {
            quadratic: DMatrix::identity(COUNT, COUNT),
            linear: DVector::zeros(COUNT),
            constraints: DMatrix::from_fn(COUNT, 2, |i, k| if k == 0 { w[i] } else { w[i] * x[i] }),
            right: DVector::from_vec(vec![2.0, 0.8]),
            lower: DVector::zeros(COUNT),
            upper: DVector::repeat(COUNT, 6.0),
        };
        for _ in 0..1000 {
            let share = (noise.next() + 0.5).powi(4);
            let other = &pressure + (noise.admissible(&admissible) - &pressure) * share;
            // Rounding may leave -1e-16 on an empty cell.
            let other = other.map(|p| p.max(0.0));
            assert!(power(&other) >= state.dissipation * (1.0 - 1e-12), "b {exponent}");
        }
        // The pressure of another law is in balance too, and is beaten.
        let wrong = DVector::from_vec(run_in(if exponent > 1.0 { 1.0 } else { 2.0 * exponent }).pressure);
        assert!(power(&wrong) > state.dissipation * (1.0 + 1e-4), "b {exponent}");
    }
}
