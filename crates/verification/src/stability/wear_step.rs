//! Size of the wear step against the number of cells: explicit and default scheme.
//!
//! # The problem
//!
//! A rigid flat punch on a half-plane, no friction, wear in proportion to pressure (`dw/ds = k p`), translating under a
//! constant load, in the units E* = 1, a = 1, mean pressure 1, k = 1. The pressure relaxes from the singular elastic one to
//! the mean. On N cells, with C the compliance and w the widths,
//!
//! ```text
//! C dp/ds + p = d(delta)/ds,   sum w p = 2
//! ```
//!
//! is linear: with the eigenpairs `C phi = Lambda phi + const` on the space of zero mean, each mode decays as
//! `exp(-s/Lambda)`. That is the reference, exact in the path s for the same cells, so that errors are those of the time
//! discretisation alone.
//!
//! # The bound
//!
//! Explicit Euler multiplies a mode by `1 - h/Lambda` per step: stable while `h < 2 Lambda_min`, and Lambda_min is
//! proportional to the width of the edge cells, like 1/N^2.
//!
//! Theory: docs/theory.md, sections 5.2, 5.6.

use super::{Axis, Curve, Grid, Map, Panel, Point, Verdict};
use crate::Fallible;
use crate::explicit_limit::explicit_limit;
use crate::integrator::{Integrator, Scheme};
use contact::wear::line::{CellRate, Conditions, WearingContact};
use contact::{ContactState, Normal, Tilt};
use elasticity::{Cells, ElasticBody, HalfPlane, Material};
use nalgebra::{DMatrix, DVector};
use numerics::factorization;
use std::f64::consts::E;

pub(crate) const SUMMARY: &str =
    "wear step over the explicit limit against the number of cells, explicit and default scheme";

const COUNTS: [usize; 11] = [9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257];
const STEPS: u32 = 100;
/// First judged step: a step longer than the fastest decay cannot resolve it, only remain stable.
const JUDGED: u32 = 10;
/// Change of a cell's error per step, over the mean pressure, that indicates growth: half of the change at which a cell
/// lifts off.
const ALTERNATION: f64 = 0.5;
/// Allowance on [`Method::owed`], which is the leading term only.
const ALLOWANCE: f64 = 1.5;

/// Stepping method.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Method {
    /// Explicit Euler without a check of its bound.
    Unguarded,
    /// Explicit Euler that refuses steps beyond its bound.
    Explicit,
    /// The default: SDIRK2.
    Default,
}

impl Method {
    /// Error bound from the tenth step on of a method of this order, relative to the deviation at the start: the largest
    /// value over all decays z per step of the leading term of `|R(z)^n - exp(-n z)|`, n = 10. First order:
    /// `n z^2/2 exp(-n z) <= 2/(e^2 n)`. SDIRK2: `n c z^3 exp(-n z) <= 27 c/(e^3 n^2)`, `c = 3 g^2 - 2 g^3 - 1/6`, g = 1 -
    /// 1/sqrt 2.
    fn owed(self) -> f64 {
        let n = f64::from(JUDGED);
        match self {
            Self::Unguarded | Self::Explicit => 2.0 / (E * E * n),
            Self::Default => {
                let gamma = conduction::line::GAMMA;
                let constant = 3.0 * gamma.powi(2) - 2.0 * gamma.powi(3) - 1.0 / 6.0;
                27.0 * constant / (E.powi(3) * n * n)
            }
        }
    }
}

/// The relaxing contact with its exact solution, in modes that decay independently.
pub struct Relaxation {
    cells: Cells,
    compliance: DMatrix<f64>,
    /// Square roots of the cells' fractions of the width: the norm of `root_i (p_i - 1)` is the root mean square of p - 1.
    root: DVector<f64>,
    /// Modes, in columns, in those coordinates.
    parts: DMatrix<f64>,
    /// Relaxation path of each mode, ascending.
    lengths: Vec<f64>,
    /// Initial amplitude of each mode.
    start: DVector<f64>,
}

