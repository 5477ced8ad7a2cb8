//! Thermal distortion of the contact line of the punch by the temperature fields of its modes.
//!
//! The thermal distortion of a traction-free surface is independent of the stiffness, so E does not enter. A `rigid` punch
//! has no elastic compliance but does expand; it and the `half_plane`, which conduct as blocks of their own height, are
//! distorted like the elastic block. The columns of a `winkler` punch expand independently, by alpha (1 + nu) times the
//! integral of the temperature over the height, as in the mean of a block with free sides. The ring is a layer bonded at its
//! top, and for `half_plane` a half-plane. The mate of an annulus is a layer on its base; its modes along the radius are
//! Bessel functions, for which the response of a layer is that for plane waves of the same wave number.
//!
//! Theory: docs/theory.md, section 4.9.

use super::across::Across;
use super::assembly::{Assembly, Mode};
use super::bands::Product;
use super::galerkin::Shape;
use super::waves::Waves;
use super::{AMBIENT, By, COOLING, DISTORTING_MODES, DISTORTING_MODES_PER_CELL, FAR, SUMMED_MODES};
use crate::line::reduced::{PORTS, ReducedOperators};
use crate::line::strip::dilatation;
use elasticity::block::{Block, BlockError, FunctionsAcross};
use elasticity::{Base, Cells};
use nalgebra::{DMatrix, Matrix4, Vector4};
use numerics::factorization::{self, Unfactorable};
use numerics::grading::towards_face;
use scene::{Body, Geometry, MechanicalBody, Scene};

/// Law of distortion.
#[derive(Debug)]
enum Kind<'a> {
    Columns,
    Block(&'a Block),
    Layer { deep: bool },
    OnBase(Base),
}

/// Law of distortion, and the points through the height at which the profiles of the fields are needed.
#[derive(Debug)]
pub(super) struct Distortion<'a> {
    kind: Kind<'a>,
    /// Thermal expansion coefficient, 1/K.
    expansion: f64,
    poissons_ratio: f64,
    height: f64,
    /// Positions and weights.
    points: Vec<(f64, f64)>,
}

impl<'a> Distortion<'a> {
    /// Distortion of the punch of `scene`, whose finite elements are `block`; None without thermal expansion.
    pub(crate) fn new(scene: &Scene, block: Option<&'a Block>) -> Option<Distortion<'a>> {
        let body = &scene.punch;
        if body.thermal_expansion == 0.0 {
            return None;
        }
        let (poissons_ratio, height) = (body.poissons_ratio, body.height);
        let kind = if body.mechanical == MechanicalBody::Winkler {
            Kind::Columns
        } else if scene.geometry == Geometry::Periodic {
            Kind::Layer { deep: body.mechanical == MechanicalBody::HalfPlane }
        } else {
            Kind::Block(block.expect("a heated punch that expands has its finite elements"))
        };
        let points = match &kind {
            Kind::Block(block) => block.depth_points().into_iter().map(|point| (point.z, point.weight)).collect(),
            Kind::Columns | Kind::Layer { .. } | Kind::OnBase(_) => Vec::new(),
        };
        Some(Distortion { kind, expansion: body.thermal_expansion, poissons_ratio, height, points })
    }

    /// Distortion of a layer on its base; None without thermal expansion.
    pub(crate) fn on_base(body: &Body, base: Base) -> Option<Distortion<'a>> {
        (body.thermal_expansion > 0.0).then(|| Distortion {
            kind: Kind::OnBase(base),
            expansion: body.thermal_expansion,
            poissons_ratio: body.poissons_ratio,
            height: body.height,
            points: Vec::new(),
        })
    }

    /// Refines the points for fields that decay as fast as `steepest`, 1/m.
    pub(crate) fn resolve(&mut self, steepest: f64) {
        if let Kind::Layer { .. } | Kind::OnBase(_) = self.kind {
            let mut edges = towards_face(1.0 / steepest, self.height, 2.0);
            edges.extend([0.5, 0.75, 0.9, 1.0].map(|part| part * self.height));
            let rule = numerics::quadrature::gauss_legendre(12);
            self.points = (edges.windows(2))
                .flat_map(|pair| {
                    let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
                    rule.iter().map(move |&(node, weight)| (middle + half * node, half * weight))
                })
                .collect();
        }
    }

    /// Distances from the contact at which profiles are needed.
    pub(crate) fn positions(&self) -> Vec<f64> {
        self.points.iter().map(|point| point.0).collect()
    }

