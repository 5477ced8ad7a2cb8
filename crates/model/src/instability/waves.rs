//! Admissible waves of a scene, and the one with the lowest critical speed.
//!
//! Theory: docs/theory.md, section 7.4.

use super::layer::{FarFace, Layers};
use elasticity::Base;
use nalgebra::Complex;
use scene::{Constraint, Geometry, Path, Scene, ThermalBoundary};
use std::f64::consts::PI;

/// Wave speeds of the search over the sliding speed: number, and the ends of their geometric progression, from a body at rest to
/// slightly beyond one half, because a wave between equal bodies moves at half the speed.
const WAVE_SPEEDS: usize = 12;
const WAVE_SPEED_RANGE: [f64; 2] = [1e-10, 0.5001];

/// Ratio of neighbouring wave numbers, up to this number of them; the minimum is refined by a parabola.
const SPACING: f64 = 1.2;
const MOST_WAVES: usize = 24;

/// Admissible motion of a wave.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Motion {
    /// At any speed between those of the bodies, closer to that of the punch (false) or of the strip.
    Free(bool),
    /// At rest in this body; heated for this fraction of the time.
    With(usize, f64),
    /// Normal to the sliding direction: at rest in both bodies.
    Across,
}

/// Waves that differ in their wave number only.
#[derive(Debug)]
pub(super) struct Family {
    pub motion: Motion,
    /// Whether a contact line resolves them.
    pub modelled: bool,
    /// In ascending order of wave number.
    pub waves: Vec<Layers>,
    /// Whether intermediate wave numbers are admissible.
    pub continuous: bool,
}

/// Least Re Z over all waves and over those that a contact line resolves, m/s, and the number of the least wave of each family.
#[derive(Clone, Debug)]
pub(super) struct Least {
    pub all: f64,
    pub modelled: f64,
    waves: Vec<usize>,
}

/// Far face of the strip in the mode that a contact line contains, and in those that a strip between two faces has beside it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FarFaces {
    /// In the mode of the contact line.
    pub own: FarFace,
    /// In the modes beside it.
    pub others: &'static [FarFace],
}

impl FarFaces {
    /// Far faces of a scene: an insulated base under two faces is the mid plane of the strip.
    pub(crate) fn of(scene: &Scene) -> FarFaces {
        let mid_plane = scene.faces == 2.0 && scene.strip.far_thermal == ThermalBoundary::Insulated;
        let others: &[FarFace] = match (mid_plane, scene.smooth_base) {
            (false, _) => &[],
            (true, true) => &[FarFace::Antisymmetric],
            (true, false) => &[FarFace::Symmetric, FarFace::Antisymmetric],
        };
        FarFaces { own: FarFace::Held(if scene.smooth_base { Base::Smooth } else { Base::Bonded }), others }
    }
}

/// Admissible waves of a scene.
#[derive(Debug)]
pub(super) struct Families {
    families: Vec<Family>,
    /// Sliding speed of the fastest point of the contact over that at the mean radius.
    fastest_cell: f64,
}

