use super::*;
use crate::ratio::variance_from_coherence;
use testbed::noise::Noise;

const LINES: usize = 300;

/// Returns Ψ of a rod of low loss: |Ψ| is between 0.15 and 1.2, with a resonance every 60 lines.
fn ratio_of(line: usize) -> Complex64 {
    let x = Complex64::new(0.15 + 1e-3 * line as f64, 0.052 * line as f64);
    x.cosh()
}

/// Ψ, its variance from the coherence, and G₂₂, for hits whose spectra are drawn directly: signals
/// of given power, and noise of given power in both channels, on every line.
struct Hits {
    ratio: Vec<Complex64>,
    variance: Vec<f64>,
    power: Vec<f64>,
    averages: f64,
}

impl Hits {
    fn drawn(seed: u64, count: usize, noise: impl Fn(usize) -> [f64; 2]) -> Self {
        let mut random = Noise::seeded(seed);
        let mut circular = |power: f64| -> Complex64 {
            let mut normal = || random.normal();
            Complex64::new(normal(), normal()) * (0.5 * power).sqrt()
        };
        let (mut ratio, mut coherence, mut power) = (Vec::new(), Vec::new(), Vec::new());
        for line in 0..LINES {
            let (mut cross, mut first, mut second) = (Complex64::ZERO, 0.0, 0.0);
            for _ in 0..count {
                let force = circular(1.0) + 2.0;
                let [of_first, of_second] = noise(line).map(&mut circular);
                let (a, b) = (ratio_of(line) * force + of_first, force + of_second);
                cross += a * b.conj();
                first += a.norm_sqr();
                second += b.norm_sqr();
            }
            ratio.push(cross / second);
            coherence.push(cross.norm_sqr() / (first * second));
            power.push(second / count as f64);
        }
        let averages = count as f64;
        let variance = variance_from_coherence(&ratio, &coherence, averages).unwrap();
        Self {
            ratio,
            variance,
            power,
            averages,
        }
    }

    fn pooled(&self) -> PooledVariance {
        self.by_lines(1.0)
    }

    fn by_lines(&self, lines_per_independent_line: f64) -> PooledVariance {
        AveragedVariance {
            ratio: &self.ratio,
            variance: &self.variance,
            denominator_power: &self.power,
            averages: self.averages,
            lines_per_independent_line,
        }
        .pooled()
        .unwrap()
    }

    /// Returns the ratio of the stated to the true variance of a line.
    fn quotient(&self, pooled: &PooledVariance, line: usize, noise: [f64; 2]) -> f64 {
        let power = noise[0] + ratio_of(line).norm_sqr() * noise[1];
        pooled.variance[line] * self.averages * self.power[line] / power
    }
}

/// Checks means over lines and records: the mean ratio of stated to true variance is 1, with the
/// scatter 2/ν of the stated degrees of freedom.
#[test]
fn r14_pooled_variances_scatter_as_their_degrees_of_freedom_say() {
    for (count, records) in [(2, 40), (3, 40), (4, 30), (10, 20)] {
        let (mut mean, mut scatter, mut said, mut n) = (0.0, 0.0, 0.0, 0.0);
        for seed in 0..records {
            let noise = [4e-6, 1e-6];
            let hits = Hits::drawn(seed, count, |_| noise);
            let pooled = hits.pooled();
            for line in 0..LINES {
                let quotient = hits.quotient(&pooled, line, noise);
                // leaves out the few lines that keep their own variance
                if pooled.freedom[line].line > 2.5 * hits.averages {
                    mean += quotient;
                    scatter += (quotient - 1.0).powi(2);
                    said += 2.0 / pooled.freedom[line].line;
                    n += 1.0;
                }
            }
        }
        let all = f64::from(u32::try_from(records).unwrap()) * LINES as f64;
        assert!(n > 0.95 * all, "{count}: {n} of {all}");
        // tolerance: a standard error of 1 % of the mean of 20 or more records of 300 lines, and a
        // bias of 2 % because the fit does not allow negative noise
        assert!((mean / n - 1.0).abs() < 0.04, "{count}: {}", mean / n);
        assert!(
            (scatter / said - 1.0).abs() < 0.25,
            "{count}: {scatter} {said}"
        );
        // A fit uses ceil(80/ν) lines with ν = 2(n - 1) degrees of freedom each: 80 degrees of
        // freedom for three hits and 90 for ten. If one coefficient is 0, the other has all of
        // them; if both are fitted, each has half of them on average. The lower limit is 20 % below
        // this half because of the lines at both ends
        let freedom = 2.0 * n / said;
        let alone = 2.0 * (count as f64 - 1.0);
        let most = alone * (80.0 / alone).ceil();
        assert!(
            freedom > 0.4 * most && freedom < most * (1.0 + 1e-9),
            "{count}: {freedom} of at most {most}"
        );
    }
}

