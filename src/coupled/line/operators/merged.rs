//! A contact line with its cells merged in pairs: what the cells of a plan are judged by, at the price of no new body.

use super::Operators;
use crate::coupled::line::hottest::Hottest;
use crate::coupled::line::profile::Profile;
use crate::elastic::Merging;
use crate::scene::Geometry;

impl Operators {
    /// The same contact on about half as many cells, with all matrices from these.
    pub fn merged(&self) -> Operators {
        let merging = Merging::pairs(&self.cells);
        let cells = merging.cells(&self.cells);
        let mut scene = self.scene.clone();
        scene.cells = cells.count();
        Operators {
            mean: self.mean.clone(),
            heat: self.heat.as_ref().map(|bodies| bodies.merged(&merging)),
            weights: merging.sums(&self.weights),
            // Weights of the sum over pressure cells: sums, like the weights.
            torque_weights: merging.sums(&self.torque_weights),
            radius_ratio: merging.means(&self.radius_ratio),
            radial: self.radial.each_ref().map(|rates| merging.means(rates)),
            initial_gap: merging.means(&self.initial_gap),
            normal: merging.matrix(&self.normal),
            shear: merging.matrix(&self.shear),
            displacement_scale: self.displacement_scale,
            wear: self.wear.clone(),
            strip_wear: self.strip_wear,
            profile: Profile::new(&cells),
            hottest: Hottest::new(&cells, scene.geometry == Geometry::Periodic),
            shared_depth: self.shared_depth,
            pivot: self.pivot,
            rotates: self.rotates,
            cells,
            scene,
        }
    }
}