impl Relaxation {
    /// The problem on `count` cells graded to the edges.
    pub fn new(count: usize) -> Fallible<Self> {
        let cells = Cells::graded(1.0, count)?;
        let material = Material::new(0.91, 0.3)?;
        let compliance = HalfPlane { material }.compliance(&cells).normal;
        let root = DVector::from_iterator(count, cells.widths().iter().map(|width| (0.5 * width).sqrt()));
        let scaled = DMatrix::from_fn(count, count, |i, j| compliance[(i, j)] * root[i] / root[j]);
        let scaled = 0.5 * (&scaled + scaled.transpose());
        // On the complement of the unit vector `root`, that is, on zero mean.
        let image = &scaled * &root;
        let energy = root.dot(&image);
        let projected =
            &scaled - &image * root.transpose() - &root * image.transpose() + &root * root.transpose() * energy;
        let eigen = factorization::symmetric_eigen(projected)?;
        let mut order: Vec<usize> =
            (0..count).filter(|&k| eigen.eigenvectors.column(k).dot(&root).abs() < 0.5).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let parts = eigen.eigenvectors.select_columns(&order);
        let lengths = order.iter().map(|&k| eigen.eigenvalues[k]).collect();
        let factors = factorization::lu(scaled)?;
        let singular = factors.solve(&root).ok_or("the compliance is singular")?;
        let elastic = &singular / singular.dot(&root);
        let start = parts.transpose() * (elastic - &root);
        Ok(Self { cells, compliance, root, parts, lengths, start })
    }

    /// Theoretical bound, `2 Lambda_min`.
    pub fn bound(&self) -> f64 {
        2.0 * self.lengths[0]
    }

    /// `root (p - 1)` of the exact solution.
    fn exact(&self, path: f64) -> DVector<f64> {
        let parts = DVector::from_fn(self.start.len(), |k, _| self.start[k] * (-path / self.lengths[k]).exp());
        &self.parts * parts
    }

    fn scaled(&self, pressure: &[f64]) -> DVector<f64> {
        DVector::from_fn(pressure.len(), |i, _| self.root[i] * (pressure[i] - 1.0))
    }

    fn stepper(&self) -> Fallible<Stepper> {
        let count = self.cells.count();
        let (normal, shear) = (self.compliance.clone(), DMatrix::zeros(count, count));
        let contact = WearingContact::new(&self.cells, self.cells.widths(), normal, shear, vec![0.0; count])?;
        let conditions = Conditions {
            signed_friction: 0.0,
            normal: Normal::Load(2.0),
            tilt: Tilt::Fixed(0.0),
            rate: CellRate::archard(1.0, 1.0),
        };
        Ok(Stepper {
            contact,
            conditions,
            default: Integrator::new(Scheme::Sdirk2, count),
            worn: vec![0.0; count],
            state: ContactState::new(count),
        })
    }

    /// Bound reported by the explicit scheme.
    pub fn reported_bound(&self) -> Fallible<f64> {
        let mut stepper = self.stepper()?;
        let pressure = stepper.pressure()?;
        Ok(explicit_limit(&mut stepper.contact, &stepper.conditions, &pressure))
    }

    /// Runs 100 steps of `ratio` times the theoretical bound. Returns the verdict and the largest error from the tenth step
    /// on, as the root mean square over the contact relative to that of the deviation at the start.
    ///
    /// # Errors
    /// A step fails for another reason than its size.
    pub fn run(&self, method: Method, ratio: f64) -> Fallible<(Verdict, f64)> {
        let step = ratio * self.bound();
        // The bound depends on the contact set only: a step that meets it once meets it always.
        if method == Method::Explicit && step >= self.reported_bound()? {
            return Ok((Verdict::Refused, f64::NAN));
        }
        let mut stepper = self.stepper()?;
        let deviation = self.start.norm();
        // Largest error, and largest change of the error of a cell from one step to the next over the last ten.
        let (mut error, mut alternation): (f64, f64) = (0.0, 0.0);
        let mut before = DVector::zeros(self.root.len());
        for done in 1..=STEPS {
            let pressure = match method {
                Method::Unguarded | Method::Explicit => stepper.unguarded(step)?,
                Method::Default => stepper.step(step)?,
            };
            if done < JUDGED {
                continue;
            }
            let now = self.scaled(&pressure) - self.exact(f64::from(done) * step);
            // A maximum would ignore NaN.
            if !now.norm().is_finite() {
                return Ok((Verdict::Grows, f64::INFINITY));
            }
            error = error.max(now.norm() / deviation);
            if done > STEPS - JUDGED {
                alternation = alternation.max((&now - &before).component_div(&self.root).amax());
            }
            before = now;
        }
        let verdict = if alternation > ALTERNATION {
            Verdict::Grows
        } else if error <= ALLOWANCE * method.owed() {
            Verdict::Right
        } else {
            Verdict::Rings
        };
        Ok((verdict, error))
    }

