//! A scene: the parameters of the physical model, built from the values of the variable table.

mod fade;
pub mod fnv;
mod friction_table;
pub mod message;
mod property_table;
mod rules;
pub mod slot;
pub mod variables;
mod warnings;

pub use fade::{FadeLine, FadeTable};
pub use friction_table::{FRICTION_POINTS, FrictionTable};
pub use property_table::{PROPERTY_POINTS, PropertyTable};
pub(crate) use rules::BrokenRule;
pub use rules::without_effect;

use crate::variables::{COUNT, TOLERANCES, ValueReference, reference};

/// Value of the row called `$name` in `$values`; an unknown name does not compile.
#[macro_export]
macro_rules! value {
    ($values:expr, $name:expr) => {
        $values[const { $crate::variables::reference($name) } as usize]
    };
}

/// The first elements of the row that begins at this reference.
fn row<const N: usize>(values: &[f64; COUNT], first: ValueReference) -> [f64; N] {
    std::array::from_fn(|element| values[first as usize + element])
}

/// Index of the first argument of a table that is not above its predecessor, if there is one.
fn disorder(arguments: &[f64]) -> Option<usize> {
    (1..arguments.len()).find(|&i| arguments[i].partial_cmp(&arguments[i - 1]) != Some(std::cmp::Ordering::Greater))
}

/// Elastic model of a body.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MechanicalBody {
    /// No deformation.
    Rigid,
    /// Independent springs.
    Winkler,
    /// Elastic half-plane.
    HalfPlane,
    /// Elastic body of finite height.
    Elastic,
}

/// Thermal condition of the face opposite to the contact.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ThermalBoundary {
    /// Constant temperature.
    Held,
    /// Heat transfer to ambient air.
    Convecting,
    /// Adiabatic.
    Insulated,
    /// Temperature prescribed by an input.
    External,
}

impl ThermalBoundary {
    /// The condition of an item of the enumeration.
    pub fn from_item(item: f64) -> ThermalBoundary {
        match item as i32 {
            1 => ThermalBoundary::Held,
            2 => ThermalBoundary::Convecting,
            3 => ThermalBoundary::Insulated,
            _ => ThermalBoundary::External,
        }
    }
}

/// Condition at the face opposite to the contact as a problem of conduction has it. Temperatures of the surroundings enter as
/// inputs.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum FarBoundary {
    /// Temperature prescribed.
    Held,
    /// Zero heat flux.
    Insulated,
    /// Heat transfer coefficient to ambient, W/(m2 K), > 0.
    Convecting(f64),
}

impl FarBoundary {
    /// Heat transfer coefficient, W/(m2 K); 0 where the temperature is prescribed or no heat flows.
    pub fn transfer(self) -> f64 {
        match self {
            FarBoundary::Convecting(transfer) => transfer,
            FarBoundary::Held | FarBoundary::Insulated => 0.0,
        }
    }

    /// The same with a heat transfer coefficient `factor` (> 0) times as high.
    #[must_use]
    pub fn scaled(self, factor: f64) -> FarBoundary {
        match self {
            FarBoundary::Convecting(transfer) => FarBoundary::Convecting(factor * transfer),
            other => other,
        }
    }
}

/// Geometry of the contact.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Geometry {
    /// x along the sliding direction.
    Line,
    /// x along the radius.
    Annular,
    /// The punch covers the whole closed path.
    Periodic,
}

/// Path of the punch on the strip.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Path {
    /// Open track.
    Straight,
    /// Closed track.
    Closed,
}

/// Level of the model.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fidelity {
    /// The cheapest that meets the tolerance.
    Auto,
    /// Uniform pressure, few thermal states.
    Lumped,
    /// Contact line.
    Line,
}

/// Heat of a contact line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HeatResolution {
    /// Flux and temperature of each cell, wherever a body conducts.
    Resolved,
    /// One mean flux and temperature, as at the lumped level: for pressure and wear alone.
    Mean,
}

