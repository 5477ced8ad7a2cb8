//! Panels through a layer, graded geometrically towards one face.
//!
//! Theory: docs/theory.md, section 4.2.

/// Least first panel over the height of the layer: a field that decays faster affects less than 1e-8 of the layer.
pub const LEAST_PANEL: f64 = 1e-8;

/// Edges from the face (0) to less than half of `height`: the first panel has the length `shortest`, or [`LEAST_PANEL`] of the
/// height where that is larger or `shortest` is NaN, and each edge is `ratio` (> 1) times as far from the face as the one
/// before. At most 1 + ln(1/(2 LEAST_PANEL))/ln(ratio) edges.
pub fn towards_face(shortest: f64, height: f64, ratio: f64) -> Vec<f64> {
    let first = if shortest > LEAST_PANEL * height { shortest } else { LEAST_PANEL * height };
    let most = (0.5 / LEAST_PANEL).ln() / ratio.ln();
    let graded = std::iter::successors(Some(first), |edge| Some(edge * ratio)).take(most.ceil() as usize + 1);
    std::iter::once(0.0).chain(graded.take_while(|edge| *edge < 0.5 * height)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_grow_from_the_shortest_to_half_of_the_height_and_are_always_few() {
        assert_eq!(towards_face(0.1, 1.0, 2.0), [0.0, 0.1, 0.2, 0.4]);
        assert_eq!(towards_face(0.7, 1.0, 2.0), [0.0]);
        for shortest in [0.0, 1e-300, f64::NAN, -1.0] {
            let edges = towards_face(shortest, 2.0, 3.0);
            assert!(edges.len() <= 18 && edges[1] == 2.0 * LEAST_PANEL, "{shortest}: {edges:?}");
        }
    }
}
