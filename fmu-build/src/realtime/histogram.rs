//! Histogram of step times.

/// Lower bounds of the printed classes, microseconds; the last one is open.
const COARSE: [f64; 12] = [0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 10_000.0];
/// Classes per power of ten of the finer division.
const PER_DECADE: usize = 20;
/// Powers of ten of it, from 10 ns.
const DECADES: usize = 9;
/// Its lower end, microseconds.
const LOWEST: f64 = 0.01;

/// Times in ascending order.
pub(crate) struct Histogram {
    /// Nanoseconds.
    sorted: Vec<u32>,
}

impl Histogram {
    /// Of these times, nanoseconds.
    pub(crate) fn of(mut times: Vec<u32>) -> Self {
        times.sort_unstable();
        Self { sorted: times }
    }

    pub(crate) fn count(&self) -> usize {
        self.sorted.len()
    }

    /// The time that this share of all does not exceed, microseconds.
    pub(crate) fn quantile(&self, share: f64) -> f64 {
        // The share is a number of times but for rounding.
        let rank = (share * self.sorted.len() as f64 - 1e-6).ceil().max(1.0) as usize;
        microseconds(self.sorted[rank.min(self.sorted.len()) - 1])
    }

    /// The longest time, microseconds.
    pub(crate) fn longest(&self) -> f64 {
        self.sorted.last().copied().map_or(0.0, microseconds)
    }

    fn below(&self, time: f64) -> usize {
        self.sorted.partition_point(|&own| microseconds(own) < time)
    }

    /// Classes for people: from, to [microseconds], count.
    pub(crate) fn coarse(&self) -> impl Iterator<Item = (f64, f64, u64)> + '_ {
        self.classes((0..COARSE.len()).map(|at| (COARSE[at], COARSE.get(at + 1).copied().unwrap_or(f64::INFINITY))))
    }

    /// Twenty classes per power of ten: from, to [microseconds], count.
    pub(crate) fn fine(&self) -> impl Iterator<Item = (f64, f64, u64)> + '_ {
        let bound = |at: usize| LOWEST * 10f64.powf(at as f64 / PER_DECADE as f64);
        self.classes((0..PER_DECADE * DECADES).map(move |at| (if at == 0 { 0.0 } else { bound(at) }, bound(at + 1))))
    }

    fn classes<'a>(
        &'a self,
        bounds: impl Iterator<Item = (f64, f64)> + 'a,
    ) -> impl Iterator<Item = (f64, f64, u64)> + 'a {
        bounds.map(|(from, to)| (from, to, (self.below(to) - self.below(from)) as u64))
    }

    /// Points (time in microseconds, share of all that takes longer), down to one of all.
    pub(crate) fn tail(&self) -> Vec<(f64, f64)> {
        let count = self.count() as f64;
        let mut points: Vec<(f64, f64)> = self
            .fine()
            .map(|(_, to, _)| (to, 1.0 - self.below(to) as f64 / count))
            .filter(|&(_, share)| share > 0.5 / count)
            .collect();
        // Before the first that takes longer than nothing, and to the longest.
        let first = points.iter().rposition(|&(_, share)| share > 1.0 - 0.5 / count).unwrap_or(0);
        points.drain(..first);
        points.push((self.longest(), 1.0 / count));
        points
    }
}

fn microseconds(nanoseconds: u32) -> f64 {
    f64::from(nanoseconds) / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_times_that_were_taken() {
        let histogram = Histogram::of((1..=1000).rev().map(|time| 1000 * time).collect());
        assert_eq!((histogram.quantile(0.5), histogram.quantile(0.999)), (500.0, 999.0));
        assert_eq!((histogram.quantile(1.0), histogram.longest(), histogram.count()), (1000.0, 1000.0, 1000));
        assert_eq!(histogram.quantile(0.0), 1.0);
    }

    #[test]
    fn every_time_is_in_one_class() {
        let times = vec![3, 999, 1000, 2500, 4_999, 5000, 123_456, 999_999, 50_000_000, u32::MAX];
        let histogram = Histogram::of(times);
        for classes in [histogram.coarse().collect::<Vec<_>>(), histogram.fine().collect()] {
            assert_eq!(classes.iter().map(|class| class.2).sum::<u64>(), 10);
            assert!(classes.windows(2).all(|pair| pair[0].1 == pair[1].0));
        }
        let coarse: Vec<u64> = histogram.coarse().map(|class| class.2).collect();
        assert_eq!(coarse, [2, 1, 2, 1, 0, 0, 0, 1, 0, 1, 0, 2]);
    }

    #[test]
    fn the_tail_falls_from_all_to_one() {
        let tail = Histogram::of(vec![1000, 2000, 3000, 40_000]).tail();
        assert!(tail.windows(2).all(|pair| pair[0].0 <= pair[1].0 && pair[0].1 >= pair[1].1), "{tail:?}");
        assert_eq!(tail[0].1, 1.0);
        assert_eq!(tail[tail.len() - 1], (40.0, 0.25));
    }
}
