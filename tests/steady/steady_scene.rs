//! Steady states of scenes: every kind against its own equations on the contact, and refusals.

use contact::wear::rocking::rocking_limit;
use contact::{ContactSolver, Normal, Tilt, pair_compliance};
use elasticity::discretization::{cells_for, compliances, load_weights};
use elasticity::{Cells, Compliance};
use exact::annular_pressure;
use nalgebra::DVector;
use scene::Scene;
use steady::SteadyError;
use steady::relative_velocity::{ElasticVelocity, assess};
use steady::states::{Sliding, SteadyKind, SteadyState, run_in_shape, steady_state};
use test_support::{changed_scene, initial_gap};

/// The reciprocating punch, of 60 mm under 10 kN over 3 mm, with changes.
fn scene(changes: &[(&str, f64)]) -> Scene {
    changed_scene(&test_support::scene("reciprocating_punch"), changes)
}

struct Solved {
    scene: Scene,
    cells: Cells,
    bodies: [Compliance; 2],
    state: SteadyState,
}

fn solve_as(changes: &[(&str, f64)], sliding: Option<Sliding>) -> Result<Solved, SteadyError> {
    let scene = scene(changes);
    let cells = cells_for(&scene, 33).unwrap();
    let bodies = compliances(&scene, &cells).unwrap();
    let sliding = sliding.unwrap_or(Sliding::nominal(&scene));
    let state = steady_state(&scene, &cells, &bodies, &sliding)?;
    Ok(Solved { scene, cells, bodies, state })
}

fn solve(changes: &[(&str, f64)]) -> Solved {
    solve_as(changes, None).unwrap_or_else(|error| panic!("{changes:?}: {error}"))
}

impl Solved {
    fn mean(&self) -> f64 {
        self.scene.nominal_load / (self.scene.width * self.scene.depth)
    }

    /// The shape, put into the contact, must give every stroke's pressure, approach and tilt.
    fn check_equilibrium(&self) {
        let weights = load_weights(&self.scene, &self.cells);
        let gap: Vec<f64> = self.state.shape.iter().zip(&self.state.groove).map(|(s, g)| s + g).collect();
        for stroke in &self.state.strokes {
            let matrix = pair_compliance(&self.bodies[0], &self.bodies[1], stroke.friction);
            let rotates = self.scene.constraint == scene::Constraint::TranslateAndRotate;
            let tilt =
                if rotates { Tilt::ResultantAt(stroke.friction * self.scene.pivot_height) } else { Tilt::Fixed(0.0) };
            let mut solver = ContactSolver::with_weights(&self.cells, &weights, matrix).unwrap();
            let load = Normal::Load(self.scene.nominal_load / (self.scene.count * self.scene.depth));
            let found = solver.solve(&gap, load, tilt).unwrap();
            for (p, expected) in found.pressure.iter().zip(&stroke.pressure) {
                assert!((p - expected).abs() < 1e-8 * self.mean(), "{p} {expected}");
            }
            assert!((found.approach - stroke.approach).abs() < 1e-9 * found.approach.abs(), "{}", found.approach);
            assert!((found.tilt - stroke.tilt).abs() < 1e-9 * (found.tilt.abs() + 1e-6), "{}", found.tilt);
        }
    }

    /// Depth worn by the punch in a cycle must be a rigid motion: its second differences over x vanish.
    fn check_even_wear(&self) {
        let depth: Vec<f64> = (0..self.cells.count())
            .map(|i| self.state.strokes.iter().map(|s| s.duration * s.wear_rates[0][i]).sum())
            .collect();
        let x = self.cells.centres();
        let n = x.len();
        let slope = (depth[n - 1] - depth[0]) / (x[n - 1] - x[0]);
        for i in 0..n {
            let rigid = depth[0] + slope * (x[i] - x[0]);
            assert!((depth[i] / rigid - 1.0).abs() < 1e-9, "cell {i}: {} {rigid}", depth[i]);
        }
    }
}