    /// Mean displacement of the cells into the body by fields of 1 K, N x fields, and by 1 K everywhere [m/K].
    fn of(
        &self,
        across: &Across,
        cells: &Cells,
        waves: &Waves,
        fields: &[Field],
    ) -> Result<(DMatrix<f64>, Vec<f64>), BlockError> {
        let count = fields.iter().map(|field| field.mode + 1).max().unwrap_or(0);
        if let Kind::Block(block) = &self.kind {
            // The uniform temperature is one further function.
            let one = vec![1.0; self.points.len()];
            let products = fields.iter().map(|field| (field.mode, &field.profile[..])).chain([(count, &one[..])]);
            let functions = FunctionsAcross {
                count: count + 1,
                steepest: if count > 0 { waves.wave(count - 1).wave_number } else { 0.0 },
                value: &|m, x| if m < count { waves.wave(m).value(x) } else { 1.0 },
                parity: &|m| if m < count { waves.wave(m).parity() } else { Some(1.0) },
            };
            let products: Vec<(usize, &[f64])> = products.collect();
            let found = block.product_distortion(cells.edges(), &functions, &products)? * self.expansion;
            let uniform = found.column(fields.len()).iter().copied().collect();
            return Ok((found.remove_column(fields.len()), uniform));
        }
        let mut result = DMatrix::zeros(cells.count(), fields.len());
        let weights = across.weights(cells);
        for (column, field) in fields.iter().enumerate() {
            let displacement = self.expansion * self.per_wave(waves.wave(field.mode).wave_number, field);
            for (row, (integral, weight)) in waves.integrals(field.mode).iter().zip(&weights).enumerate() {
                result[(row, column)] = displacement * integral / weight;
            }
        }
        Ok((result, vec![self.by_uniform(); cells.count()]))
    }

    /// Displacement times wave number by a steady field of short wavelength with unit surface amplitude, 1/K.
    fn by_short_wave(&self) -> f64 {
        -self.expansion * (1.0 + self.poissons_ratio)
    }

    /// Displacement per 1 K of uniform temperature, of columns that expand freely or of a layer constrained along x, m/K.
    fn by_uniform(&self) -> f64 {
        let nu = self.poissons_ratio;
        let restrained = if matches!(self.kind, Kind::Columns) { 1.0 } else { 1.0 - nu };
        -self.expansion * (1.0 + nu) / restrained * self.height
    }

    /// Displacement amplitude per unit expansion coefficient of a sinusoidal field of columns or of a layer.
    fn per_wave(&self, wave_number: f64, field: &Field) -> f64 {
        let nu = self.poissons_ratio;
        match self.kind {
            Kind::Layer { .. } | Kind::OnBase(_) if wave_number == 0.0 => -(1.0 + nu) / (1.0 - nu) * field.integral,
            Kind::Layer { deep } => {
                let dilatation = |z: f64| (-wave_number * z).exp();
                let bonded = LayerDilatation::new(wave_number, self.height, nu);
                let sum: f64 = (self.points.iter().zip(&field.profile))
                    .map(|(&(z, weight), value)| weight * value * if deep { dilatation(z) } else { bonded.at(z) })
                    .sum();
                -2.0 * (1.0 + nu) * sum
            }
            Kind::OnBase(base) => {
                let (falling, rising) = dilatation(base, nu, wave_number * self.height);
                let at =
                    |z: f64| falling * (-wave_number * z).exp() + rising * (-wave_number * (self.height - z)).exp();
                let points = self.points.iter().zip(&field.profile);
                -2.0 * (1.0 + nu) * points.map(|(&(z, weight), value)| weight * value * at(z)).sum::<f64>()
            }
            Kind::Columns | Kind::Block(_) => -(1.0 + nu) * field.integral,
        }
    }
}

/// A temperature field X_m(x) Z(z).
#[derive(Clone, Debug)]
struct Field {
    mode: usize,
    /// Integral of Z over the height, K m.
    integral: f64,
    /// Z at the points.
    profile: Vec<f64>,
}

impl Field {
    /// Field of a state of 1.
    fn of(mode: usize, shape: &Shape) -> Field {
        Field { mode, integral: shape.integral, profile: shape.extra.clone() }
    }
}

