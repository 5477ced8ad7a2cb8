//! The critical speed against closed forms, published values and finite differences through the depth.

use super::layer::{FarFace, Layers};
use super::waves::{Motion, least};
use super::*;
use elasticity::Base;
use nalgebra::{Complex, DMatrix, DVector};
use scene::variables::{STARTS, reference};

/// K, rho c, alpha, nu, E.
type Material = [f64; 5];
const STEEL: Material = [55.0, 7800.0 * 460.0, 1.1e-5, 0.3, 2.1e11];
const LINING: Material = [1.2, 2600.0 * 1000.0, 15e-6, 0.25, 1e9];
const INSULATOR: Material = [0.0, 1e6, 0.0, 0.25, 1e9];
/// Cast iron and a friction material as in studies of disc brakes after Lee and Barber (1993).
const IRON: Material = [54.0, 54.0 / 12.98e-6, 12e-6, 0.25, 125e9];
const PAD: Material = [0.5, 0.5 / 0.269e-6, 10e-6, 0.25, 0.53e9];

/// Layers of these heights (m) in ideal thermal contact on a closed path, insulated at their far faces.
fn scene(bodies: [(Material, f64); 2]) -> Scene {
    let mut values = STARTS;
    let mut set = |name: &str, value: f64| values[reference(name) as usize] = value;
    for (name, (material, height)) in ["punch", "strip"].into_iter().zip(bodies) {
        let [conductivity, capacity, expansion, nu, e] = material;
        set(&format!("{name}.height"), height);
        set(&format!("{name}.conductivity"), conductivity);
        set(&format!("{name}.density"), 1000.0);
        set(&format!("{name}.specific_heat"), capacity / 1000.0);
        set(&format!("{name}.thermal_expansion"), expansion);
        set(&format!("{name}.poissons_ratio"), nu);
        set(&format!("{name}.youngs_modulus"), e);
        set(&format!("{name}.body"), 4.0);
    }
    set("punch.top_thermal", 3.0);
    set("strip.base_thermal", 3.0);
    set("contact.conductance", 1e12);
    set("contact.friction_coefficient", 0.4);
    Scene::new(&values, None).unwrap()
}

fn layers(bodies: [(Material, f64); 2], far: FarFace, wave: f64) -> Layers {
    Layers::new(&scene(bodies), far, wave)
}

const BONDED: FarFace = FarFace::Held(Base::Bonded);

fn least_free(layers: &Layers, speed: f64) -> f64 {
    [false, true].map(|swapped| least(layers, Motion::Free(swapped), speed)).into_iter().fold(f64::INFINITY, f64::min)
}

/// Critical speed of a free wave of these layers, m/s, by bisection.
fn critical(layers: &Layers, friction: f64) -> f64 {
    let (mut low, mut high) = (1e-3_f64, 1e5_f64);
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        if least_free(layers, middle) > friction * middle { low = middle } else { high = middle }
    }
    high
}

fn modulus(bodies: [Material; 2]) -> f64 {
    1.0 / bodies.map(|[_, _, _, nu, e]| (1.0 - nu * nu) / e).iter().sum::<f64>()
}

#[test]
fn a_thick_conductor_on_an_insulator_has_the_closed_form_of_half_planes() {
    let exact = 2.0 * 55.0 * 50.0 / (1.1e-5 * 1.3 * modulus([STEEL, INSULATOR]));
    for bodies in [[(STEEL, 1.0), (INSULATOR, 1.0)], [(INSULATOR, 1.0), (STEEL, 1.0)]] {
        for speed in [1e-4, 1.0, 1e3] {
            let found = least_free(&layers(bodies, BONDED, 50.0), speed);
            assert!((found - exact).abs() < 1e-9 * exact, "{speed}: {found} against {exact}");
        }
    }
}

