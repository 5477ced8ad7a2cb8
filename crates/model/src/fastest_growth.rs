//! Upper bound of the growth rate of thermoelastic pressure waves.
//!
//! A wave of wave number m at rest in one body with the growth rate b has a temperature that decays into that body with
//! `lambda^2 = m^2 + b/kd`. The mate slides over it at the sliding speed V and has an impedance of at most
//! `Z = 1/(K' |m^2 - i m V/kd'|^(1/2))`. With the resistance rho = 1/h_c of the contact and `G = mu V alpha (1+nu) E*` (heat,
//! thermal lift and stiffness as in [`super::instability`])
//!
//! ```text
//! (lambda + m) [1 + K lambda (Z + rho)] = G m (Z + rho/2),    b = kd (lambda^2 - m^2)
//! ```
//!
//! is quadratic in lambda. The mate's own thermal lift is neglected: its phase differs by a quarter of a wave.
//!
//! # Short waves
//!
//! For `m -> infinity` the left side grows like `K m^2 (Z + rho)`, so waves shorter than some length decay at any speed. The rate
//! is bounded, and the instability is a well-posed problem without a smallest length:
//!
//! - insulating mate: `lambda (lambda + m) = G m/K`, fastest `0.0902 kd (G/K)^2` at `lambda/m = 1.618`;
//! - mate that absorbs all heat (Z = 0): nothing grows below `G = 4 h_c`, at any wave number; above, all waves longer than
//!   `2 pi K/(h_c (G/(4 h_c) - 1))` grow, none at a rate above the order of `kd (h_c/K)^2`.
//!
//! A step that is short against the fastest growth of the waves between the contact's width and its smallest cell is therefore
//! short enough for every wave of the mesh. Wear and friction that decreases with temperature only reduce growth.
//!
//! # Layers
//!
//! Where a layer is thinner than the wave, a body that is insulated at its base and smooth there absorbs less heat and has a
//! larger thermal lift relative to its stiffness: `1 + Y (Z + rho) >= y [1 + K lambda (Z + rho)]` with
//! `y = min(1, Y/(K lambda))`, and the ratio of lift to compliance is l times that of half-planes. G times the largest `l/y` over
//! all rates then bounds the growth from above; for layers stiffer than half-planes G is unchanged.
//!
//! Theory: docs/theory.md, section 7.5.

use super::instability::FarFaces;
use super::instability::layer::{FarFace, Layers, half_resistance};
use elasticity::kinds::plane_strain_compliance;
use nalgebra::Complex;
use numerics::maximum::maximum;
use scene::{Body, Geometry, Path, Scene};
use std::f64::consts::PI;

/// Decay into the body over the wave number at which layer and half-plane are compared: from the wave at rest in steps of this
/// ratio, and number of steps.
const DECAY_RATIO: f64 = 2.0;
const DECAYS: usize = 10;

/// Conducting body of the pair.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Conductor {
    /// K, W/(m K); rho c, J/(m3 K); alpha (1 + nu), 1/K.
    conductivity: f64,
    capacity: f64,
    expansion: f64,
}

impl Conductor {
    fn of(body: &Body) -> Conductor {
        Conductor {
            conductivity: body.conductivity,
            capacity: body.density * body.specific_heat,
            expansion: if body.conductivity > 0.0 { body.thermal_expansion * (1.0 + body.poissons_ratio) } else { 0.0 },
        }
    }

    /// Magnitude of the decay into the body, 1/m, of a wave that moves at `speed` m/s in its frame: `|m^2 - i m V/kd|^(1/2)`.
    fn decay(&self, wave: f64, speed: f64) -> f64 {
        (wave * wave).hypot(wave * speed * self.capacity / self.conductivity).sqrt()
    }
}

/// Two bodies as half-planes.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Pair {
    bodies: [Conductor; 2],
    /// E*, Pa.
    modulus: f64,
    /// 1/(2 h_c), K m2/W.
    half_resistance: f64,
}

impl Pair {
    fn of(scene: &Scene) -> Pair {
        Pair {
            bodies: [Conductor::of(&scene.punch), Conductor::of(&scene.strip)],
            modulus: 1.0 / (plane_strain_compliance(&scene.punch) + plane_strain_compliance(&scene.strip)),
            half_resistance: half_resistance(scene),
        }
    }