/// Measure of the error of a run beyond that of its steps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ErrorEstimate {
    /// A companion where the level is chosen automatically, none where it is named.
    Automatic,
    /// None.
    Off,
    /// A coarser contact line on the same inputs.
    Companion,
}

/// Freedom of the punch in its holder.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Constraint {
    /// Approach only.
    Translate,
    /// Approach and rotation about a pivot.
    TranslateAndRotate,
}

/// Gap between the undeformed bodies at initialisation.
#[derive(Clone, PartialEq, Debug)]
pub enum InitialShape {
    /// None.
    Flat,
    /// x^2/(2 R), R in m.
    Parabolic(f64),
    /// The shape of the steady state at nominal conditions.
    RunIn,
    /// Values (m) at the 33 stations of `profile.x`, linear between.
    Tabulated(Box<[f64; STATIONS]>),
}

/// Stations of the profiles.
pub const STATIONS: usize = 33;

/// A body. Symbols and units as in the variable table.
#[derive(Clone, PartialEq, Debug)]
pub struct Body {
    /// Height of the body across the contact, m.
    pub height: f64,
    /// Elastic model.
    pub mechanical: MechanicalBody,
    /// E, Pa.
    pub youngs_modulus: f64,
    /// nu, 1.
    pub poissons_ratio: f64,
    /// Pressure over displacement of an elastic foundation, Pa/m.
    pub foundation_stiffness: f64,
    /// rho, kg/m3.
    pub density: f64,
    /// c, J/(kg K); of the property table at the initial temperature where there is one.
    pub specific_heat: f64,
    /// K, W/(m K), likewise; 0: an insulator.
    pub conductivity: f64,
    /// Conductivity and specific heat over temperature, in place of constants.
    pub properties: Option<PropertyTable>,
    /// alpha, 1/K.
    pub thermal_expansion: f64,
    /// k of the wear law, m2/N.
    pub wear_coefficient: f64,
    /// b of the wear law, 1.
    pub wear_pressure_exponent: f64,
    /// Pressure up to which the body does not wear, Pa.
    pub wear_threshold: f64,
    /// a of the wear law, 1.
    pub wear_velocity_exponent: f64,
    /// Factor of the wear rate over the temperature, 1.
    pub wear_fade: FadeTable,
    /// Worn depth at the start, m.
    pub initial_wear: f64,
    /// Worn depth at the end of life, m; 0: none.
    pub wear_limit: f64,
    /// K; 0: ambient.
    pub initial_temperature: f64,
    /// Heat transfer coefficient to ambient at rest, W/(m2 K).
    pub convection: f64,
    /// Its part that grows with the cooling velocity, at 1 m/s, W/(m2 K).
    pub convection_forced: f64,
    /// Emissivity of the free surfaces, 1.
    pub emissivity: f64,
    /// Free surface beside the contact, per face, m2; 0: by the geometry.
    pub cooled_area: f64,
    /// Conductance to a neighbour outside the FMU, W/K.
    pub external_conductance: f64,
    /// Airborne part of the worn mass, 1.
    pub airborne_fraction: f64,
    /// Condition of the face opposite to the contact.
    pub far_thermal: ThermalBoundary,
    /// Temperature there where it is held, K; 0: ambient.
    pub far_temperature: f64,
}

impl Body {
    /// Whether the temperature of the face opposite to the contact is prescribed.
    pub fn far_is_prescribed(&self) -> bool {
        matches!(self.far_thermal, ThermalBoundary::Held | ThermalBoundary::External)
    }

    /// Condition at the face opposite to the contact.
    pub fn far_boundary(&self) -> FarBoundary {
        match self.far_thermal {
            ThermalBoundary::Held | ThermalBoundary::External => FarBoundary::Held,
            ThermalBoundary::Convecting if self.convection > 0.0 => FarBoundary::Convecting(self.convection),
            ThermalBoundary::Convecting | ThermalBoundary::Insulated => FarBoundary::Insulated,
        }
    }