#[test]
fn the_imaginary_part_vanishes_and_the_pair_can_be_turned_round() {
    for speed in [1e-3, 0.1, 3.0, 40.0] {
        let one = least_free(&layers([(STEEL, 1.0), (LINING, 1.0)], BONDED, 50.0), speed);
        let other = least_free(&layers([(LINING, 1.0), (STEEL, 1.0)], BONDED, 50.0), speed);
        assert!((one - other).abs() < 1e-4 * one, "{speed}: {one} against {other}");
        if speed < 1.0 {
            continue;
        }
        // The lining over which the wave moves absorbs heat, so the pair is more stable than steel on an insulator.
        let alone = least_free(&layers([(STEEL, 1.0), (INSULATOR, 1.0)], BONDED, 50.0), speed);
        assert!(one > alone * 3.0, "{speed}: {one} against {alone}");
    }
}

#[test]
fn alike_bodies_share_the_wave_or_one_keeps_it() {
    // By symmetry a wave at half the speed always has zero phase.
    let wave = layers([(STEEL, 1.0), (STEEL, 1.0)], BONDED, 50.0);
    let slow = least_free(&wave, 1e-6);
    let at_rest = 2.0 * 2.0 * 55.0 * 50.0 / (2.0 * 1.1e-5 * 1.3 * modulus([STEEL, STEEL]));
    assert!((slow - at_rest).abs() < 1e-3 * at_rest, "{slow} against {at_rest}");
    assert!(least_free(&wave, 10.0).is_finite());
}

/// A disc of 11 mm between two pads at mu = 0.4: unstable from 8.9 m/s at 80 1/m, twenty times below half-planes.
#[test]
fn a_disc_between_two_pads_has_the_published_speeds() {
    let disc = |height: f64, far: FarFace| critical(&layers([(PAD, 1.0), (IRON, height)], far, 80.0), 0.4);
    let bending = disc(0.0055, FarFace::Antisymmetric);
    assert!((bending / 8.91 - 1.0).abs() < 2e-3, "{bending}");
    let half_planes = disc(1.0, FarFace::Symmetric);
    assert!((half_planes / 178.5 - 1.0).abs() < 2e-3, "{half_planes}");
    for far in [BONDED, FarFace::Held(Base::Smooth), FarFace::Antisymmetric] {
        assert!((disc(1.0, far) / half_planes - 1.0).abs() < 1e-9, "{far:?}");
    }
    // A thin disc is more stable than half-planes for symmetric waves, and an order of magnitude less stable for antisymmetric
    // ones.
    let symmetric = disc(0.0055, FarFace::Symmetric);
    assert!(symmetric > half_planes && bending < 0.1 * half_planes, "{bending} {half_planes} {symmetric}");
}

/// A layer on a smooth base between rigid bodies that absorb no heat, for waves much longer than its height, is the slab of
/// uniform temperature: `mu V = K q^2 h (1 - nu)/(E alpha)`.
#[test]
fn long_waves_in_an_insulated_slab_have_the_closed_form() {
    let rigid = [0.0, 1e6, 0.0, 0.25, 1e21];
    for height in [1e-2, 1e-3, 1e-4] {
        let wave = 0.1;
        let found = least_free(&layers([(rigid, 0.01), (STEEL, height)], FarFace::Symmetric, wave), 1.0);
        let exact = 55.0 * wave * wave * height * 0.7 / (2.1e11 * 1.1e-5);
        assert!((found / exact - 1.0).abs() < 1e-5, "{height}: {found} {exact}");
    }
}

/// Conduction through the depth by finite volumes graded from the surface, with its effect on the surface: rows of the system
/// dT/dt = M T in the body's own frame.
struct Column {
    /// Centres and widths of the volumes, m.
    at: Vec<f64>,
    width: Vec<f64>,
}