    /// Largest ratio l/y of layers to half-planes for waves at rest in this body, at least 1; `far`: far face of the strip.
    fn lift_of_layers(&self, scene: &Scene, body: usize, far: FarFace, wave: f64) -> f64 {
        let own = &self.bodies[body];
        if own.expansion == 0.0 || !self.modulus.is_finite() {
            return 1.0;
        }
        let layers = Layers::new(scene, far, wave);
        // Stiffness of the layers relative to half-planes.
        let stiffness = 2.0 / (self.modulus * wave) / layers.compliance();
        let mut largest: f64 = 1.0;
        let mut decay = wave;
        for _ in 0..DECAYS {
            let rate = own.conductivity / own.capacity * (decay * decay - wave * wave);
            let [uptake, lift] = layers.bodies[body].respond(Complex::from(rate));
            let lift = lift.re * (decay + wave) / (2.0 * own.expansion);
            let uptake = (uptake.re / (own.conductivity * decay)).min(1.0);
            largest = largest.max(lift * stiffness / uptake);
            decay *= DECAY_RATIO;
        }
        largest
    }
}

/// Pair of bodies and range of waves resolved by the cells.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct FastestGrowth {
    pair: Pair,
    /// Largest thermal lift of layers relative to half-planes for waves at rest in punch and strip, at the wave numbers of the
    /// search in ascending order, the largest one last.
    layers: [Vec<f64>; 2],
    /// Smallest and largest wave number, 1/m.
    range: [f64; 2],
    /// Fraction of the time for which waves at rest in punch and strip are heated; 0: there are none.
    heated: [f64; 2],
    /// Waves may also be at rest in neither body; then the mate is taken as an insulator, which is conservative.
    free: bool,
}

impl FastestGrowth {
    /// Growth bound for cells of which the smallest is `smallest` m wide.
    pub(crate) fn new(scene: &Scene, smallest: f64) -> FastestGrowth {
        Self::of_mode(scene, FarFaces::of(scene).own, smallest)
    }

    /// The same for the mode of the strip with this far face.
    pub(crate) fn of_mode(scene: &Scene, far: FarFace, smallest: f64) -> FastestGrowth {
        let width = match scene.geometry {
            Geometry::Periodic => 0.5 * scene.width,
            Geometry::Line => scene.width,
            Geometry::Annular => scene.width.max(scene.depth),
        };
        let (heated, free) = match (scene.geometry, scene.path) {
            (Geometry::Line, Path::Closed) => ([1.0, scene.coverage()], false),
            // Fresh material enters the contact.
            (Geometry::Line, Path::Straight) => ([1.0, 0.0], false),
            // The outer edge of an annulus has the largest sliding speed.
            (Geometry::Annular, _) => ([1.0 + 0.5 * scene.width / scene.mean_radius; 2], true),
            _ => ([1.0; 2], true),
        };
        let range = [PI / width, (PI / smallest).max(PI / width)];
        let pair = Pair::of(scene);
        let numbers = numbers(range);
        let layers =
            [0, 1].map(|body| numbers.clone().map(|wave| pair.lift_of_layers(scene, body, far, wave)).collect());
        FastestGrowth { pair, layers, range, heated, free }
    }

    /// Fastest growth rate (1/s) of all waves at this friction coefficient and sliding speed (m/s).
    pub(crate) fn fastest(&self, friction: f64, speed: f64) -> f64 {
        maximum(self.of_body(0, friction, speed), self.of_body(1, friction, speed))
    }

    /// Fastest growth rate (1/s) of the waves at rest in the punch (0) or strip (1) at this friction coefficient and sliding
    /// speed (m/s); 0: none grows.
    pub(crate) fn of_body(&self, body: usize, friction: f64, speed: f64) -> f64 {
        let (own, mate) = (&self.pair.bodies[body], &self.pair.bodies[1 - body]);
        if own.expansion == 0.0 || self.heated[body] == 0.0 {
            return 0.0;
        }
        let drive = self.heated[body] * friction * speed * own.expansion * self.pair.modulus;
        let waves = numbers(self.range).zip(&self.layers[body]);
        waves.map(|(wave, layer)| self.growth(own, mate, wave, drive * layer, speed)).fold(0.0, f64::max)
    }

    /// Growth rate b of one wave, 1/s, where it is positive.
    fn growth(&self, own: &Conductor, mate: &Conductor, wave: f64, drive: f64, speed: f64) -> f64 {
        let conductivity = own.conductivity;
        // Z + rho (`None`: the mate absorbs no heat), and Z + rho/2.
        let (resistance, part) = if self.free || mate.conductivity == 0.0 {
            (None, 1.0)
        } else {
            let uptake = mate.conductivity * mate.decay(wave, speed);
            let half = self.pair.half_resistance;
            (Some(uptake.recip() + 2.0 * half), uptake.recip() + half)
        };
        // K R lambda^2 + (s + K R m) lambda + s m - G m part = 0, s = 1 where the mate absorbs heat.
        let (square, own_share) = match resistance {
            Some(resistance) => (conductivity * resistance, 1.0),
            None => (conductivity, 0.0),
        };
        let linear = own_share + square * wave;
        let constant = own_share * wave - drive * wave * part;
        let root = linear * linear - 4.0 * square * constant;
        if root <= 0.0 {
            return 0.0;
        }
        let decay = (root.sqrt() - linear) / (2.0 * square);
        (conductivity / own.capacity * (decay * decay - wave * wave)).max(0.0)
    }
}