    /// Whether the input with the temperature of the neighbour acts.
    pub fn has_neighbour(&self) -> bool {
        self.far_thermal == ThermalBoundary::External || self.external_conductance > 0.0
    }

    /// Heat capacity by volume, J/(m3 K).
    pub fn capacity(&self) -> f64 {
        self.density * self.specific_heat
    }

    /// Heat capacity by area of the face, J/(m2 K).
    pub fn areal_capacity(&self) -> f64 {
        self.capacity() * self.height
    }

    /// Thermal diffusivity, m2/s.
    pub fn diffusivity(&self) -> f64 {
        self.conductivity / self.capacity()
    }
}

/// The parameters of a scene. Symbols and units as in the variable table.
#[derive(Clone, PartialEq, Debug)]
pub struct Scene {
    /// Body above, fixed to x.
    pub punch: Body,
    /// Body below.
    pub strip: Body,
    /// Width of the contact along x, m.
    pub width: f64,
    /// Depth of the contact across x, m.
    pub depth: f64,
    /// Equal punches spread over a closed path.
    pub count: f64,
    /// Path of the punch on the strip.
    pub path: Path,
    /// Circumference of a closed path, resolved from the mean radius where not given; 0 for a straight one without a given length.
    pub length: f64,
    /// Whether the base of the strip is free to slide on its rigid support.
    pub smooth_base: bool,
    /// Geometry of the contact.
    pub geometry: Geometry,
    /// Radius from angular to sliding velocity, m.
    pub mean_radius: f64,
    /// Faces in contact.
    pub faces: f64,
    /// mu before fade and Stribeck effect, 1.
    pub friction_coefficient: f64,
    /// Factor of mu over the temperature, 1.
    pub friction_fade: FadeTable,
    /// Static over kinetic friction, 1.
    pub static_friction_ratio: f64,
    /// Velocity over which static friction decays, m/s.
    pub stribeck_velocity: f64,
    /// Friction coefficient over sliding speed, in place of the Stribeck formula.
    pub friction_table: Option<FrictionTable>,
    /// Velocity of regularised friction, m/s; 0: off.
    pub regularization_velocity: f64,
    /// Stiffness of the bristle, N/m; 0: off.
    pub stick_stiffness: f64,
    /// The bodies deform along the sliding direction before they slide.
    pub elastic_slip: bool,
    /// Damping of the bristle, N s/m.
    pub stick_damping: f64,
    /// Thermal contact conductance, W/(m2 K).
    pub conductance: f64,
    /// Gap between the undeformed bodies at initialisation.
    pub initial_shape: InitialShape,
    /// Whether friction tractions displace the surfaces normal to the contact.
    pub shear_coupling: bool,
    /// K; 0: no limit.
    pub temperature_limit: f64,
    /// Freedom of the punch in its holder.
    pub constraint: Constraint,
    /// Height of the pivot above the contact, m.
    pub pivot_height: f64,
    /// Stiffness of the holder, N/m; 0: rigid.
    pub holder_stiffness: f64,
    /// K.
    pub ambient_temperature: f64,
    /// N per face.
    pub nominal_load: f64,
    /// m/s.
    pub nominal_velocity: f64,
    /// s.
    pub nominal_duration: f64,
    /// m; 0: sliding in one direction.
    pub nominal_stroke: f64,
    /// Level of the model.
    pub fidelity: Fidelity,
    /// Number of cells of the contact line; 0: by the tolerance.
    pub cells: usize,
    /// Heat of a contact line.
    pub heat_resolution: HeatResolution,
    /// Measure of the error of the run.
    pub error_estimate: ErrorEstimate,
    /// Relative tolerance: the scene's own, else the importer's.
    pub tolerance: f64,
    /// Tolerance of the reductions of the bodies, relative to it: 1, but for a companion.
    pub reduction_share: f64,
    /// Factor of all wear, 1.
    pub wear_acceleration: f64,
}