#[test]
fn reciprocating_punch_unloads_one_edge_and_doubles_the_other() {
    for holder in [1.0, 2.0] {
        let solved = solve(&[("holder.constraint", holder), ("holder.pivot_height", 0.05)]);
        let (mean, strokes) = (solved.mean(), &solved.state.strokes);
        assert_eq!((solved.state.kind, strokes.len()), (SteadyKind::RunIn, 2));
        for stroke in strokes {
            let (least, most) =
                (stroke.pressure[0].min(stroke.pressure[32]), stroke.pressure[0].max(stroke.pressure[32]));
            assert!(least < 1e-12 * mean && (most / mean - 2.0).abs() < 1e-9, "{least} {most}");
        }
        // Both the bending of the block and the pivot load the leading edge.
        assert!(strokes[0].pressure[32] > strokes[0].pressure[0]);
        solved.check_equilibrium();
        solved.check_even_wear();
        // Depth rate k pm v, volume rate times the area, powers k pm^2 v-ish and mu F v.
        let rate = 3.9e-14 * mean * 9.549e-3;
        assert!((solved.state.punch_wear_rate / rate - 1.0).abs() < 1e-10);
        assert!((solved.state.volume_rates[0] / (rate * 6e-4) - 1.0).abs() < 1e-10);
        assert_eq!(solved.state.volume_rates[1], 0.0);
        assert!((solved.state.friction_power / (0.25 * 10e3 * 9.549e-3) - 1.0).abs() < 1e-10);
        let uniform = 3.9e-14 * mean * mean * 9.549e-3 * 6e-4;
        assert!(solved.state.dissipation_power > uniform && solved.state.dissipation_power < 2.0 * uniform);
        assert_eq!(strokes[1].tilt - strokes[0].tilt != 0.0, holder == 2.0);
    }
}

#[test]
fn every_exponent_body_and_pair_of_strokes_wears_evenly_in_equilibrium() {
    for exponent in [0.3, 0.6, 1.0, 1.7, 3.0] {
        for (punch, strip) in [(4.0, 4.0), (1.0, 3.0), (2.0, 4.0), (4.0, 1.0), (3.0, 3.0), (2.0, 2.0)] {
            for (holder, height) in [(1.0, 0.0), (2.0, 0.03)] {
                let changes = [
                    ("punch.wear_pressure_exponent", exponent),
                    ("punch.wear_velocity_exponent", 0.7),
                    ("punch.body", punch),
                    ("strip.body", strip),
                    ("holder.constraint", holder),
                    ("holder.pivot_height", height),
                    ("contact.static_friction_ratio", 1.5),
                    ("contact.stribeck_velocity", 0.02),
                ];
                for sliding in [
                    None,
                    Some(Sliding::Reciprocating { strokes: [3e-3, 3e-3], speeds: [0.01, 0.03] }),
                    Some(Sliding::Reciprocating { strokes: [3e-3, 2e-3], speeds: [0.01, 0.01] }),
                ] {
                    let solved = solve_as(&changes, sliding).unwrap_or_else(|e| panic!("{changes:?} {sliding:?}: {e}"));
                    solved.check_equilibrium();
                    solved.check_even_wear();
                }
            }
        }
    }
}