/// Dilatation in a layer bonded at z = h under the pressure cos(q x) at z = 0, over -(1 - 2 nu)/G.
///
/// Displacements grad(f + z g) - 4 (1 - nu) g e_z with harmonic f, g = cos(q x) times sums of exp(-q z) and
/// exp(-q (h - z)) (Papkovich, Neuber), times 2 G; the dilatation is -2 (1 - 2 nu) dg/dz over 2 G. exp(-q z) for a
/// half-plane.
struct LayerDilatation {
    wave_number: f64,
    height: f64,
    falling: f64,
    rising: f64,
}

impl LayerDilatation {
    fn new(wave_number: f64, height: f64, poissons_ratio: f64) -> Self {
        let (u, nu) = (wave_number * height, poissons_ratio);
        let e = (-u).exp();
        // Unknowns: q^2 f and q g, falling and rising. Rows: pressure 1 and no shear at the contact; no displacement
        // along and across at the base.
        let two = 2.0 * (1.0 - nu);
        let shear = 1.0 - 2.0 * nu;
        let kappa = 3.0 - 4.0 * nu;
        let matrix = Matrix4::new(
            1.0,
            e,
            two,
            -two * e, //
            -1.0,
            e,
            -shear,
            -shear * e, //
            e,
            1.0,
            u * e,
            u, //
            -e,
            1.0,
            -(u + kappa) * e,
            u - kappa,
        );
        let solution = match factorization::solve(&matrix, &Vector4::new(-1.0, 0.0, 0.0, 0.0)) {
            Ok(solution) => solution,
            Err(Unfactorable::NotFinite { .. }) => Vector4::from_element(f64::NAN),
            Err(_) => Vector4::zeros(),
        };
        Self { wave_number, height, falling: -solution[2], rising: solution[3] }
    }

    fn at(&self, z: f64) -> f64 {
        let q = self.wave_number;
        self.falling * (-q * z).exp() + self.rising * (-q * (self.height - z)).exp()
    }
}