impl Column {
    fn new(height: f64, first: f64, count: usize) -> Column {
        // Geometric grading: first (r^n - 1)/(r - 1) = height.
        let (mut low, mut high) = (1.0 + 1e-9, 10.0);
        for _ in 0..200 {
            let r: f64 = 0.5 * (low + high);
            if first * (r.powi(count as i32) - 1.0) / (r - 1.0) < height { low = r } else { high = r }
        }
        let width: Vec<f64> = (0..count).map(|k| first * low.powi(k as i32)).collect();
        let mut edge = 0.0;
        let centre = |width: &f64| {
            edge += width;
            edge - 0.5 * width
        };
        let at = width.iter().map(centre).collect();
        Column { at, width }
    }
}

/// Largest growth rate (1/s) of a wave of wave number `q` at the sliding speed `speed`, in the frame of the strip, by eigenvalues
/// of finite volumes. `dilatation` is the bracket of the two bodies, `held`: the temperature of the far face is fixed.
fn growth_by_volumes(
    materials: [Material; 2],
    columns: &[Column; 2],
    dilatation: [&dyn Fn(f64) -> f64; 2],
    held: [bool; 2],
    (compliance, q, drive, speed): (f64, f64, f64, f64),
) -> f64 {
    let counts = columns.each_ref().map(|column| column.at.len());
    let total = counts[0] + counts[1];
    let mut matrix = DMatrix::<Complex<f64>>::zeros(total, total);
    // Pressure by unit temperatures; the surface temperature is common to both bodies, with a half volume on either side.
    let mut pressure = DVector::<f64>::zeros(total);
    let mut conductance = [0.0; 2];
    for body in 0..2 {
        let [conductivity, capacity, expansion, nu, _] = materials[body];
        let (column, offset) = (&columns[body], if body == 0 { 0 } else { counts[0] });
        let last = counts[body] - 1;
        for k in 0..=last {
            let width = column.width[k];
            pressure[offset + k] = 2.0 * (1.0 + nu) * expansion * dilatation[body](column.at[k]) * width / compliance;
            let own = Complex::new(-conductivity / capacity * q * q, if body == 0 { q * speed } else { 0.0 });
            matrix[(offset + k, offset + k)] += own;
            if k < last {
                let between = conductivity / (column.at[k + 1] - column.at[k]);
                let next = column.width[k + 1];
                for (row, col, value) in [
                    (k, k, -between / width),
                    (k, k + 1, between / width),
                    (k + 1, k + 1, -between / next),
                    (k + 1, k, between / next),
                ] {
                    matrix[(offset + row, offset + col)] += Complex::from(value / capacity);
                }
            } else if held[body] {
                matrix[(offset + k, offset + k)] -= Complex::from(conductivity / (0.5 * width * width * capacity));
            }
        }
        conductance[body] = conductivity / (0.5 * column.width[0]);
    }
    // Ts = (g1 T1 + g2 T2 + heat)/(g1 + g2), heat = drive p.
    let sum = conductance[0] + conductance[1];
    let first = [0, counts[0]];
    for body in 0..2 {
        let scale = conductance[body] / (columns[body].width[0] * materials[body][1]);
        matrix[(first[body], first[body])] -= Complex::from(scale);
        for other in 0..2 {
            matrix[(first[body], first[other])] += Complex::from(scale * conductance[other] / sum);
        }
        for k in 0..total {
            matrix[(first[body], k)] += Complex::from(scale * drive * pressure[k] / sum);
        }
    }
    // Eigenvalues nearest to shifts along the imaginary axis.
    let mut largest = f64::NEG_INFINITY;
    for exponent in -8..6 {
        for sign in [-1.0, 1.0] {
            let shift = Complex::new(0.05, sign * 2f64.powi(exponent));
            let factors = (&matrix - DMatrix::identity(total, total) * shift).lu();
            let mut vector = DVector::from_element(total, Complex::from(1.0));
            let mut eigenvalue = shift;
            for _ in 0..30 {
                let next = factors.solve(&vector).unwrap();
                eigenvalue = shift + vector.dotc(&vector) / vector.dotc(&next);
                vector = &next / Complex::from(next.norm());
            }
            let residual = (&matrix * &vector - &vector * eigenvalue).norm();
            if residual < 1e-6 * (1.0 + eigenvalue.norm()) {
                largest = largest.max(eigenvalue.re);
            }
        }
    }
    largest
}