impl Families {
    /// Admissible waves for the scene's geometry.
    pub(crate) fn of(scene: &Scene) -> Families {
        let mut families = Vec::new();
        let FarFaces { own, others } = FarFaces::of(scene);
        let mut add = |numbers: &Numbers, motions: &[Motion]| {
            for (far, modelled) in [(own, true)].into_iter().chain(others.iter().map(|&far| (far, false))) {
                for &motion in motions {
                    let waves: Vec<Layers> =
                        numbers.values.iter().map(|&number| Layers::new(scene, far, number)).collect();
                    families.push(Family { motion, modelled, waves, continuous: numbers.continuous });
                }
            }
        };
        let free = [Motion::Free(false), Motion::Free(true)];
        let with = [Motion::With(0, 1.0), Motion::With(1, scene.coverage())];
        let turns = scene.constraint == Constraint::TranslateAndRotate;
        let half_waves = |length: f64| Numbers::from(scene, if turns { 2.0 * PI / length } else { PI / length });
        match scene.geometry {
            Geometry::Periodic => add(&Numbers::multiples(scene, 2.0 * PI / scene.width), &free),
            Geometry::Annular => {
                // Fraction of the circle from which on punches count as a full ring.
                if scene.count * scene.depth > 0.999 * 2.0 * PI * scene.mean_radius {
                    add(&Numbers::multiples(scene, 1.0 / scene.mean_radius), &free);
                } else {
                    add(&half_waves(scene.depth), &with);
                }
                add(&Numbers::from(scene, PI / scene.width), &[Motion::Across]);
            }
            Geometry::Line => {
                add(&half_waves(scene.width), if scene.path == Path::Closed { &with } else { &with[..1] });
            }
        }
        let fastest_cell = match scene.geometry {
            Geometry::Annular => 1.0 + 0.5 * scene.width / scene.mean_radius,
            Geometry::Line | Geometry::Periodic => 1.0,
        };
        Families { families, fastest_cell }
    }

    /// Whether no wave can grow.
    pub(crate) fn is_neutral(&self) -> bool {
        self.families.iter().flat_map(|family| &family.waves).all(Layers::is_neutral)
    }

    /// Least Re Z at the sliding speed `speed` (m/s); infinite: there is no such wave. The minimum is followed from that `near`,
    /// at a speed not far away, or searched among all waves.
    pub(crate) fn least(&self, speed: f64, near: Option<&Least>) -> Least {
        let mut least = Least { all: f64::INFINITY, modelled: f64::INFINITY, waves: Vec::new() };
        for (index, family) in self.families.iter().enumerate() {
            let (value, wave) = family.least(speed, near.map(|near| near.waves[index]));
            least.waves.push(wave);
            least.all = least.all.min(value);
            if family.modelled {
                least.modelled = least.modelled.min(value);
            }
        }
        least
    }

    /// Least Z of one body by itself at rest, m/s, over the waves that a contact line resolves.
    pub(crate) fn alone(&self) -> f64 {
        let own = |family: &Family| family.waves.iter().map(Layers::alone).fold(f64::INFINITY, f64::min);
        let modelled = self.families.iter().filter(|family| family.modelled);
        modelled.map(own).fold(f64::INFINITY, f64::min) / self.fastest_cell
    }
}

/// Wave numbers in ascending order, 1/m.
struct Numbers {
    values: Vec<f64>,
    continuous: bool,
}

impl Numbers {
    /// Wave numbers from `lowest` to where both layers are half-planes.
    fn from(scene: &Scene, lowest: f64) -> Numbers {
        let count = Self::count(scene, lowest);
        let ratio = Self::highest(scene, lowest) / lowest;
        let part = |k: usize| if count > 1 { k as f64 / (count - 1) as f64 } else { 0.0 };
        Numbers { values: (0..count).map(|k| lowest * ratio.powf(part(k))).collect(), continuous: true }
    }

    /// Integer multiples of `lowest`.
    fn multiples(scene: &Scene, lowest: f64) -> Numbers {
        let mut values: Vec<f64> =
            Self::from(scene, lowest).values.iter().map(|value| (value / lowest).round() * lowest).collect();
        values.dedup();
        Numbers { values, continuous: false }
    }

    fn highest(scene: &Scene, lowest: f64) -> f64 {
        // q h from which on a layer is a half-plane, in which shorter waves are more stable.
        lowest.max(4.0 / scene.punch.height.min(scene.strip.height))
    }

    fn count(scene: &Scene, lowest: f64) -> usize {
        let steps = (Self::highest(scene, lowest) / lowest).ln() / SPACING.ln();
        (steps.ceil() as usize + 1).min(MOST_WAVES)
    }
}

