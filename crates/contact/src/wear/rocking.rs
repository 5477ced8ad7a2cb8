//! Limit of the lever mu H above which wear in reciprocating sliding increases the tilt of the punch without bound.
//!
//! Theory: docs/theory.md, section 9.2.

/// Largest lever mu H, in half-widths, at which pressures of a steady reciprocating cycle can be in equilibrium, for wear with
/// the pressure exponent b and equal half-strokes: 1/2 for b >= 1, and for b < 1
///
/// ```text
/// L = 1/(1 + sqrt(2 I)),   I = integral_0^1 [(1-y)^q + (1+y)^q]^(1/q) dy,   q = b/(b-1)
/// ```
///
/// 0.5505 at b = 0.5. From force, moment and uniform wear alone: with `u = p+(x) = p-(-x)` and `w = p-(x)`, x > 0, wear
/// is uniform where `u^b + w^b = c`, and the lever `integral x (u - w)/integral (u + w)` is largest where every x
/// maximises `(x - L) u - (x + L) w` on that curve: u alone beyond L; within it, for b >= 1, u alone again (the curve
/// is concave to the origin), for b < 1 the minimum of `(L - x) u + (L + x) w`, by Hoelder's inequality. The sum of
/// these maxima is 0: `(1 - L)^2/2 = L^2 I`.
///
/// At this lever no cycle exists for any pair of bodies. Below it, and above 1/2 where b < 1, existence depends on the elasticity
/// of the bodies, which has to permit both pressures on one shape.
pub fn rocking_limit(exponent: f64) -> f64 {
    if exponent >= 1.0 {
        return 0.5;
    }
    let q = exponent / (exponent - 1.0);
    let mean = |y: f64| {
        // Scaled by the smaller base, which has the larger power: q < 0.
        let ratio = (1.0 + y) / (1.0 - y);
        (1.0 - y) * (1.0 + ratio.powf(q)).powf(1.0 / q)
    };
    // Midpoint rule in y = 1 - t^3: the integrand has at most a root of (1 - y) beside smooth terms.
    let count = 2000;
    let integral: f64 = (0..count)
        .map(|i| {
            let t = (f64::from(i) + 0.5) / f64::from(count);
            3.0 * t * t * mean(1.0 - t * t * t) / f64::from(count)
        })
        .sum();
    1.0 / (1.0 + (2.0 * integral).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_and_limits() {
        assert_eq!((rocking_limit(1.0), rocking_limit(3.0)), (0.5, 0.5));
        // b = 1/2: q = -1, the harmonic sum (1 - y^2)/2, whose integral is 1/3.
        assert!((rocking_limit(0.5) - 1.0 / (1.0 + (2.0f64 / 3.0).sqrt())).abs() < 1e-6);
        assert!((rocking_limit(1.0 - 1e-9) - 0.5).abs() < 1e-6);
        let falling: Vec<f64> = [0.3, 0.5, 0.7, 0.9].map(rocking_limit).to_vec();
        assert!(falling.windows(2).all(|pair| pair[0] > pair[1]), "{falling:?}");
    }

    #[test]
    fn no_pair_of_pressures_that_wears_evenly_has_a_larger_lever() {
        // Grid search: every cell takes the optimal point of the curve for the current lever.
        for b in [0.3, 0.5, 0.8, 1.0, 2.0] {
            let (cells, points) = (200, 500);
            let mut lever = 0.3;
            for _ in 0..8 {
                let (mut moment, mut load) = (0.0, 0.0);
                for cell in 0..cells {
                    let x = (f64::from(cell) + 0.5) / f64::from(cells);
                    let curve = (0..=points).map(|i| f64::from(i) / f64::from(points)).map(|share: f64| {
                        let (u, w) = (share.powf(1.0 / b), (1.0 - share).powf(1.0 / b));
                        (x * (u - w), u + w)
                    });
                    let value = |&(moment, load): &(f64, f64)| moment - lever * load;
                    let best = curve.max_by(|a, b| value(a).total_cmp(&value(b))).unwrap();
                    moment += best.0;
                    load += best.1;
                }
                lever = moment / load;
            }
            assert!((lever - rocking_limit(b)).abs() < 2e-4, "b {b}: {lever} {}", rocking_limit(b));
        }
    }
}
