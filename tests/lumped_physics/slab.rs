//! A slab in air by finite volumes: reference solution for the convecting far face of a body.

const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// Cells through the height.
const CELLS: usize = 60;

/// Fraction of the largest stable explicit step.
const PART: f64 = 0.4;

/// A body heated at z = 0 that loses heat to the air at z = h by constant and forced convection and by radiation.
pub struct Slab {
    pub height: f64,
    pub conductivity: f64,
    pub capacity: f64,
    pub convection: f64,
    pub convection_forced: f64,
    pub emissivity: f64,
    pub ambient: f64,
}

/// Temperatures (K) of the heated face and in the mean, and the heat that has left (J/m2).
#[derive(Debug)]
pub struct SlabHistory {
    pub face: f64,
    pub mean: f64,
    pub lost: f64,
}

impl Slab {
    /// Loss (W/m2) of a face of `t` (K) and how it rises with that, where the air has the speed `speed` (m/s).
    pub fn loss(&self, t: f64, speed: f64) -> [f64; 2] {
        let moving = self.convection + self.convection_forced * speed.powf(0.8);
        let radiation = STEFAN_BOLTZMANN * self.emissivity;
        let lost = moving * (t - self.ambient) + radiation * (t.powi(4) - self.ambient.powi(4));
        [lost, moving + 4.0 * radiation * t.powi(3)]
    }

    /// Temperatures and loss from the ambient temperature on, under the fluxes (W/m2), air speeds (m/s) and durations (s) of `phases`.
    pub fn run(&self, phases: &[(f64, f64, f64)]) -> SlabHistory {
        let width = self.height / CELLS as f64;
        let between = self.conductivity / width;
        let mut t = [self.ambient; CELLS];
        // Half a cell between its middle and the face.
        let leaving = |inside: f64, speed: f64| {
            let mut face = inside;
            for _ in 0..3 {
                let [lost, slope] = self.loss(face, speed);
                face -= (2.0 * between * (face - inside) + lost) / (2.0 * between + slope);
            }
            self.loss(face, speed)[0]
        };
        let (mut lost, mut last) = (0.0, 0.0);
        for &(flux, speed, duration) in phases {
            let steps = (duration * between / (PART * self.capacity * width)).ceil();
            let step = duration / steps;
            for _ in 0..steps as usize {
                let out = leaving(t[CELLS - 1], speed);
                let mut entering = flux;
                for i in 0..CELLS {
                    let passing = if i + 1 < CELLS { between * (t[i] - t[i + 1]) } else { out };
                    t[i] += step / (self.capacity * width) * (entering - passing);
                    entering = passing;
                }
                lost += step * out;
            }
            last = flux;
        }
        // The parabola of a steady flux through the first two cells, whose flux at the face is the one that enters.
        let face = t[0] + (t[0] - t[1]) / 8.0 + 3.0 * last / (8.0 * between);
        SlabHistory { face, mean: t.iter().sum::<f64>() / CELLS as f64, lost }
    }
}