#[test]
fn unidirectional_shapes_make_room_for_the_groove_of_a_strip_that_wears_too() {
    let unidirectional = ("nominal.stroke", 0.0);
    for velocity in [0.01, -0.01] {
        let sliding = Some(Sliding::Unidirectional { velocity });
        // So much wear that the groove is half of the elastic displacement.
        let both = [unidirectional, ("*.wear_coefficient", 1e-11)];
        let solved = solve_as(&both, sliding).unwrap();
        assert!(solved.state.strokes[0].pressure.iter().all(|p| (p / solved.mean() - 1.0).abs() < 1e-12));
        // The groove grows evenly from the leading edge: k pm times the distance from it.
        let leading = if velocity > 0.0 { 0.03 } else { -0.03 };
        for (x, depth) in solved.cells.centres().iter().zip(&solved.state.groove) {
            assert!((depth - 1e-11 * solved.mean() * (leading - x).abs()).abs() < 1e-18, "{x}: {depth:e}");
        }
        solved.check_equilibrium();
        solved.check_even_wear();
        // Only the strip: elastic punch, pressure falls off from the leading to the trailing edge.
        let only = [unidirectional, ("strip.wear_coefficient", 1e-11), ("punch.wear_coefficient", 0.0)];
        let solved = solve_as(&only, sliding).unwrap();
        assert_eq!(solved.state.kind, SteadyKind::Groove);
        solved.check_equilibrium();
        let groove = &solved.state.groove;
        assert!(if velocity > 0.0 { groove[0] > groove[32] } else { groove[32] > groove[0] });
        // The worn volume leaving at the trailing edge per time equals the wear rate of the strip.
        let left_behind = groove.iter().copied().fold(0.0, f64::max) * 0.01 * 0.01;
        assert!((left_behind / solved.state.volume_rates[1] - 1.0).abs() < 0.02, "{left_behind:e}");
        // Above a threshold between the pressures at both edges.
        let threshold = 1.5e7;
        let solved = solve_as(&[&only[..], &[("strip.wear_threshold", threshold)]].concat(), sliding).unwrap();
        assert_eq!(solved.state.kind, SteadyKind::Groove);
        solved.check_equilibrium();
        let (pressure, x, widths) = (&solved.state.strokes[0].pressure, solved.cells.centres(), solved.cells.widths());
        assert!(pressure.iter().any(|p| *p < threshold) && pressure.iter().any(|p| *p > 1.1 * threshold));
        for i in 0..33 {
            let share = |j: usize| match (x[j] - x[i]) * velocity {
                0.0 => 0.5,
                ahead => f64::from(u8::from(ahead > 0.0)),
            };
            let depth: f64 = (0..33).map(|j| share(j) * widths[j] * 1e-11 * (pressure[j] - threshold).max(0.0)).sum();
            assert!((depth - solved.state.groove[i]).abs() < 1e-9 * groove[16], "{i}: {depth:e}");
        }
    }
    let lifting = solve(&[unidirectional, ("holder.constraint", 2.0), ("holder.pivot_height", 0.06)]);
    // mu H = a/2 is beyond a third of the half-width: part of the contact lifts off.
    assert!(lifting.state.strokes[0].pressure[0] == 0.0);
    lifting.check_equilibrium();
}

