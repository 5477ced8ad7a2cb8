//! Material presets of the scene file.
//!
//! Typical room-temperature values of handbooks and data sheets, for a first estimate: a casting or a
//! lining in use may differ by 10 % in the elastic and by 30 % in the thermal values. Wear and friction
//! are not among them, because they belong to a pair of materials, an environment and a load, not to
//! one body.

/// Properties that a preset gives to a body, in SI units.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Material {
    /// Name in the scene file.
    pub name: &'static str,
    /// Description of the material.
    pub description: &'static str,
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Density, kg/m3.
    pub density: f64,
    /// Specific heat, J/(kg.K).
    pub specific_heat: f64,
    /// Thermal conductivity, W/(m.K).
    pub conductivity: f64,
    /// Linear thermal expansion, 1/K.
    pub thermal_expansion: f64,
}

impl Material {
    /// The preset as pairs of the variable's name behind the body and its value.
    pub(crate) fn values(&self) -> [(&'static str, f64); 6] {
        [
            ("youngs_modulus", self.youngs_modulus),
            ("poissons_ratio", self.poissons_ratio),
            ("density", self.density),
            ("specific_heat", self.specific_heat),
            ("conductivity", self.conductivity),
            ("thermal_expansion", self.thermal_expansion),
        ]
    }
}

const fn material(name: &'static str, description: &'static str, values: [f64; 6]) -> Material {
    let [youngs_modulus, poissons_ratio, density, specific_heat, conductivity, thermal_expansion] = values;
    Material {
        name,
        description,
        youngs_modulus,
        poissons_ratio,
        density,
        specific_heat,
        conductivity,
        thermal_expansion,
    }
}

/// Every preset, in alphabetical order.
pub static MATERIALS: &[Material] = &[
    // Young's modulus, Poisson's ratio, density, specific heat, conductivity, expansion.
    material("alumina", "Sintered alumina, 99.5 % Al2O3", [3.7e11, 0.22, 3900.0, 880.0, 30.0, 8e-6]),
    material("aluminium_6061", "Aluminium alloy 6061-T6", [6.89e10, 0.33, 2700.0, 896.0, 167.0, 23.6e-6]),
    material("bearing_steel", "Through-hardened bearing steel 100Cr6", [2.08e11, 0.3, 7810.0, 475.0, 46.6, 11.9e-6]),
    material("brake_lining", "Organic brake lining without asbestos", [1e9, 0.25, 2600.0, 1000.0, 1.2, 15e-6]),
    material("bronze", "Tin bronze CuSn8", [1.15e11, 0.33, 8800.0, 377.0, 67.0, 18e-6]),
    material("carbon_steel", "Carbon steel C45", [2.06e11, 0.29, 7850.0, 486.0, 49.8, 11.5e-6]),
    material("copper", "Electrolytic copper Cu-ETP", [1.2e11, 0.34, 8920.0, 386.0, 394.0, 16.8e-6]),
    material("friction_paper", "Paper-based wet clutch lining", [3e7, 0.25, 1100.0, 1600.0, 0.24, 20e-6]),
    material("graphite", "Isotropic graphite", [1.1e10, 0.2, 1850.0, 710.0, 143.0, 4.5e-6]),
    material("grey_cast_iron", "Grey cast iron EN-GJL-250", [1.1e11, 0.26, 7200.0, 460.0, 54.0, 11e-6]),
    material("polycarbonate", "Polycarbonate", [2.4e9, 0.37, 1200.0, 1200.0, 0.2, 65e-6]),
    material("ptfe", "Polytetrafluoroethylene", [5e8, 0.46, 2170.0, 1000.0, 0.25, 130e-6]),
    material("silicon_nitride", "Hot-pressed silicon nitride", [3.1e11, 0.27, 3200.0, 700.0, 30.0, 3.2e-6]),
    material("sintered_lining", "Sintered copper-based clutch lining", [3e10, 0.25, 5500.0, 440.0, 16.0, 14e-6]),
    material("stainless_steel", "Austenitic stainless steel X5CrNi18-10", [2e11, 0.3, 7900.0, 500.0, 15.0, 16e-6]),
    material("structural_steel", "Unalloyed structural steel", [2e11, 0.3, 7800.0, 460.0, 55.0, 11e-6]),
];

pub(crate) fn find(name: &str) -> Option<&'static Material> {
    MATERIALS.iter().find(|material| material.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::variables::{check_parameter, find as find_variable};

    #[test]
    fn every_preset_is_legal_for_both_bodies_and_listed_once() {
        for pair in MATERIALS.windows(2) {
            assert!(pair[0].name < pair[1].name, "{} is out of order", pair[1].name);
        }
        for material in MATERIALS {
            assert_eq!(find(material.name), Some(material));
            for (property, value) in material.values() {
                assert!(value > 0.0, "{} {property}", material.name);
                for body in ["punch", "strip"] {
                    let reference = find_variable(&format!("{body}.{property}")).expect(property);
                    check_parameter(reference, value).unwrap();
                }
            }
        }
        assert_eq!(find("unobtainium"), None);
    }

    #[test]
    fn wave_speeds_and_volumetric_heats_are_those_of_solids() {
        // sqrt(E/rho) lies between 150 m/s (soft lining) and 11 km/s (ceramics), rho c between 1.3 and
        // 4.2 MJ/(m3.K): a slip of a power of ten in any of these columns leaves the ranges.
        for material in MATERIALS {
            let speed = (material.youngs_modulus / material.density).sqrt();
            assert!((150.0..11e3).contains(&speed), "{}: {speed} m/s", material.name);
            let volumetric_heat = material.density * material.specific_heat;
            assert!((1.3e6..4.2e6).contains(&volumetric_heat), "{}: {volumetric_heat} J/(m3.K)", material.name);
        }
    }
}