impl Assembly<'_> {
    /// Distortion by the states, and the static correction of fast fields and fields of short wavelength. Returns that by 1 K in every
    /// band of modes but the last.
    pub(super) fn distort(
        &self,
        distortion: &Distortion<'_>,
        operators: &mut ReducedOperators,
    ) -> Result<Vec<Vec<f64>>, BlockError> {
        let positions = distortion.positions();
        let (depth, cells) = (&self.depth, self.cells);
        let mut fields = Vec::new();
        // States first, in their order; then the static corrections with their inputs.
        for (m, mode) in self.modes.iter().enumerate() {
            fields.extend(mode.states.iter().map(|shape| Field::of(m, shape)));
        }
        let states = fields.len();
        let mut by_flux: Vec<(usize, f64)> = Vec::new();
        let mut by_port: Vec<(usize, usize, f64)> = Vec::new();
        let first = self.modes.iter().scan(0, |next, mode| Some(std::mem::replace(next, *next + mode.states.len())));
        let first: Vec<usize> = first.collect();
        let longest = DISTORTING_MODES.min(DISTORTING_MODES_PER_CELL * cells.count()).max(self.modes.len());
        for m in 0..longest {
            let mode = self.modes.get(m);
            let wave = self.waves.wave(m);
            match mode {
                Some(Mode { feedthrough: Some(shape), .. }) => {
                    by_flux.push((fields.len(), shape.contact / shape.rate));
                    fields.push(Field::of(m, shape));
                }
                Some(_) => {}
                None => {
                    by_flux.push((fields.len(), 1.0));
                    let profile = positions.iter().map(|&z| depth.response(wave.decay, z).0).collect();
                    fields.push(Field { mode: m, integral: depth.steady_integral(wave.decay), profile });
                }
            }
            let exposure = self.exposure(wave);
            if exposure == 0.0 && wave.integral == 0.0 || !depth.has_steady_state(wave.decay) {
                continue;
            }
            // Air and the prescribed top temperature together make the body uniform.
            by_port.push((fields.len(), COOLING, exposure));
            if self.top_is_prescribed() {
                by_port.push((fields.len(), AMBIENT, self.cooled.transfer * exposure));
                by_port.push((fields.len(), FAR, -self.cooled.transfer * exposure));
            }
            fields.push(match self.cooled.by {
                // No correction, and no source in a body without heat loss.
                _ if exposure == 0.0 => Field { mode: m, integral: 0.0, profile: vec![0.0; positions.len()] },
                By::Sides => Field {
                    mode: m,
                    integral: depth.sourced_integral(wave.decay),
                    profile: positions.iter().map(|&z| depth.sourced(wave.decay, z)).collect(),
                },
                By::Face => Field {
                    mode: m,
                    integral: depth.steady_integral(wave.decay),
                    profile: positions.iter().map(|&z| depth.response(wave.decay, z).0).collect(),
                },
            });
            let driven = self.top_exposure(wave);
            if driven != 0.0 {
                let from_top = depth.driven_from_top(wave.decay);
                by_port.push((fields.len(), FAR, driven));
                let profile = positions.iter().map(|&z| from_top.at(z).0).collect();
                fields.push(Field { mode: m, integral: from_top.integral(), profile });
            }
            let Some(mode) = mode else { continue };
            for (i, shape) in mode.states.iter().enumerate() {
                for (port, input) in self.input(mode, shape).into_iter().enumerate() {
                    by_port.push((first[m] + i, port, -input / shape.rate));
                }
            }
        }
        let own = fields.len();
        let in_bands = self.bands.split_last().map_or(&[][..], |(_, bands)| bands);
        let in_bands = (0..).zip(in_bands).flat_map(|(b, band)| band.iter().map(move |product| (b, product)));
        // The displacement by short waves is left to the last band.
        let in_bands: Vec<(usize, &Product)> = in_bands.filter(|(_, product)| product.mode < longest).collect();
        fields.extend(in_bands.iter().map(|(_, product)| Field::of(product.mode, self.uniform_shape(product.shape).0)));
        let (displacements, uniform) = distortion.of(&self.across, cells, &self.waves, &fields)?;
        operators.distortion = displacements.columns(0, states).iter().copied().collect();
        for &(field, weight) in &by_flux {
            for (j, integral) in self.waves.integrals(fields[field].mode).iter().enumerate() {
                let mut column = operators.distortion_by_flux.column_mut(j);
                column.axpy(weight * integral, &displacements.column(field), 1.0);
            }
        }
        // u = -alpha (1 + nu) T/xi for the steady temperature T = q/(k xi) of a mode of short wavelength.
        let mut short = self.waves.sum(longest..SUMMED_MODES.max(longest), |_, wave| {
            distortion.by_short_wave() / (depth.conductivity * wave.decay * wave.decay)
        });
        for (mut row, width) in short.row_iter_mut().zip(&operators.widths) {
            row /= *width;
        }
        operators.distortion_by_flux += short;
        operators.distortion_by_port = [(); PORTS].map(|()| vec![0.0; cells.count()]);
        for &(field, port, weight) in &by_port {
            for (sum, value) in operators.distortion_by_port[port].iter_mut().zip(displacements.column(field).iter()) {
                *sum += weight * value;
            }
        }
        let port = if self.top_is_prescribed() { FAR } else { AMBIENT };
        if self.top_is_prescribed() || self.cooled.transfer > 0.0 || self.top_transfer() > 0.0 {
            for (sum, value) in operators.distortion_by_port[port].iter_mut().zip(uniform) {
                *sum += value;
            }
        }
        let mut moved = vec![vec![0.0; cells.count()]; self.bands.len().saturating_sub(1)];
        for (&(band, product), column) in in_bands.iter().zip(displacements.column_iter().skip(own)) {
            let state = self.waves.wave(product.mode).integral * self.uniform_shape(product.shape).1;
            moved[band].iter_mut().zip(column.iter()).for_each(|(sum, value)| *sum += state * value);
        }
        Ok(moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elasticity::{Base, StripKernel};

    #[test]
    fn dilatation_belongs_to_the_displacement_of_a_bonded_layer() {
        // Without shear at the surface its displacement under the pressure is, in these potentials, the difference of the
        // two parts of the dilatation there.
        for nu in [0.0, 0.3, 0.49] {
            for u in [0.05f64, 0.7, 3.0, 30.0, 900.0] {
                let layer = LayerDilatation::new(u / 0.2, 0.2, nu);
                let found = layer.falling - (-u).exp() * layer.rising;
                let expected = StripKernel::new(Base::Bonded, nu).normal(u);
                assert!((found / expected - 1.0).abs() < 1e-8, "{nu} {u}: {found} {expected}");
            }
        }
        let deep = LayerDilatation::new(100.0, 1.0, 0.3);
        assert!((deep.at(0.01) - (-1.0f64).exp()).abs() < 1e-12);
    }
}