/// Two conductors, one a bending layer, by finite volumes: growth changes its sign at the critical speed of the impedance.
#[test]
fn finite_volumes_grow_from_the_critical_speed_on() {
    let (q, friction, height) = (80.0, 0.4, 0.0055);
    let pair = layers([(PAD, 1.0), (IRON, height)], FarFace::Antisymmetric, q);
    let speed = critical(&pair, friction);
    let u = q * height;
    let half_plane = |z: f64| (-q * z).exp();
    let bent = |z: f64| 2.0 * u.cosh() * (u - q * z).sinh() / ((2.0 * u).sinh() - 2.0 * u);
    // The pad's skin is 27 micrometres deep.
    let columns = [Column::new(0.1, 1e-6, 50), Column::new(height, 4e-5, 40)];
    let rate = |ratio: f64| {
        let numbers = (pair.compliance(), q, friction * ratio * speed, ratio * speed);
        growth_by_volumes([PAD, IRON], &columns, [&half_plane, &bent], [false, true], numbers)
    };
    let [below, above] = [0.97, 1.03].map(rate);
    assert!(below < 0.0 && above > 0.0, "{below} {above}");
    // The remainder at the critical speed is the discretisation error of the finite volumes.
    assert!(rate(1.0).abs() < 0.2 * above, "{} {above}", rate(1.0));
}

#[test]
fn half_a_wave_fits_a_guided_punch_and_a_whole_one_a_punch_that_turns() {
    let mut thick = scene([(INSULATOR, 1.0), (STEEL, 1.0)]);
    thick.faces = 1.0;
    let exact = |length: f64| {
        let m = 2.0 * std::f64::consts::PI / length;
        2.0 * 55.0 * m / (0.4 * 1.1e-5 * 1.3 * modulus([STEEL, INSULATOR])) / thick.coverage()
    };
    let guided = CriticalSpeed::new(&thick).at(0.4);
    assert!((guided / exact(2.0 * thick.width) - 1.0).abs() < 1e-9, "{guided}");
    let mut turning = thick.clone();
    turning.constraint = scene::Constraint::TranslateAndRotate;
    let turning = CriticalSpeed::new(&turning).at(0.4);
    assert!((turning / exact(thick.width) - 1.0).abs() < 1e-9, "{turning}");
}

/// The minimum over all waves lies between those of the search, and the waves of the other face are not included in the modelled
/// ones.
#[test]
fn two_faces_add_the_waves_that_bend_the_strip() {
    let mut ring = scene([(PAD, 1.0), (IRON, 0.0055)]);
    ring.geometry = scene::Geometry::Periodic;
    ring.width = 0.7383;
    (ring.length, ring.faces, ring.smooth_base) = (ring.width, 1.0, true);
    let one = CriticalSpeed::new(&ring);
    assert_eq!(one.at(0.4), one.modelled(0.4));
    ring.faces = 2.0;
    let two = CriticalSpeed::new(&ring);
    assert_eq!(two.modelled(0.4), one.modelled(0.4));
    assert!(two.at(0.4) < 0.5 * one.at(0.4), "{} {}", two.at(0.4), one.at(0.4));
    let number = |n: usize| 2.0 * std::f64::consts::PI * n as f64 / ring.width;
    let exact = (1..=60)
        .map(|n| critical(&Layers::new(&ring, FarFace::Antisymmetric, number(n)), 0.4))
        .fold(f64::INFINITY, f64::min);
    assert!((two.at(0.4) / exact - 1.0).abs() < 5e-3, "{} {exact}", two.at(0.4));
    assert!(two.stable_speed(0.4) <= two.modelled(0.4));
    // A convecting base is not a mid plane.
    ring.strip.far_thermal = scene::ThermalBoundary::Convecting;
    let open = CriticalSpeed::new(&ring);
    assert_eq!(open.at(0.4), open.modelled(0.4));
}

