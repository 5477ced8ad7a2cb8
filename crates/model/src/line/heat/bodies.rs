//! Conducting bodies of a scene, and whether their heat is resolved.
//!
//! Theory: docs/theory.md, section 8.1.

use crate::lumped::error_weights::{ErrorWeight, error_weights};
use crate::lumped::operators::moving_source;
use crate::tolerance::ToleranceBudget;
use conduction::lateral::Lateral;
use conduction::line::ThermalBody;
use conduction::line::disc::DiscHeat;
use conduction::line::property_body::PropertyBody;
use conduction::line::punch;
use conduction::line::strip::{Expansion, Reductions, Resolution, SlidingPath, StripHeat, StripProperties};
use conduction::properties::Properties;
use conduction::slab::Slab;
use elasticity::block::Block;
use elasticity::discretization::relative_radii;
use elasticity::{self, Cells, Material};
use numerics::maximum::maximum;
use scene::{self, Geometry, HeatResolution, Scene};

/// Whether heat is resolved along the contact line: wherever a body conducts, unless the scene asks for its mean alone.
pub fn is_resolved(scene: &Scene) -> bool {
    scene.heat_resolution == HeatResolution::Resolved && can_be_resolved(scene)
}

/// Whether this scene permits resolved heat: a body conducts.
pub(crate) fn can_be_resolved(scene: &Scene) -> bool {
    scene.punch.conductivity > 0.0 || scene.strip.conductivity > 0.0
}

/// Prototypes of punch and strip, copied for every instance of a scene.
#[derive(Debug)]
pub struct Bodies {
    /// Shared by the threads; each prepares steps of its own, in a copy.
    pub prototypes: [Option<Box<dyn ThermalBody>>; 2],
    /// Lengths of their states.
    pub states: [usize; 2],
    /// Decay rates of their modes, 1/s: bodies with the same rates have the same state layout.
    pub rates: [Vec<f64>; 2],
    /// Number of Fourier modes of the strip.
    pub waves: usize,
    /// Cooled lengths across the line (area per depth and punch), m.
    pub cooled_length: [f64; 2],
    /// Larger error of the contact temperature by the model reductions, relative to its rise.
    pub error: f64,
}

impl Bodies {
    /// Builds both bodies under the given cells; `block`: the finite elements of the heated punch; `known`: reductions of strips, which
    /// that of this strip joins.
    ///
    /// # Errors
    /// The reason for which a body cannot be built, as a text with the numbers.
    pub fn new(scene: &Scene, cells: &Cells, block: Option<&Block>, known: &mut Reductions) -> Result<Bodies, String> {
        let error_weights = error_weights(scene);
        let reduction = ToleranceBudget::of(scene).reduction;
        let of_punch = [1.0, error_weights[0].tolerance].map(|weight| reduction.punch(weight));
        let tolerance = reduction.strip(error_weights[1].tolerance);
        let duration = scene.nominal_duration;
        let punch = punch::reduce_with_mean(scene, cells, block, of_punch, duration)
            .map_err(|error| format!("punch: {error}"))?
            .map(|body| Box::new(body) as Box<dyn ThermalBody>);
        if scene.geometry == Geometry::Annular {
            let bodies = [punch, mate(scene, cells, tolerance)?];
            return Ok(Bodies::made(scene, bodies, error_weights, punch::mate::cooled_length(scene), 0));
        }
        let strip = strip(scene, cells, tolerance, known)?;
        let free = strip.as_ref().map_or(0.0, |strip| strip.length() - 2.0 * cells.half_width());
        let waves = strip.as_ref().map_or(0, |strip| strip.size().0);
        let strip = strip.map(|body| Box::new(body) as Box<dyn ThermalBody>);
        Ok(Bodies::made(scene, [punch, strip], error_weights, free.max(0.0), waves))
    }