/// The friction table of the values of the variable table, if it has points.
fn friction_table(v: &[f64; COUNT]) -> Option<FrictionTable> {
    let points = value!(v, "contact.friction_table.points") as usize;
    (points > 0).then(|| FrictionTable {
        points,
        speed: row(v, const { reference("contact.friction_table.speed") }),
        coefficient: row(v, const { reference("contact.friction_table.coefficient") }),
    })
}

/// The property table whose rows begin at these references, if it has points.
fn property_table(v: &[f64; COUNT], points: f64, first: [ValueReference; 3]) -> Option<PropertyTable> {
    let [temperature, conductivity, specific_heat] = first.map(|first| row(v, first));
    (points > 0.0).then_some(PropertyTable { points: points as usize, temperature, conductivity, specific_heat })
}

/// A temperature where it is chosen to act, K; 0 where not.
fn chosen(acts: bool, temperature: f64) -> f64 {
    if acts { temperature } else { 0.0 }
}

macro_rules! body {
    ($v:expr, $body:literal, $far:literal, $far_temperature:literal, $at_ambient:literal) => {{
        let table = property_table(
            $v,
            value!($v, concat!($body, ".property_table.points")),
            [
                const { reference(concat!($body, ".property_table.temperature")) },
                const { reference(concat!($body, ".property_table.conductivity")) },
                const { reference(concat!($body, ".property_table.specific_heat")) },
            ],
        );
        let initial_temperature = chosen(
            value!($v, concat!($body, ".initial_at_ambient")) == 0.0,
            value!($v, concat!($body, ".initial_temperature")),
        );
        let ambient = value!($v, "ambient_temperature");
        let first = if initial_temperature > 0.0 { initial_temperature } else { ambient };
        Body {
            height: value!($v, concat!($body, ".height")),
            mechanical: match value!($v, concat!($body, ".body")) as i32 {
                1 => MechanicalBody::Rigid,
                2 => MechanicalBody::Winkler,
                3 => MechanicalBody::HalfPlane,
                _ => MechanicalBody::Elastic,
            },
            youngs_modulus: value!($v, concat!($body, ".youngs_modulus")),
            poissons_ratio: value!($v, concat!($body, ".poissons_ratio")),
            foundation_stiffness: value!($v, concat!($body, ".foundation_stiffness")),
            density: value!($v, concat!($body, ".density")),
            specific_heat: table
                .map_or(value!($v, concat!($body, ".specific_heat")), |table| table.specific_heat_at(first)),
            conductivity: table
                .map_or(value!($v, concat!($body, ".conductivity")), |table| table.conductivity_at(first)),
            properties: table,
            thermal_expansion: value!($v, concat!($body, ".thermal_expansion")),
            wear_coefficient: value!($v, concat!($body, ".wear_coefficient")),
            wear_pressure_exponent: value!($v, concat!($body, ".wear_pressure_exponent")),
            wear_threshold: value!($v, concat!($body, ".wear_threshold")),
            wear_velocity_exponent: value!($v, concat!($body, ".wear_velocity_exponent")),
            wear_fade: FadeTable::new(
                row($v, const { reference(concat!($body, ".wear_fade.temperature")) }),
                row($v, const { reference(concat!($body, ".wear_fade.factor")) }),
            ),
            initial_wear: value!($v, concat!($body, ".initial_wear")),
            wear_limit: value!($v, concat!($body, ".wear_limit")),
            initial_temperature,
            convection: value!($v, concat!($body, ".convection")),
            convection_forced: value!($v, concat!($body, ".convection_forced")),
            emissivity: value!($v, concat!($body, ".emissivity")),
            cooled_area: value!($v, concat!($body, ".cooled_area")),
            external_conductance: value!($v, concat!($body, ".external_conductance")),
            airborne_fraction: value!($v, concat!($body, ".airborne_fraction")),
            far_thermal: ThermalBoundary::from_item(value!($v, $far)),
            far_temperature: chosen(value!($v, $at_ambient) == 0.0, value!($v, $far_temperature)),
        }
    }};
}