#[test]
fn closed_paths_wear_evenly_and_leave_the_pressure_to_the_punch() {
    let closed = [("strip.path", 2.0), ("strip.length", 0.4), ("strip.wear_coefficient", 1e-13)];
    for stroke in [0.0, 3e-3] {
        let with = |changes: &[(&'static str, f64)]| {
            let all = closed.iter().copied().chain([("nominal.stroke", stroke)]).chain(changes.iter().copied());
            solve(&all.collect::<Vec<_>>())
        };
        let both = with(&[]);
        let punch_alone = with(&[("strip.wear_coefficient", 0.0)]);
        assert_eq!(both.state.strokes[0].pressure, punch_alone.state.strokes[0].pressure);
        assert!((both.state.volume_rates[1] / both.state.volume_rates[0] - 1e-13 / 3.9e-14).abs() < 1e-9);
        both.check_equilibrium();
        let strip_alone = with(&[("punch.wear_coefficient", 0.0)]);
        assert_eq!(strip_alone.state.kind, SteadyKind::Elastic);
        assert!(strip_alone.state.shape.iter().all(|w| *w == 0.0));
        assert!(strip_alone.state.strokes[0].pressure.iter().any(|p| *p > 2.0 * strip_alone.mean()));
        strip_alone.check_equilibrium();
        assert_eq!(
            run_in_shape(&strip_alone.scene, &strip_alone.cells, &strip_alone.bodies),
            Err(SteadyError::OnlyStripWears)
        );
        assert_eq!(run_in_shape(&both.scene, &both.cells, &both.bodies), Ok(both.state.shape.clone()));
    }
}

#[test]
fn annular_contact_wears_as_a_power_of_the_radius() {
    let ring = [
        ("contact.geometry", 2.0),
        ("strip.path", 2.0),
        ("contact.mean_radius", 0.1175),
        ("punch.width", 0.055),
        ("depth", 0.1),
        ("nominal.stroke", 0.0),
        ("punch.wear_velocity_exponent", 1.0),
    ];
    for (a, b) in [(1.0, 1.0), (2.0, 1.0), (1.0, 0.5), (0.5, 1.5)] {
        let law = [("punch.wear_velocity_exponent", a), ("punch.wear_pressure_exponent", b)];
        let changes: Vec<_> = ring.iter().chain(&law).copied().collect();
        let solved = solve(&changes);
        for (x, p) in solved.cells.centres().iter().zip(&solved.state.strokes[0].pressure) {
            let exact = annular_pressure(0.1175 + x, 10e3 / 0.1, (0.09, 0.145), (a, b));
            assert!((p / exact - 1.0).abs() < 1e-3, "a {a} b {b} x {x}: {}", p / exact - 1.0);
        }
        solved.check_equilibrium();
        // A strip with the same law wears on its own as well, in the same frame.
        let only_strip = [
            ("punch.wear_coefficient", 0.0),
            ("strip.wear_coefficient", 1e-13),
            ("strip.wear_velocity_exponent", a),
            ("strip.wear_pressure_exponent", b),
        ];
        let strip = solve(&changes.iter().chain(&only_strip).copied().collect::<Vec<_>>());
        for (p, q) in strip.state.strokes[0].pressure.iter().zip(&solved.state.strokes[0].pressure) {
            assert!((p / q - 1.0).abs() < 1e-10);
        }
    }
}

#[test]
fn the_initial_shape_counts_where_the_punch_does_not_wear() {
    let closed = [
        ("strip.path", 2.0),
        ("strip.length", 0.4),
        ("strip.wear_coefficient", 1e-13),
        ("punch.wear_coefficient", 0.0),
        ("contact.initial_shape", 2.0),
        ("contact.initial_radius", 10.0),
    ];
    let solved = solve(&closed);
    for (i, x) in solved.cells.centres().iter().enumerate() {
        let mean = (x * x + solved.cells.widths()[i].powi(2) / 12.0) / 20.0;
        assert!((solved.state.shape[i] - mean).abs() < 1e-18);
    }
    solved.check_equilibrium();
    // The same shape as a table: linear between 33 stations.
    let gap = initial_gap(|x| (0.06 * x).powi(2) / 20.0);
    let tabulated = solve(&closed.into_iter().chain([("contact.initial_shape", 4.0)]).chain(gap).collect::<Vec<_>>());
    for (a, b) in tabulated.state.shape.iter().zip(&solved.state.shape) {
        // A chord over 1.875 mm is at most h^2/(8 R) above the parabola.
        assert!(a - b > -1e-12 && a - b < 1.875e-3f64.powi(2) / 80.0, "{a} {b}");
    }
}

#[test]
fn states_that_do_not_exist_are_refused_with_the_numbers() {
    let refuse = |changes: &[(&str, f64)]| solve_as(changes, None).err().expect("no such state").to_string();
    let holder = ("holder.constraint", 2.0);
    let text = refuse(&[holder, ("holder.pivot_height", 0.061)]);
    assert!(text.contains("increases the tilt without bound, mu H = 0.01525 m is not below 0.015 m"), "{text}");
    let text = refuse(&[holder, ("holder.pivot_height", 0.068), ("punch.wear_pressure_exponent", 0.5)]);
    assert!(text.contains("mu H = 0.017 m is not below 0.0165"), "{text}");
    let text = refuse(&[("strip.wear_coefficient", 1e-14)]);
    assert!(text.contains("strip wears on a straight reciprocating track"), "{text}");
    // A stroke of the width of the punch, and one of twice of it.
    assert!(text.contains("no part of the track has one"), "{text}");
    let text = refuse(&[("strip.wear_coefficient", 1e-14), ("nominal.stroke", 0.15)]);
    assert!(text.contains("the middle 0.09 m"), "{text}");
    assert!(refuse(&[("punch.wear_coefficient", 0.0)]).contains("no wear reshapes the contact"));
    let threshold = [("punch.wear_threshold", 1e6), ("strip.wear_threshold", 2e6)];
    let text = refuse(&threshold);
    assert!(text.contains("no run-in state with punch.wear_threshold: it is known for wear by a power"), "{text}");
    let annular =
        [("contact.geometry", 2.0), ("contact.mean_radius", 0.1), ("strip.path", 2.0), ("nominal.stroke", 0.0)];
    let text = refuse(&[&annular[..], &threshold[1..], &[("strip.wear_coefficient", 1e-14)]].concat());
    assert!(text.contains("no run-in state with strip.wear_threshold"), "{text}");
    assert!(refuse(&[("nominal.load", 0.0)]).contains("nominal.load = 0 is out of range"));
    assert!(refuse(&[("nominal.velocity", 0.0)]).contains("sliding speed = 0 is out of range"));
    assert!(refuse(&[("*.body", 1.0)]).contains("two rigid bodies"));
}

#[test]
fn levers_up_to_which_a_punch_does_not_rock_itself_round() {
    // For b < 1 the limit lies between a/2 and the bound of force, moment and even wear, by the bodies' elasticity.
    for exponent in [0.3, 0.5, 0.8, 1.0, 2.0] {
        for (punch, strip) in [(4.0, 4.0), (1.0, 3.0), (2.0, 1.0)] {
            let exists = |relative: f64| {
                let height = relative * 0.03 / 0.25;
                let changes = [
                    ("holder.constraint", 2.0),
                    ("holder.pivot_height", height),
                    ("punch.wear_pressure_exponent", exponent),
                    ("punch.body", punch),
                    ("strip.body", strip),
                ];
                solve_as(&changes, None).is_ok()
            };
            let (mut low, mut high) = (0.3, rocking_limit(exponent));
            assert!(exists(low) && !exists(high), "b {exponent}");
            for _ in 0..12 {
                let middle = 0.5 * (low + high);
                *(if exists(middle) { &mut low } else { &mut high }) = middle;
            }
            // The middle cell, whose two pressures have no lever, takes the more of it the larger b.
            assert!(low > 0.95 * rocking_limit(exponent), "b {exponent}: {low}");
        }
    }
}

#[test]
fn sums_of_a_state_are_those_of_its_strokes() {
    let solved = solve_as(
        &[("punch.wear_velocity_exponent", 0.5), ("contact.faces", 2.0), ("wear_acceleration", 7.0)],
        Some(Sliding::Reciprocating { strokes: [4e-3, 2e-3], speeds: [0.02, 0.02] }),
    )
    .unwrap();
    let [to, fro] = [&solved.state.strokes[0], &solved.state.strokes[1]];
    assert!((to.duration - 0.2).abs() < 1e-15 && (fro.duration - 0.1).abs() < 1e-15);
    let depth = |p: f64| 7.0 * 3.9e-14 * p * 0.02f64.sqrt();
    let volume = |stroke: &steady::states::SteadyStroke| {
        let worn = DVector::from_iterator(33, stroke.pressure.iter().map(|&p| depth(p)));
        solved.cells.integral(worn.as_slice()) * 0.01 * 2.0 * stroke.duration / 0.3
    };
    assert!(((volume(to) + volume(fro)) / solved.state.volume_rates[0] - 1.0).abs() < 1e-10);
}

fn elastic_velocity(solved: &Solved) -> ElasticVelocity {
    assess(&solved.scene, &solved.cells, &solved.bodies, &solved.state).unwrap().elastic.unwrap()
}

#[test]
fn a_rigid_punch_on_a_half_plane_stretches_it_by_the_closed_form() {
    // Unidirectional, run in: p = pm, shear mu pm. u_x' = -(1-2nu)/(2G) pm - (1-nu)/(pi G) mu pm ln((a+x)/(a-x)).
    let solved = solve(&[("punch.body", 1.0), ("strip.body", 3.0), ("nominal.stroke", 0.0)]);
    let elastic = elastic_velocity(&solved);
    let (nu, g, mean) = (0.3, 200e9 / 2.6, solved.mean());
    for (i, x) in solved.cells.centres().iter().enumerate().filter(|(_, x)| x.abs() < 0.027) {
        let logarithm = ((0.03 + x) / (0.03 - x)).ln();
        let exact = -mean / g * (0.5 * (1.0 - 2.0 * nu) + (1.0 - nu) / std::f64::consts::PI * 0.25 * logarithm);
        // Differences of cell means, next to the logarithm's singularity at the edges.
        assert!((elastic.strain[0][i] - exact).abs() < 0.01 * mean / g, "{x}: {:e} {exact:e}", elastic.strain[0][i]);
    }
    // The wear of a run-in punch is a rigid motion: the pressure stays, and nothing turns over.
    assert!(elastic.within_stroke < 1e-20 && elastic.reversal == 0.0 && elastic.pivot == 0.0);
    let wear = assess(&solved.scene, &solved.cells, &solved.bodies, &solved.state).unwrap().wear;
    assert!((wear / (3.9e-14 * mean) - 1.0).abs() < 1e-12);
}

#[test]
fn a_reversal_turns_the_shear_over() {
    // Incompressible half-plane: no shear coupling, p+ = p- = pm, and the shear +-mu pm moves the surface by the mean
    // 3 W/(pi E*) of the approach's own constant.
    let solved = solve(&[("punch.body", 1.0), ("strip.body", 3.0), ("strip.poissons_ratio", 0.4999999)]);
    let plane = 200e9 / 0.75;
    let exact = 2.0 * 0.25 * solved.mean() * 3.0 * 0.06 / (std::f64::consts::PI * plane) / 3e-3;
    assert!((elastic_velocity(&solved).reversal / exact - 1.0).abs() < 1e-4);
    // A slender block sways like a beam under the friction force and the moment of its pressure, by bending and shear,
    // and a reversal turns twice that over.
    let solved = solve(&[("punch.height", 0.3), ("strip.body", 1.0)]);
    let force = 0.25 * solved.mean() * 0.06;
    let moment = solved.cells.moment(&solved.state.strokes[0].pressure);
    let stiffness: f64 = 200e9 / 0.91 * 0.06f64.powi(3) / 12.0;
    let bending = (force * 0.3f64.powi(3) / 3.0 - moment * 0.3f64.powi(2) / 2.0) / stiffness;
    let sway = bending + force * 0.3 / (5.0 / 6.0 * 200e9 / 2.6 * 0.06);
    let found = elastic_velocity(&solved).reversal;
    assert!((found / (2.0 * sway / 3e-3) - 1.0).abs() < 0.02, "{found} {}", 2.0 * sway / 3e-3);
}

#[test]
fn wear_within_a_stroke_moves_the_pressure_of_a_winkler_foundation() {
    // Force and moment balance: p+- = pm (1 +- 3 mu H x/a^2) on independent springs while below 2 pm.
    let solved = solve(&[
        ("punch.body", 1.0),
        ("strip.body", 2.0),
        ("strip.foundation_stiffness", 1e12),
        ("holder.constraint", 2.0),
        ("holder.pivot_height", 0.02),
    ]);
    let elastic = elastic_velocity(&solved);
    // d = 3 mu H P x/(2 a^3), the whole of it worn like a rigid rotation: no change within the stroke.
    let jump = 2.0 * 1.5 * 0.25 * 0.02 * (10e3 / 0.01) / 0.03f64.powi(3) / 1e12;
    assert!((elastic.pivot / (0.02 * jump / 3e-3) - 1.0).abs() < 3e-3, "{}", elastic.pivot);
    assert!(elastic.normal_within_stroke < 1e-6 * 3.9e-14 * solved.mean());
    // Springs do not move along x.
    assert_eq!((elastic.reversal, elastic.mean_strain, elastic.within_stroke), (0.0, 0.0, 0.0));
    // A punch of the second power wears unevenly within a stroke, and the springs take up what differs.
    let solved = solve(&[
        ("punch.body", 1.0),
        ("strip.body", 2.0),
        ("strip.foundation_stiffness", 1e12),
        ("punch.wear_pressure_exponent", 2.0),
        ("holder.constraint", 2.0),
        ("holder.pivot_height", 0.02),
    ]);
    assert!(elastic_velocity(&solved).normal_within_stroke > 1e-3 * 3.9e-14 * solved.mean());
}
