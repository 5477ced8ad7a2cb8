//! Stability of wear steps, and extreme bodies, each case with its required result.

use contact::wear::line::{CellRate, Conditions, WearingContact};
use contact::{ContactState, Normal, Tilt};
use elasticity::block::{Block, BlockProperties, Discretization};
use elasticity::{Base, Cells, Compliance, ElasticBody, Extent, HalfPlane, Material, Strip};
use nalgebra::DMatrix;
use verification::integrator::{Integrator, Scheme};
use verification::stability::Verdict;
use verification::stability::wear_step::{Method, Relaxation};

const LOAD: f64 = 2.0;

fn contact(cells: &Cells, normal: DMatrix<f64>, gap: Vec<f64>) -> WearingContact {
    let shear = DMatrix::zeros(cells.count(), cells.count());
    WearingContact::new(cells, cells.widths(), normal, shear, gap).unwrap()
}

fn conditions(rate: CellRate) -> Conditions {
    Conditions { signed_friction: 0.0, normal: Normal::Load(LOAD), tilt: Tilt::Fixed(0.0), rate }
}

fn layer(cells: &Cells, nu: f64, height: f64, base: Base) -> Compliance {
    Strip::new(Material::new(1.0, nu).unwrap(), height, base, Extent::Straight).unwrap().compliance(cells)
}

/// Steps of the default scheme under constant conditions; the state at the end.
fn steps(contact: &mut WearingContact, worn: &mut [f64], rate: &CellRate, step: f64, count: usize) -> ContactState {
    let mut state = ContactState::new(worn.len());
    let mut integrator = Integrator::new(Scheme::Sdirk2, worn.len());
    let constant = conditions(rate.clone());
    for _ in 0..count {
        integrator.step(contact, worn, 0.0, step, &mut |_, now| now.clone_from(&constant), &mut state).unwrap();
    }
    state
}

#[test]
fn explicit_steps_are_right_below_the_bound_and_refused_above_it_and_the_default_is_right_everywhere() {
    for count in [9, 33, 129] {
        let relaxation = Relaxation::new(count).unwrap();
        for ratio in [0.03, 0.8, 1.15, 40.0] {
            let run = |method| relaxation.run(method, ratio).unwrap();
            let (unguarded, error) = run(Method::Unguarded);
            let (explicit, _) = run(Method::Explicit);
            let (default, least) = run(Method::Default);
            let expected = if ratio < 1.0 { [Verdict::Right; 2] } else { [Verdict::Grows, Verdict::Refused] };
            assert_eq!([unguarded, explicit], expected, "N {count} step {ratio}");
            assert_eq!(default, Verdict::Right, "N {count} step {ratio}: {least:e}");
            assert!(least < error, "N {count} step {ratio}: {least:e} {error:e}");
        }
    }
}

#[test]
fn the_bound_is_the_same_by_theory_by_the_scheme_and_by_stepping() {
    let mut bounds = Vec::new();
    for count in [17, 33, 65] {
        let relaxation = Relaxation::new(count).unwrap();
        let (theory, measured) = (relaxation.bound(), relaxation.measured_bound().unwrap());
        let reported = relaxation.reported_bound().unwrap();
        assert!((reported / theory - 1.0).abs() < 1e-9, "N {count}: {reported:e} {theory:e}");
        assert!((measured / theory - 1.0).abs() < 5e-3, "N {count}: {measured:e} {theory:e}");
        bounds.push(theory);
    }
    // It goes with the width of the edge cells, like 1/N^2.
    let slope = (bounds[0] / bounds[2]).log2() / (65f64 / 17.0).log2();
    assert!((slope - 2.0).abs() < 0.05, "{slope}");
}

#[test]
fn a_nearly_incompressible_bonded_layer_is_squeezed_like_a_film() {
    // Thin layer, u = h p/M - h^3/(3 G) p'' (uniaxial compression, and squeezing out against the bonded base) with
    // p = 0 at the edges: p/mean = (1 - cosh(x/l)/cosh(a/l))/(1 - l/a tanh(a/l)), l^2 = h^2 M/(3 G). The layer beyond the
    // edges takes part over about its height, so the deviation falls with h. Cells must not be wider than the layer is high:
    // every jump of the pressure squeezes material out over that length.
    for nu in [0.4999, 0.499_999] {
        let material = Material::new(1.0, nu).unwrap();
        let mut deviations = Vec::new();
        for (height, count) in [(0.1, 33), (0.05, 65), (0.025, 129), (0.0125, 257)] {
            let cells = Cells::graded(1.0, count).unwrap();
            let length = height * (material.uniaxial_modulus() / (3.0 * material.shear_modulus())).sqrt();
            let mean = 1.0 - length * (1.0 / length).tanh();
            let film = |x: f64| (1.0 - (x / length).cosh() / (1.0 / length).cosh()) / mean;
            let normal = layer(&cells, nu, height, Base::Bonded).normal;
            let state = contact(&cells, normal, vec![0.0; count])
                .pressure(&vec![0.0; count], &conditions(CellRate::archard(1.0, 1.0)))
                .unwrap();
            assert!((cells.integral(&state.pressure) - LOAD).abs() < 1e-9);
            let inner = (0..count).filter(|i| cells.centres()[*i].abs() < 0.7);
            let error = inner.map(|i| (state.pressure[i] - film(cells.centres()[i])).abs()).fold(0.0, f64::max);
            deviations.push(error);
        }
        assert!(deviations[3] < 0.035, "nu {nu}: {deviations:?}");
        assert!(deviations.windows(2).all(|pair| pair[1] < 0.65 * pair[0]), "nu {nu}: {deviations:?}");
    }
}