/// Masses worn off both bodies and the airborne part of their sum, kg, by the worn volumes of all faces, m3.
pub fn worn_masses(bodies: [&Body; 2], volumes: [f64; 2]) -> [f64; 3] {
    let [punch, strip] = [0, 1].map(|body| bodies[body].density * volumes[body]);
    [punch, strip, bodies[0].airborne_fraction * punch + bodies[1].airborne_fraction * strip]
}

impl Scene {
    /// Reads the values of the variable table, each within its own bounds. `importer_tolerance` counts
    /// where `solver.tolerance` is 0.
    ///
    /// # Errors
    /// [`BrokenRule`] rules that join several parameters, such as a tipping punch.
    pub fn new(v: &[f64; COUNT], importer_tolerance: Option<f64>) -> Result<Scene, BrokenRule> {
        let mean_radius = value!(v, "contact.mean_radius");
        let path = if value!(v, "strip.path") == 1.0 { Path::Straight } else { Path::Closed };
        let given_length = value!(v, "strip.length");
        let geometry = match value!(v, "contact.geometry") as i32 {
            1 => Geometry::Line,
            2 => Geometry::Annular,
            _ => Geometry::Periodic,
        };
        let around = 2.0 * std::f64::consts::PI * mean_radius;
        let length = if given_length == 0.0 && path == Path::Closed { around } else { given_length };
        let own_tolerance = value!(v, "solver.tolerance");
        let tolerance = if own_tolerance > 0.0 { own_tolerance } else { importer_tolerance.unwrap_or(1e-3) };
        let scene = Scene {
            punch: body!(v, "punch", "punch.top_thermal", "punch.top_temperature", "punch.top_at_ambient"),
            strip: body!(v, "strip", "strip.base_thermal", "strip.base_temperature", "strip.base_at_ambient"),
            width: value!(v, "punch.width"),
            depth: value!(v, "depth"),
            count: value!(v, "punch.count"),
            path,
            length,
            smooth_base: value!(v, "strip.base") == 2.0,
            geometry,
            mean_radius,
            faces: value!(v, "contact.faces"),
            friction_coefficient: value!(v, "contact.friction_coefficient"),
            friction_fade: FadeTable::new(
                row(v, const { reference("contact.friction_fade.temperature") }),
                row(v, const { reference("contact.friction_fade.factor") }),
            ),
            static_friction_ratio: value!(v, "contact.static_friction_ratio"),
            stribeck_velocity: value!(v, "contact.stribeck_velocity"),
            friction_table: friction_table(v),
            regularization_velocity: value!(v, "contact.regularization_velocity"),
            stick_stiffness: value!(v, "contact.stick_stiffness"),
            elastic_slip: value!(v, "contact.tangential_compliance") == 2.0,
            stick_damping: value!(v, "contact.stick_damping"),
            conductance: value!(v, "contact.conductance"),
            initial_shape: match value!(v, "contact.initial_shape") as i32 {
                1 => InitialShape::Flat,
                2 => InitialShape::Parabolic(value!(v, "contact.initial_radius")),
                3 => InitialShape::RunIn,
                _ => InitialShape::Tabulated(Box::new(row(v, const { reference("contact.initial_gap") }))),
            },
            shear_coupling: value!(v, "contact.shear_coupling") != 0.0,
            temperature_limit: chosen(
                value!(v, "contact.temperature_limited") != 0.0,
                value!(v, "contact.temperature_limit"),
            ),
            constraint: if value!(v, "holder.constraint") == 1.0 {
                Constraint::Translate
            } else {
                Constraint::TranslateAndRotate
            },
            pivot_height: value!(v, "holder.pivot_height"),
            holder_stiffness: value!(v, "holder.stiffness"),
            ambient_temperature: value!(v, "ambient_temperature"),
            nominal_load: value!(v, "nominal.load"),
            nominal_velocity: value!(v, "nominal.velocity"),
            nominal_duration: value!(v, "nominal.duration"),
            nominal_stroke: value!(v, "nominal.stroke"),
            fidelity: match value!(v, "solver.fidelity") as i32 {
                1 => Fidelity::Auto,
                2 => Fidelity::Lumped,
                _ => Fidelity::Line,
            },
            cells: value!(v, "solver.cells") as usize,
            heat_resolution: match value!(v, "solver.heat") as i32 {
                1 => HeatResolution::Resolved,
                _ => HeatResolution::Mean,
            },
            error_estimate: match value!(v, "solver.error_estimate") as i32 {
                1 => ErrorEstimate::Automatic,
                2 => ErrorEstimate::Off,
                _ => ErrorEstimate::Companion,
            },
            tolerance: tolerance.clamp(*TOLERANCES.start(), *TOLERANCES.end()),
            reduction_share: 1.0,
            wear_acceleration: value!(v, "wear_acceleration"),
        };
        rules::check(&scene, v)?;
        Ok(scene)
    }