    /// Longest step at which unguarded explicit Euler does not amplify the fastest mode, by bisection to one part in a
    /// thousand over 500 steps: by stepping alone, without the eigenvalue. The initial pressure is run in except for a
    /// sawtooth of a thousandth of the mean pressure, so that every cell stays in contact during the test.
    pub fn measured_bound(&self) -> Fallible<f64> {
        let count = self.cells.count();
        let sawtooth = |i: usize| if i.is_multiple_of(2) { 1e-3 } else { -1e-3 };
        let uniform = &self.compliance * DVector::from_fn(count, |i, _| 1.0 + sawtooth(i));
        // Unweighted: growth occurs in the narrow cells at the edges.
        let amplitude = |pressure: &[f64]| pressure.iter().map(|p| (p - 1.0).abs()).fold(0.0, f64::max);
        let grows = |step: f64| -> Fallible<bool> {
            let mut stepper = self.stepper()?;
            stepper.worn = uniform.iter().map(|u| uniform.max() - u).collect();
            let mut history = [0.0; 2];
            for half in &mut history {
                for _ in 0..250 {
                    *half = amplitude(&stepper.unguarded(step)?);
                    if *half > 0.5 {
                        return Ok(true);
                    }
                }
            }
            // Rounding neither grows nor decays.
            Ok(history[1] > history[0] && history[1] > 1e-9)
        };
        // From a step that is certainly stable, a hundredth of the width of an edge cell.
        let mut low = 0.01 * self.cells.widths()[0];
        let mut high = low;
        while !grows(high)? {
            (low, high) = (high, 4.0 * high);
        }
        while high > 1.001 * low {
            let middle = (low * high).sqrt();
            if grows(middle)? { high = middle } else { low = middle }
        }
        Ok((low * high).sqrt())
    }
}

struct Stepper {
    contact: WearingContact,
    conditions: Conditions,
    default: Integrator,
    worn: Vec<f64>,
    state: ContactState,
}

impl Stepper {
    fn pressure(&mut self) -> Fallible<Vec<f64>> {
        let state = self.contact.pressure(&self.worn, &self.conditions)?;
        Ok(state.pressure)
    }

    fn step(&mut self, step: f64) -> Fallible<Vec<f64>> {
        let Self { contact, conditions, default, worn, state } = self;
        let constant = &mut |_: f64, now: &mut Conditions| now.clone_from(conditions);
        default.step(contact, worn, 0.0, step, constant, state)?;
        Ok(state.pressure.clone())
    }

    fn unguarded(&mut self, step: f64) -> Fallible<Vec<f64>> {
        let before = self.pressure()?;
        for (worn, p) in self.worn.iter_mut().zip(&before) {
            *worn += step * p;
        }
        self.pressure()
    }
}

/// Step sizes of the map over the bound: 8 per decade of the published grid, none at 1 itself.
fn ratios(grid: Grid) -> impl Iterator<Item = f64> {
    let count = match grid {
        Grid::Coarse => 8,
        Grid::Normal => 32,
        Grid::Fine => 64,
    };
    (0..count).map(move |k| 10f64.powf(-2.0 + 4.0 * (f64::from(k) + 0.5) / f64::from(count)))
}

pub(crate) fn map(grid: Grid, progress: &dyn Fn(f64)) -> Fallible<Map> {
    let counts = if grid == Grid::Coarse { &[9, 33, 65][..] } else { &COUNTS[..] };
    let methods = [Method::Unguarded, Method::Explicit, Method::Default];
    let mut points = [(); 3].map(|()| Vec::new());
    let (mut theory, mut reported, mut measured) = (Vec::new(), Vec::new(), Vec::new());
    let (total, mut done) = (counts.iter().map(|n| n * n).sum::<usize>(), 0);
    for &count in counts {
        let relaxation = Relaxation::new(count)?;
        let x = count as f64;
        theory.push((x, relaxation.bound()));
        reported.push((x, relaxation.reported_bound()?));
        measured.push((x, relaxation.measured_bound()?));
        for (method, points) in methods.into_iter().zip(&mut points) {
            for ratio in ratios(grid) {
                let (verdict, error) = relaxation.run(method, ratio)?;
                points.push(Point { x, y: ratio, verdict, error });
            }
        }
        done += count * count;
        progress(done as f64 / total as f64);
    }
    Ok(assemble(points, theory, reported, measured))
}