#[test]
fn nothing_grows_where_nothing_is_lifted_or_gives_way() {
    let cold = |material: Material| [material[0], material[1], 0.0, material[3], material[4]];
    for bodies in [[(cold(PAD), 0.01), (cold(IRON), 0.01)], [(INSULATOR, 0.01), (cold(IRON), 0.01)]] {
        let found = CriticalSpeed::new(&scene(bodies));
        assert_eq!((found.at(0.4), found.modelled(0.4)), (0.0, 0.0));
        assert_eq!(found.stable_speed(0.4), f64::INFINITY);
    }
    let mut rigid = scene([(PAD, 0.01), (IRON, 0.01)]);
    rigid.punch.mechanical = scene::MechanicalBody::Rigid;
    rigid.strip.mechanical = scene::MechanicalBody::Rigid;
    assert_eq!(CriticalSpeed::new(&rigid).at(0.4), 0.0);
    let some = CriticalSpeed::new(&scene([(PAD, 0.01), (IRON, 0.01)]));
    assert_eq!(some.at(0.0), 0.0);
    for friction in [1e-6, 1e-3, 0.4, 10.0, 1e3] {
        assert!(some.at(friction).is_finite() && some.at(friction) > 0.0, "{friction}");
    }
}

#[test]
fn the_table_is_accurate_where_another_wave_takes_over_or_begins() {
    let mut numbers = test_support::Random(12345);
    let mut random = || numbers.next();
    for number in 0..45 {
        let mut starts = scene::variables::STARTS;
        let mut set = |name: &str, value: f64| starts[scene::variables::find(name).unwrap() as usize] = value;
        set("punch.conductivity", 10f64.powf(2.0 * random()));
        set("strip.conductivity", 10f64.powf(0.5 + 1.5 * random()));
        set("contact.conductance", 10f64.powf(3.0 + 3.0 * random()));
        set("strip.height", 10f64.powf(-3.0 + 2.0 * random()));
        set("punch.height", 10f64.powf(-3.0 + 1.5 * random()));
        set("contact.faces", f64::from(1 + number % 2));
        let friction = [0.1, 0.3, 0.6][random().mul_add(3.0, 0.0) as usize];
        set("contact.friction_coefficient", friction);
        match number % 3 {
            0 => {}
            1 => {
                set("contact.geometry", 3.0);
                set("punch.width", 0.3);
                set("strip.length", 0.3);
                set("contact.mean_radius", 0.0);
            }
            _ => {
                set("contact.geometry", 2.0);
                set("punch.width", 0.02);
            }
        }
        let scene = Scene::new(&starts, None).unwrap();
        let found = CriticalSpeed::new(&scene).at(friction);
        // By bisection over all waves, from a speed at which none grows.
        let families = Families::of(&scene);
        let grows = |speed: f64| families.least(speed, None).all < friction * speed;
        let (mut low, mut high) = (0.5 * found, 2.0 * found);
        assert!(!grows(low), "{number}: grows at {low} m/s, {found} m/s from the table");
        if !grows(high) {
            // Growing waves may be stable again at a higher speed: the lower one counts.
            assert!(grows(1.01 * found), "{number}: {found} m/s from the table");
            high = 1.01 * found;
        }
        for _ in 0..20 {
            let middle = (low * high).sqrt();
            *(if grows(middle) { &mut high } else { &mut low }) = middle;
        }
        assert!((found / low - 1.0).abs() < 5e-3, "{number}: {found} m/s from the table, {low} m/s");
    }
}