impl Family {
    /// Least Re Z over the wave numbers at the sliding speed `speed`, m/s, and its wave, followed from `near` or searched among all.
    fn least(&self, speed: f64, near: Option<usize>) -> (f64, usize) {
        let last = self.waves.len() - 1;
        let at = |index: usize| least(&self.waves[index], self.motion, speed);
        let mut best = (near.unwrap_or(0), f64::INFINITY);
        if near.is_some() {
            best.1 = at(best.0);
            for upward in [true, false] {
                while (upward && best.0 < last) || (!upward && best.0 > 0) {
                    let next = if upward { best.0 + 1 } else { best.0 - 1 };
                    let value = at(next);
                    if value >= best.1 {
                        break;
                    }
                    best = (next, value);
                }
            }
        } else {
            for index in 0..=last {
                let value = at(index);
                if value < best.1 {
                    best = (index, value);
                }
            }
        }
        let between = self.continuous && best.0 > 0 && best.0 < last && best.1.is_finite();
        let value = if between { parabola([at(best.0 - 1), best.1, at(best.0 + 1)]) } else { best.1 };
        (value, best.0)
    }
}

/// Minimum of the parabola through the logarithms of three equidistant values, of which the middle one is the least.
fn parabola(values: [f64; 3]) -> f64 {
    let [left, middle, right] = values.map(f64::ln);
    let (slope, curvature) = (0.5 * (right - left), left + right - 2.0 * middle);
    if !curvature.is_finite() || curvature <= 0.0 {
        return values[1];
    }
    (middle - 0.5 * slope * slope / curvature).exp()
}

/// Least Re Z of one wave over its motions at the sliding speed `speed`, m/s; infinite: there is no such wave.
pub(super) fn least(layers: &Layers, motion: Motion, speed: f64) -> f64 {
    if layers.is_neutral() {
        return f64::INFINITY;
    }
    let positive = |value: f64| if value > 0.0 { value } else { f64::INFINITY };
    match motion {
        Motion::Across => positive(layers.impedance([0.0, 0.0]).re),
        Motion::With(_, part) if part <= 0.0 => f64::INFINITY,
        Motion::With(body, part) => {
            let speeds = if body == 0 { [0.0, -speed] } else { [speed, 0.0] };
            positive(layers.impedance(speeds).re / part)
        }
        Motion::Free(swapped) => least_free(layers, speed, swapped),
    }
}

/// Waves that move relative to the punch at less than half the sliding speed; `swapped`: relative to the strip.
fn least_free(layers: &Layers, speed: f64, swapped: bool) -> f64 {
    let at = |part: f64| {
        let (near, far) = (part * speed, (part - 1.0) * speed);
        // In the frame of the strip, the punch slides in the opposite direction.
        layers.impedance(if swapped { [-far, -near] } else { [near, far] })
    };
    let mut least = f64::INFINITY;
    let mut take = |value: Complex<f64>| {
        if value.re > 0.0 {
            least = least.min(value.re);
        }
    };
    let [slowest, fastest] = WAVE_SPEED_RANGE;
    let step = (fastest / slowest).powf(1.0 / (WAVE_SPEEDS - 1) as f64);
    let mut before = (0.0, at(0.0));
    if before.1.im == 0.0 {
        take(before.1);
    }
    let mut part = slowest;
    for _ in 0..WAVE_SPEEDS {
        let now = (part, at(part));
        if before.1.im * now.1.im < 0.0 {
            take(root(&at, before, now));
        }
        before = now;
        part *= step;
    }
    least
}

/// Z at a zero of its imaginary part between two wave speeds (false position, Illinois variant).
fn root(at: &impl Fn(f64) -> Complex<f64>, from: (f64, Complex<f64>), to: (f64, Complex<f64>)) -> Complex<f64> {
    let (mut left, mut right) = ((from.0, from.1.im), (to.0, to.1.im));
    let mut value = to.1;
    for _ in 0..30 {
        let part = (left.0 * right.1 - right.0 * left.1) / (right.1 - left.1);
        value = at(part);
        if value.im.abs() <= 1e-6 * value.re.abs() {
            break;
        }
        if value.im * right.1 < 0.0 {
            left = right;
        } else {
            left.1 *= 0.5;
        }
        right = (part, value.im);
    }
    value
}