    /// Whether both bodies are rigid: the pressure is uniform then.
    pub fn has_rigid_bodies(&self) -> bool {
        [self.punch.mechanical, self.strip.mechanical] == [MechanicalBody::Rigid; 2]
    }

    /// Checks the rules of heat, which conductance and heat paths may break that are changed during a run.
    pub fn check_heat(&self) -> Result<(), BrokenRule> {
        rules::heat(self)
    }

    /// Warnings about implausible values, at any level, before the scene runs.
    pub fn warnings(&self) -> Vec<String> {
        warnings::of_temperatures(self)
    }

    /// Warnings about the inputs `strip.external_temperature` and `punch.external_temperature` (K).
    pub fn warnings_of_external(&self, temperatures: [f64; 2]) -> Vec<String> {
        warnings::of_external(self, temperatures)
    }

    /// Nominal contact area of one punch and one face, m2.
    pub fn contact_area(&self) -> f64 {
        self.width * self.depth
    }

    /// Mean apparent pressure under the nominal load, Pa.
    pub fn nominal_pressure(&self) -> f64 {
        self.nominal_load / (self.count * self.contact_area())
    }

    /// Area of the faces opposite to the contact, all faces and punches, m2: punch, strip of a closed path.
    pub fn far_areas(&self) -> [f64; 2] {
        let across = if self.geometry == Geometry::Annular { self.width } else { self.depth };
        [self.contact_area() * self.count * self.faces, self.length * across * self.faces]
    }

    /// Cooled area of the punches beside the contact, m2: as given, or their sides, which a punch all round does not have.
    pub fn punch_cooled_area(&self) -> f64 {
        match (self.punch.cooled_area, self.geometry) {
            (0.0, Geometry::Periodic) => 0.0,
            (0.0, _) => 2.0 * self.punch.height * self.depth * self.count,
            (given, _) => given,
        }
    }

    /// Fraction of the strip's length covered by all punches of a face; 0 for a straight path.
    pub fn coverage(&self) -> f64 {
        match (self.path, self.geometry) {
            (Path::Straight, _) => 0.0,
            (_, Geometry::Periodic) => 1.0,
            (_, Geometry::Line) => self.count * self.width / self.length,
            (_, Geometry::Annular) => self.count * self.depth / (2.0 * std::f64::consts::PI * self.mean_radius),
        }
    }

    /// Length of the contact along the sliding direction, m.
    pub fn sliding_extent(&self) -> f64 {
        if self.geometry == Geometry::Annular { self.depth } else { self.width }
    }
}