fn assemble(
    points: [Vec<Point>; 3],
    theory: Vec<(f64, f64)>,
    reported: Vec<(f64, f64)>,
    measured: Vec<(f64, f64)>,
) -> Map {
    let axis = |label, range| Axis { label, logarithmic: true, range };
    let cells = || axis("number of cells N", Some((7.0, 330.0)));
    let step = || axis("wear step over the explicit limit", Some((0.01, 150.0)));
    let curve = |name: &str, points, theory| Curve { name: name.to_owned(), points, theory };
    let bound = || curve("bound of the theory", vec![(7.0, 1.0), (330.0, 1.0)], true);
    let errors = |count: f64| {
        let runs = ["explicit Euler, unguarded", "default: SDIRK2"].into_iter().zip([&points[0], &points[2]]);
        let curves = runs.map(|(name, points)| {
            let here = points.iter().filter(|point| point.x == count);
            curve(name, here.map(|point| (point.y, point.error.max(1e-8))).collect(), false)
        });
        Panel {
            title: format!("error from the tenth step on, N = {count}"),
            x: axis("wear step over the explicit limit", Some((0.01, 100.0))),
            y: axis("error over the deviation at the start", Some((1e-8, 10.0))),
            points: Vec::new(),
            curves: curves.chain([curve("bound of the theory", vec![(1.0, 1e-8), (1.0, 1e3)], true)]).collect(),
        }
    };
    let bounds = Panel {
        title: "the explicit limit".to_owned(),
        x: cells(),
        y: axis("longest wear step, k E* ds/a", None),
        points: Vec::new(),
        curves: vec![
            curve("theory: 2 Λmin", theory, true),
            curve("reported by the explicit scheme", reported, false),
            curve("where unguarded runs begin to grow", measured, false),
        ],
    };
    let (second, third) = (errors(33.0), errors(points[0].iter().map(|point| point.x).fold(0.0, f64::max)));
    let titles = ["explicit Euler, unguarded", "explicit Euler with its bound", "default scheme: SDIRK2"];
    let judged: Vec<Panel> = (titles.into_iter().zip(points))
        .map(|(title, points)| Panel { title: title.to_owned(), x: cells(), y: step(), points, curves: vec![bound()] })
        .collect();
    let counted = |panel: &Panel, verdict: Verdict, above: bool| {
        panel.points.iter().filter(|point| point.verdict == verdict && (point.y > 1.0) == above).count()
    };
    let apart = |curve: &Curve| {
        let pairs = curve.points.iter().zip(&bounds.curves[0].points);
        pairs.map(|(found, exact)| (found.1 / exact.1 - 1.0).abs()).fold(0.0, f64::max)
    };
    let findings = vec![
        format!(
            "Explicit Euler grows in {} of the {} runs above the bound 2 Λmin and in {} of the {} below it; bisected runs place \
             the bound within {:.1e} of the theory.",
            counted(&judged[0], Verdict::Grows, true),
            judged[0].points.iter().filter(|point| point.y > 1.0).count(),
            counted(&judged[0], Verdict::Grows, false),
            judged[0].points.iter().filter(|point| point.y < 1.0).count(),
            apart(&bounds.curves[2])
        ),
        format!(
            "Explicit Euler with its bound refuses {} runs above the bound and {} below it, and reports the bound within {:.1e} of the \
             theory.",
            counted(&judged[1], Verdict::Refused, true),
            counted(&judged[1], Verdict::Refused, false),
            apart(&bounds.curves[1])
        ),
        format!(
            "The default scheme is right in {} of {} runs, to 1e4 times the bound; its largest error from the tenth step on is \
             {:.1e}.",
            judged[2].count(Verdict::Right),
            judged[2].points.len(),
            judged[2].largest_error()
        ),
    ];
    Map {
        title: "Length of the wear step",
        problem:
            "Flat punch on a half-plane, no friction, dw/ds = k p, run in from the elastic pressure: 100 equal steps \
             on N graded cells, against the exact solution on the same cells."
                .to_owned(),
        findings,
        panels: judged.into_iter().chain([bounds, second, third]).collect(),
        columns: 3,
    }
}