    /// Builds both bodies from their [`error_weights`], the cooled length of the strip (m) and the number of its Fourier modes.
    fn made(
        scene: &Scene,
        bodies: [Option<Box<dyn ThermalBody>>; 2],
        error_weights: [ErrorWeight; 2],
        free: f64,
        waves: usize,
    ) -> Bodies {
        let cooled = scene.punch_cooled_area() / (scene.depth * scene.count);
        let endless = scene.path == scene::Path::Straight && scene.nominal_stroke == 0.0;
        let [punch, strip] = bodies;
        let bodies = [(punch, &scene.punch, false), (strip, &scene.strip, endless)].map(|(own, body, endless)| {
            match (own, Properties::of(body, scene.tolerance)) {
                // Fresh material arrives at the temperature for which the constants are.
                (Some(own), Some(properties)) if !endless => {
                    Some(Box::new(PropertyBody::new(own, properties, body.far_is_prescribed())) as _)
                }
                (own, _) => own,
            }
        });
        let states = bodies.each_ref().map(|body| body.as_ref().map_or(0, |body| body.states()));
        let rates = bodies.each_ref().map(|body| body.as_ref().map_or(Vec::new(), |body| body.decay_rates(0.0)));
        let of_the_mean = bodies.iter().map(|body| body.as_ref().map_or(0.0, |body| body.error_of_the_mean()));
        let error = of_the_mean.zip(error_weights).map(|(error, share)| share.accounted * error).fold(0.0, maximum);
        Bodies { prototypes: bodies, states, rates, waves, cooled_length: [cooled, free], error }
    }
}

/// Mating ring of an annular contact.
fn mate(scene: &Scene, cells: &Cells, tolerance: f64) -> Result<Option<Box<dyn ThermalBody>>, String> {
    let ring = punch::mate::reduce_mate(scene, cells, tolerance, scene.nominal_duration)
        .map_err(|error| format!("strip: {error}"))?;
    let Some(ring) = ring else { return Ok(None) };
    Ok(Some(match moving_source(scene) {
        Some(flash) => Box::new(DiscHeat::new(ring, flash, relative_radii(scene, cells))),
        None => Box::new(ring),
    }))
}

/// Path of the contact over the strip, as the strip's conduction model takes it.
fn path_of(scene: &Scene) -> SlidingPath {
    match scene.path {
        scene::Path::Closed => SlidingPath::Closed(scene.length / scene.count),
        scene::Path::Straight if scene.nominal_stroke > 0.0 => {
            SlidingPath::Stroke { stroke: scene.nominal_stroke, length: scene.length }
        }
        scene::Path::Straight => SlidingPath::Unidirectional,
    }
}

/// Shortest time to be resolved, s: a thousandth of the nominal duration, in reciprocating sliding at most a 60th of the cycle.
/// Bodies are reduced for it, and of an error by a jump what lasts for it counts.
pub(crate) fn shortest(scene: &Scene) -> f64 {
    let cycle = match path_of(scene) {
        SlidingPath::Stroke { stroke, .. } if scene.nominal_velocity > 0.0 => {
            2.0 * stroke / scene.nominal_velocity / 60.0
        }
        _ => f64::INFINITY,
    };
    cycle.min(1e-3 * scene.nominal_duration)
}

fn strip(scene: &Scene, cells: &Cells, tolerance: f64, known: &mut Reductions) -> Result<Option<StripHeat>, String> {
    let body = &scene.strip;
    if body.conductivity == 0.0 {
        return Ok(None);
    }
    let expansion = if body.thermal_expansion > 0.0 {
        let material =
            Material::new(body.youngs_modulus, body.poissons_ratio).map_err(|error| format!("strip: {error}"))?;
        let base = if scene.smooth_base { elasticity::Base::Smooth } else { elasticity::Base::Bonded };
        Some(Expansion { material, coefficient: body.thermal_expansion, base })
    } else {
        None
    };
    let properties = StripProperties {
        slab: Slab { surface_transfer: body.convection * cooled_part(scene), ..Slab::of(body) },
        path: path_of(scene),
        expansion,
        lateral: Lateral::of(scene),
    };
    let duration = scene.nominal_duration;
    let travel = scene.nominal_velocity * duration;
    let resolution = Resolution { duration, shortest: shortest(scene), travel, tolerance };
    StripHeat::among(known, &properties, cells, &resolution).map(Some).map_err(|error| error.to_string())
}

/// Cooled area of the strip over its area beside the contact on a closed path; 1 where the area is not given, or the path open.
/// The mating ring of an annular contact includes its cooled area.
pub fn cooled_part(scene: &Scene) -> f64 {
    if scene.geometry == Geometry::Annular {
        return 1.0;
    }
    let free = scene.length * scene.depth - scene.contact_area() * scene.count;
    if scene.path == scene::Path::Closed && scene.strip.cooled_area > 0.0 && free > 0.0 {
        scene.strip.cooled_area / free
    } else {
        1.0
    }
}
