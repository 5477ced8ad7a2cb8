//! Curves through values at few stations, as they are drawn.

/// Points of a curve over the contact at least: more cannot be seen.
pub(crate) const CONTACT_POINTS: usize = 257;

/// Monotone cubic interpolation (Fritsch and Carlson) at the stations and equally spaced between neighbouring ones, at least `count`
/// points: a curve through values at few stations that has no extremes of its own.
pub(crate) fn monotone_cubic(x: &[f64], y: &[f64], count: usize) -> (Vec<f64>, Vec<f64>) {
    if x.len() < 2 {
        return (x.to_vec(), y.to_vec());
    }
    let last = x.len() - 1;
    let secant: Vec<f64> = (0..last).map(|at| (y[at + 1] - y[at]) / (x[at + 1] - x[at])).collect();
    let slope = |at: usize| match at {
        0 => secant[0],
        _ if at == last => secant[last - 1],
        _ if secant[at - 1] * secant[at] <= 0.0 => 0.0,
        // Harmonic mean: within the monotone region.
        _ => 2.0 * secant[at - 1] * secant[at] / (secant[at - 1] + secant[at]),
    };
    let parts = (count - 1).div_ceil(last).max(1);
    let point = |index: usize| {
        let cell = (index / parts).min(last - 1);
        let t = (index - cell * parts) as f64 / parts as f64;
        let width = x[cell + 1] - x[cell];
        let (left, right) = (width * slope(cell), width * slope(cell + 1));
        let rise = y[cell + 1] - y[cell];
        let value = y[cell] + t * (left + t * ((3.0 * rise - 2.0 * left - right) + t * (left + right - 2.0 * rise)));
        (x[cell] + t * width, value)
    };
    (0..=parts * last).map(point).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_station_stays() {
        assert_eq!(monotone_cubic(&[1.0], &[2.0], CONTACT_POINTS), (vec![1.0], vec![2.0]));
    }

    #[test]
    fn a_smoothed_curve_keeps_its_stations_and_has_no_extremes_of_its_own() {
        // Stations that lie closer at the end.
        let x: Vec<f64> = (0..33).map(|at| f64::from(at) * (64.0 - f64::from(at)) / 32.0).collect();
        let y: Vec<f64> = x.iter().map(|x| if *x < 10.0 { 0.0 } else { (0.3 * x).sin().abs() }).collect();
        let (positions, values) = monotone_cubic(&x, &y, 32 * 8 + 1);
        for station in 0..33 {
            assert!((positions[8 * station] - x[station]).abs() < 1e-12);
            assert!((values[8 * station] - y[station]).abs() < 1e-12);
        }
        for (at, value) in values.iter().enumerate() {
            let cell = (at / 8).min(31);
            let (low, high) = (y[cell].min(y[cell + 1]), y[cell].max(y[cell + 1]));
            assert!((low - 1e-12..=high + 1e-12).contains(value), "{at}: {value}");
        }
    }
}