#[test]
fn nearly_incompressible_bodies_do_not_lock() {
    // From nu = 0.4999 on nothing much changes, for layers and for the block; a layer of any height is the half-plane's
    // neighbour: softer than rigid, stiffer than the half-plane.
    let cells = Cells::graded(1.0, 33).unwrap();
    let pressure = |normal: DMatrix<f64>| {
        let conditions = conditions(CellRate::archard(1.0, 1.0));
        contact(&cells, normal, vec![0.0; 33]).pressure(&[0.0; 33], &conditions).unwrap().pressure
    };
    let block = |nu: f64| {
        let properties = BlockProperties { width: 2.0, height: 1.0, youngs_modulus: 1.0, poissons_ratio: nu };
        let discretization = Discretization::for_cells(2.0, 1.0, cells.edges(), 1e-4);
        Block::new(properties, discretization).unwrap().compliance(cells.edges()).unwrap().normal
    };
    let strip = |nu: f64| layer(&cells, nu, 1.0, Base::Bonded).normal;
    for (name, near, nearer) in
        [("strip", strip(0.4999), strip(0.499_999_9)), ("block", block(0.4999), block(0.499_999))]
    {
        let change = (&near - &nearer).amax() / near.amax();
        let (a, b) = (pressure(near), pressure(nearer));
        let moved = a.iter().zip(&b).map(|(a, b)| (a - b).abs() / a).fold(0.0, f64::max);
        assert!(change < 2e-3 && moved < 2e-3, "{name}: {change:e} {moved:e}");
    }
    let half_plane = HalfPlane { material: Material::new(1.0, 0.4999).unwrap() }.compliance(&cells).normal;
    // Both are defined up to a constant only: compare the work of a pressure of zero mean.
    let work = |matrix: &DMatrix<f64>| {
        let wave = nalgebra::DVector::from_iterator(33, cells.centres().iter().copied());
        let moved = matrix * &wave;
        (0..33).map(|i| cells.widths()[i] * wave[i] * moved[i]).sum::<f64>()
    };
    let (layered, endless) = (work(&strip(0.4999)), work(&half_plane));
    assert!(layered > 0.2 * endless && layered < endless, "{layered:e} {endless:e}");
}

#[test]
fn a_pad_a_hundred_times_wider_than_high_is_a_row_of_springs() {
    // Away from the edges by a few heights every point carries itself: p = M u/h, M the uniaxial modulus. A tilted start
    // wears off with k M/h.
    let (height, count) = (0.02, 33);
    let cells = Cells::graded(1.0, count).unwrap();
    let modulus = Material::new(1.0, 0.3).unwrap().uniaxial_modulus();
    let properties = BlockProperties { width: 2.0, height, youngs_modulus: 1.0, poissons_ratio: 0.3 };
    let discretization = Discretization::for_cells(2.0, height, cells.edges(), 1e-3);
    let pad = Block::new(properties, discretization).unwrap().compliance(cells.edges()).unwrap().normal;
    for (name, normal) in [("pad", pad), ("layer", layer(&cells, 0.3, height, Base::Bonded).normal)] {
        let rate = CellRate::archard(1.0, 1.0);
        let state = contact(&cells, normal.clone(), vec![0.0; count])
            .pressure(&vec![0.0; count], &conditions(rate.clone()))
            .unwrap();
        let middle = state.pressure[count / 2];
        for i in (0..count).filter(|i| cells.centres()[*i].abs() < 0.85) {
            let error = state.pressure[i] / middle - 1.0;
            assert!(error.abs() < 1e-3, "{name} x {}: {error:e}", cells.centres()[i]);
        }
        let springs = state.approach * modulus / height / middle - 1.0;
        assert!(springs.abs() < 2e-3, "{name}: approach off by {springs:e}");
        // The edges make up for at most a few heights.
        assert!((middle - 1.0).abs() < 3.0 * height, "{name}: {middle}");
        let gap: Vec<f64> = cells.centres().iter().map(|x| -0.3 * x * height / modulus).collect();
        let mut tilted = contact(&cells, normal, gap);
        let mut worn = vec![0.0; count];
        let end = steps(&mut tilted, &mut worn, &rate, height / modulus / 50.0, 50);
        let mut largest: f64 = 0.0;
        for (x, p) in cells.centres().iter().zip(&end.pressure).filter(|(x, _)| x.abs() < 0.7) {
            largest = largest.max((p - end.pressure[count / 2] - 0.3 * x * (-1f64).exp()).abs());
        }
        assert!(largest < 2e-3, "{name}: {largest:e}");
        assert!((cells.integral(&worn) / (LOAD * height / modulus) - 1.0).abs() < 1e-10, "{name}");
    }
}