/// First speed (m/s) at which `mu V = Re Z` for a wave of wave number `m` between half-planes, at rest in body `rest` and heated for
/// this part of the time, by scanning; `None`: none up to 1e12 m/s. Written out here, without layers and tables.
fn scanned(scene: &Scene, friction: f64, m: f64, (rest, part): (usize, f64)) -> Option<f64> {
    let bodies = [&scene.punch, &scene.strip];
    let r = 0.5 / scene.conductance;
    let excess = |speed: f64| {
        let mut own = [[Complex::from(0.0); 2]; 2];
        for (side, body) in bodies.into_iter().enumerate() {
            let moving = if side == rest { 0.0 } else { speed };
            let diffusivity = body.conductivity / (body.density * body.specific_heat);
            let decay = Complex::new(m * m, m * moving / diffusivity).sqrt();
            let lift = (decay + m).inv() * (2.0 * body.thermal_expansion * (1.0 + body.poissons_ratio));
            own[side] = [decay * body.conductivity, lift];
        }
        let [[y1, l1], [y2, l2]] = own;
        let compliance: f64 =
            bodies.iter().map(|body| 2.0 * (1.0 - body.poissons_ratio.powi(2)) / (body.youngs_modulus * m)).sum();
        let (warm, other) = (y2 * r + 1.0, y1 * r + 1.0);
        let z = ((y1 * warm + y2 * other) / (l1 * warm + l2 * other)).re * compliance / part;
        if z > 0.0 { friction * speed - z } else { -1.0 }
    };
    let at = |k: usize| 10f64.powf(k as f64 / 200.0 - 6.0);
    let first = (0..=3600).find(|&k| excess(at(k)) >= 0.0)?;
    let (mut low, mut high) = (at(first.saturating_sub(1)), at(first));
    for _ in 0..40 {
        let middle = (low * high).sqrt();
        *(if excess(middle) >= 0.0 { &mut high } else { &mut low }) = middle;
    }
    Some(high)
}

#[test]
fn over_a_sweep_of_pairs_the_speed_is_that_of_half_planes_or_0_and_always_finite() {
    let (mut count, mut none, mut failed) = (0, 0, Vec::new());
    for expansions in [[1e-7, 1.86e-5], [1.86e-5, 1e-7], [1e-6, 1.2e-5], [1.1e-5, 1.1e-5], [0.0, 1.86e-5]] {
        for conductivities in [[0.3, 55.0], [1.2, 200.0], [55.0, 55.0], [200.0, 1.2]] {
            for conductance in [1e3, 1e6, 1e11] {
                for (path, modulus) in [(1.0, 2e11), (2.0, 2e11), (1.0, 1e9), (2.0, 1e9)] {
                    let mut starts = STARTS;
                    let mut set = |name: &str, value: f64| starts[reference(name) as usize] = value;
                    for (side, name) in ["punch", "strip"].into_iter().enumerate() {
                        set(&format!("{name}.thermal_expansion"), expansions[side]);
                        set(&format!("{name}.conductivity"), conductivities[side]);
                        set(&format!("{name}.youngs_modulus"), modulus);
                        set(&format!("{name}.height"), 1.0);
                        set(&format!("{name}.body"), 4.0);
                    }
                    set("contact.conductance", conductance);
                    set("contact.faces", 1.0);
                    set("strip.path", path);
                    let scene = Scene::new(&starts, None).unwrap();
                    let table = CriticalSpeed::new(&scene);
                    for friction in [0.15, 0.4, 0.6, 1.0] {
                        let m = std::f64::consts::PI / scene.width;
                        let motions = [(0, 1.0), (1, scene.coverage())];
                        let motions = &motions[..if path == 2.0 { 2 } else { 1 }];
                        let exact = motions.iter().filter_map(|&motion| scanned(&scene, friction, m, motion));
                        let exact = exact.fold(f64::INFINITY, f64::min);
                        let found = table.at(friction);
                        count += 1;
                        none += usize::from(found == 0.0);
                        let agrees = if exact.is_finite() { (found / exact - 1.0).abs() < 0.01 } else { found == 0.0 };
                        if !agrees {
                            failed.push(format!(
                                "{expansions:?} {conductivities:?} {conductance:e} {path} {modulus:e} {friction}: {found:e}, exact {exact:e}"
                            ));
                        }
                    }
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} of {count}:\n{}", failed.len(), failed.join("\n"));
    assert!(none < count / 10, "{none} of {count} have none");
}