/// Mains noise: a line whose noise is a hundred times that of the other lines keeps its own
/// variance and does not affect its neighbours.
#[test]
fn r14_a_line_with_noise_of_its_own_is_not_pooled() {
    let noise = |line: usize| {
        if line == 100 {
            [1e-3, 0.0]
        } else {
            [1e-5, 0.0]
        }
    };
    for seed in 0..20 {
        let hits = Hits::drawn(seed, 4, noise);
        let pooled = hits.pooled();
        if hits.variance[100] * hits.power[100] < 20.0 * 1e-5 / 4.0 {
            continue; // the noise of line 100 is by chance no larger than on other lines
        }
        assert!((pooled.variance[100] / hits.variance[100] - 1.0).abs() < 1e-12);
        assert!((pooled.freedom[100].line - 6.0).abs() < 1e-12);
        let beside = hits.quotient(&pooled, 102, noise(102));
        assert!((0.3..2.5).contains(&beside), "{beside}");
        // each line contributes its own 2(n - 1) = 6 degrees of freedom
        assert!(
            pooled
                .freedom
                .iter()
                .all(|freedom| (freedom.own - 6.0).abs() < 1e-12)
        );
    }
}

/// Lines keep their own variance if the noise changes from line to line, because the neighbours
/// then contain no information about it.
#[test]
fn r14_lines_with_rough_noise_keep_their_own() {
    let hits = Hits::drawn(1, 10, |line| [if line % 4 < 2 { 1e-5 } else { 5e-5 }, 0.0]);
    let pooled = hits.pooled();
    let kept = pooled.freedom.iter().filter(|f| f.line < 18.5).count();
    assert!(kept > LINES / 4, "{kept}");
    // 30 averages have more than 40 degrees of freedom on each line: nothing is pooled
    let many = Hits::drawn(2, 30, |_| [1e-5, 0.0]);
    assert_eq!(many.pooled().variance, many.variance);
    // one independent line in four: a line contributes a quarter of its 2(n - 1) = 4 degrees of
    // freedom
    let few = Hits::drawn(3, 3, |_| [1e-5, 0.0]);
    assert!((few.by_lines(4.0).freedom[50].own - 1.0).abs() < 1e-12);
}

#[test]
fn lines_without_noise_and_wrong_arrays_are_told() {
    let ratio = [Complex64::ONE; 6];
    let given = AveragedVariance {
        ratio: &ratio,
        variance: &[0.0, f64::INFINITY, 0.0, 0.0, 0.0, 0.0],
        denominator_power: &[1.0; 6],
        averages: 3.0,
        lines_per_independent_line: 1.0,
    };
    assert_eq!(given.pooled().unwrap().variance, given.variance);
    let text = |given: AveragedVariance<'_>| given.pooled().unwrap_err().to_string();
    assert_eq!(
        text(AveragedVariance {
            averages: 1.0,
            ..given
        }),
        "number of averages is 1, expected at least 2: the coherence of a single average is always 1"
    );
    assert_eq!(
        text(AveragedVariance {
            denominator_power: &[1.0; 5],
            ..given
        }),
        "powers of the denominator: found 5, expected 6"
    );
    assert_eq!(
        text(AveragedVariance {
            lines_per_independent_line: 0.5,
            ..given
        }),
        "lines per independent line is 0.5, expected 1 or more"
    );
}