/// Wave numbers of the search.
fn numbers(range: [f64; 2]) -> impl Iterator<Item = f64> + Clone {
    // Ratio of successive wave numbers in the search: the maximum lies between two of them, at most a twentieth above their values.
    let below = std::iter::successors(Some(range[0]), |wave| Some(wave * 1.25));
    below.take_while(move |&wave| wave < range[1]).chain([range[1]])
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINING: Conductor = Conductor { conductivity: 1.2, capacity: 2600.0 * 1000.0, expansion: 15e-6 * 1.25 };
    const IRON: Conductor = Conductor { conductivity: 54.0, capacity: 7200.0 * 460.0, expansion: 11e-6 * 1.26 };
    const INSULATOR: Conductor = Conductor { conductivity: 0.0, capacity: 1e6, expansion: 0.0 };

    fn growth(mate: Conductor, conductance: f64, free: bool) -> FastestGrowth {
        let pair = Pair { bodies: [LINING, mate], modulus: 1.056e9, half_resistance: 0.5 / conductance };
        let range = [1.0, 1e7];
        let layers = [0, 1].map(|_| numbers(range).map(|_| 1.0).collect());
        FastestGrowth { pair, layers, range, heated: [1.0; 2], free }
    }

    #[test]
    fn on_an_insulator_it_has_the_closed_form() {
        for (friction, speed) in [(0.4, 0.3), (0.2, 10.0)] {
            let exact = {
                let drive = friction * speed * LINING.expansion * 1.056e9 / 1.2;
                0.0902 * 1.2 / LINING.capacity * drive * drive
            };
            // The search over discrete wave numbers underestimates the maximum slightly.
            let found = growth(INSULATOR, 20e3, false).of_body(0, friction, speed);
            assert!(found <= 1.001 * exact && found > 0.9 * exact, "{found} {exact}");
            assert_eq!(found, growth(IRON, 20e3, true).of_body(0, friction, speed));
        }
    }

    #[test]
    fn a_mate_that_takes_all_heat_lets_nothing_grow_below_a_speed_and_bounds_the_rate_above() {
        let conductance = 20e3;
        let mate = Conductor { conductivity: 1e9, ..IRON };
        let limit = |friction: f64| 4.0 * conductance / (friction * LINING.expansion * 1.056e9);
        let growth = growth(mate, conductance, false);
        for friction in [0.2, 0.4] {
            assert_eq!(growth.of_body(0, friction, 0.99 * limit(friction)), 0.0);
            let slightly = growth.of_body(0, friction, 1.05 * limit(friction));
            let twice = growth.of_body(0, friction, 2.0 * limit(friction));
            let unit = 1.2 / LINING.capacity * (conductance / 1.2_f64).powi(2);
            assert!(slightly > 0.0 && slightly < 1e-3 * unit, "{slightly} {unit}");
            // The largest y^2 (z^2 - 1) with (1 + y z)(1 + z) = 4 is 0.2236, at y = 0.56.
            assert!(twice / unit <= 0.2237 && twice / unit > 0.21, "{twice} {unit}");
        }
    }

    #[test]
    fn every_wave_found_solves_the_equation_of_the_critical_speed_where_it_neither_grows_nor_fades() {
        // At the speed at which the impedance of half-planes is mu V the rate changes its sign, except for the mate's thermal
        // lift.
        let mate = Conductor { expansion: 0.0, ..IRON };
        let pair = Pair { bodies: [LINING, mate], modulus: 1.056e9, half_resistance: 25e-6 };
        let layers = [vec![1.0], vec![1.0]];
        let growth = FastestGrowth { pair, layers, range: [800.0, 800.0], heated: [1.0; 2], free: false };
        let (mut low, mut high) = (1.0, 100.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if growth.of_body(0, 0.4, middle) > 0.0 { high = middle } else { low = middle }
        }
        let wave = 800.0;
        let own = Complex::from(wave) * 1.2;
        let other = Complex::new(wave * wave, wave * high * mate.capacity / 54.0).sqrt() * 54.0;
        let warm = other * 25e-6 + 1.0;
        let heat = own * warm + other * (own * 25e-6 + 1.0);
        let exact = (heat / (warm * LINING.expansion / (2.0 * wave) * 1.056e9 * wave)).re / 0.4;
        assert!((high / exact - 1.0).abs() < 0.02, "{high} {exact}");
    }
}