#[test]
fn steps_hide_growth_beyond_the_curve_of_theory_and_the_default_never_does() {
    use verification::stability::growth_step::{Method, contact as waves, hidden_from, measured_hidden_from, run};
    let split = waves(8, Method::Split).unwrap();
    for (ratio, step, expected) in
        [(0.6, 0.05, Verdict::Right), (2.0, 0.01, Verdict::Right), (5.0, 0.5, Verdict::Inexact)]
    {
        let (verdict, error) = run(&split, Method::Split, ratio, step);
        assert_eq!(verdict, expected, "operator split {ratio} {step}: {error}");
    }
    let contact = waves(8, Method::Default).unwrap();
    for (ratio, step) in [(0.5, 0.1), (2.0, 0.05), (0.6, 3.0)] {
        for method in [Method::Unguarded, Method::Default] {
            let (verdict, error) = run(&contact, method, ratio, step);
            assert_eq!(verdict, Verdict::Right, "{method:?} {ratio} {step}: {error}");
        }
    }
    // Modes that decay within a step, and modes that shorter, faster growing ones would exceed in a longer run.
    let finer = waves(16, Method::Default).unwrap();
    for (ratio, step) in [(0.32, 6.0), (0.41, 10.0), (0.53, 6.0), (0.69, 10.0), (18.6, 0.1), (24.0, 0.25), (31.0, 0.06)]
    {
        let (verdict, error) = run(&finer, Method::Default, ratio, step);
        assert_eq!(verdict, Verdict::Right, "{ratio} {step}: {error}");
    }
    for step in [0.5, 2.0] {
        let bound = hidden_from(step);
        let measured = measured_hidden_from(&contact, step).unwrap();
        assert!((measured / bound - 1.0).abs() < 0.03, "{step}: {measured} {bound}");
        for factor in [0.8, 1.3] {
            let (verdict, error) = run(&contact, Method::Unguarded, factor * bound, step);
            assert_eq!(verdict == Verdict::Hides, factor > 1.0, "{step} {factor}: {verdict} {error}");
            let (verdict, error) = run(&contact, Method::Default, factor * bound, step);
            assert_eq!(verdict, Verdict::Right, "default {step} {factor}: {error}");
        }
    }
}

#[test]
fn wear_holds_waves_down_to_the_threshold_of_theory() {
    use exact::instability::critical_ratio;
    use verification::stability::wear_speed::{contact, growth, run};
    for wear in [0.5, 1.2] {
        let contact = contact(16, wear).unwrap();
        let critical = critical_ratio(wear);
        for factor in [0.9, 1.1] {
            let (verdict, error) = run(&contact, factor * critical).unwrap();
            assert!(verdict == Verdict::Right && error < 0.05, "{wear} {factor}: {verdict} {error}");
            let found = growth(&contact, factor * critical, 6.0).unwrap();
            assert_eq!(found.re > 0.0, factor > 1.0, "{wear} {factor}: {found}");
        }
    }
    // From w = 2 on a wave decays at every speed, faster than the spectrum does: without a rate of its own.
    let (verdict, error) = run(&contact(16, 2.0).unwrap(), 40.0).unwrap();
    assert!(verdict == Verdict::Right && error.is_nan(), "{verdict} {error}");
}

#[test]
fn the_default_follows_jumps_and_turning_waves_where_other_schemes_do_not() {
    use verification::stability::{Grid, peclet, reversal};
    let map = reversal::map(Grid::Coarse, &|_| {}).unwrap();
    for point in &map.panels[0].points {
        assert!(point.y < 10.0 || point.verdict == Verdict::Rings, "{point:?}");
    }
    assert!(map.panels[0].points.iter().any(|point| point.verdict == Verdict::Right), "short steps ring no more");
    assert!(map.panels[1].points.iter().all(|point| point.verdict == Verdict::Right), "{:?}", map.panels[1].points);
    let map = peclet::map(Grid::Coarse, &|_| {}).unwrap();
    for other in 0..2 {
        assert!(map.panels[other].points.iter().any(|point| point.verdict == Verdict::Inexact));
    }
    assert!(map.panels[2].points.iter().all(|point| point.verdict == Verdict::Right), "{:?}", map.panels[2].points);
    let [_, _, default] = peclet::errors(&peclet::DISC, 10.0, 0.1, 10).unwrap();
    assert!(default.iter().all(|error| *error < reversal::AGREEMENT), "{default:?}");
}

#[test]
fn the_heat_split_is_right_for_every_conductance_and_for_bodies_that_hardly_conduct() {
    use verification::stability::conductance::run;
    for (ratio, conductance) in
        [(0.02, 0.0), (0.02, 1e2), (0.02, 1e5), (0.02, 1e12), (1.0, 1e12), (1e-6, 1e12), (1e-8, 1e6), (0.0, 1e12)]
    {
        for step in [1e-3, 1.0] {
            let (verdict, error) = run(ratio, conductance, step);
            assert_eq!(verdict, Verdict::Right, "{ratio} {conductance} {step}: {error}");
        }
    }
}
