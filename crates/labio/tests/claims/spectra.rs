//! Averaged spectra: SciPy's of the same samples, Parseval's theorem, closed forms, the law of their scatter.

use std::f64::consts::TAU;

use labio::{
    AddedDamping, AveragedSpectra, Channel, Detrend, Estimator, Quantity, Record, SpectrumAverager,
    Welch, Window,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::hits::{hit, mean, noise, record};
use testbed::claim::{Claim, Claims, Fallible, Found};
use testbed::difference::{largest, worst};
use testbed::hold;

const REFERENCE: &str = include_str!("../../../../fixtures/reference/scipy/spectra.csv");
const SCIPY: &str = "SciPy, fixtures/reference/scipy";

/// The values of a quantity of a case of the reference, in order.
pub(super) fn reference(case: &str, quantity: &str) -> Fallible<Vec<Complex64>> {
    let mut values = Vec::new();
    for row in REFERENCE.lines().skip(1) {
        if let [name, of, _, re, im] = row.split(',').collect::<Vec<_>>()[..]
            && name == case
            && of == quantity
        {
            values.push(Complex64::new(re.parse()?, im.parse()?));
        }
    }
    if values.is_empty() {
        return Err(format!("no {quantity} of {case} in the reference").into());
    }
    Ok(values)
}

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    scipy(&mut report);
    closed_forms(&mut report);
    analyser(&mut report);
    scatter(&mut report);
    hold!(report);
}

/// The numbers that the script of the reference makes too, bit for bit.
struct Congruence(u64);

impl Congruence {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// An input with an offset and a drift, and the input through a filter of first order with noise of its own.
fn samples(n: usize) -> Fallible<Record> {
    let mut congruence = Congruence(1);
    let x: Vec<f64> = (0..n).map(|_| congruence.next()).collect();
    let x: Vec<f64> = x
        .iter()
        .enumerate()
        .map(|(i, x)| x + 0.25 + i as f64 / 1024.0)
        .collect();
    let mut previous = 0.0;
    let y: Vec<f64> = x
        .iter()
        .map(|x| {
            previous = 0.5 * previous + x;
            previous + 0.25 * congruence.next()
        })
        .collect();
    hit(&x, &y, 2048.0)
}

/// Name in the reference, samples of the record, of a segment, of the overlap, window, detrending.
type Case = (&'static str, usize, usize, usize, Window, Detrend);

const CASES: [Case; 8] = [
    (
        "hann_periodic",
        700,
        64,
        32,
        Window::HannPeriodic,
        Detrend::None,
    ),
    (
        "hann_periodic_mean",
        700,
        64,
        32,
        Window::HannPeriodic,
        Detrend::Mean,
    ),
    (
        "hann_symmetric_odd",
        500,
        63,
        31,
        Window::HannSymmetric,
        Detrend::Mean,
    ),
    (
        "blackman_harris_odd_linear",
        500,
        51,
        20,
        Window::BlackmanHarrisPeriodic,
        Detrend::Linear,
    ),
    (
        "flat_top_mean",
        600,
        48,
        36,
        Window::FlatTopPeriodic,
        Detrend::Mean,
    ),
    (
        "tukey",
        333,
        40,
        10,
        Window::TukeyPeriodic { taper: 0.25 },
        Detrend::None,
    ),
    (
        "hamming_odd",
        333,
        45,
        22,
        Window::HammingPeriodic,
        Detrend::Mean,
    ),
    (
        "rectangular",
        512,
        64,
        0,
        Window::Rectangular,
        Detrend::None,
    ),
];

/// Largest difference of a line, relative to it.
fn apart(found: &[Complex64], expected: &[Complex64]) -> f64 {
    if found.len() != expected.len() {
        return f64::NAN;
    }
    largest(
        found
            .iter()
            .zip(expected)
            .map(|(f, e)| (f - e).norm() / e.norm()),
    )
}

fn complex(values: &[f64]) -> Vec<Complex64> {
    values.iter().map(|&value| value.into()).collect()
}

fn scipy(report: &mut Claims) {
    let why = "transforms of 64 samples, the weakest line 1e-4 of the strongest";
    for case in CASES {
        let (name, n, segment, overlap, window, detrend) = case;
        let spectra = || -> Fallible<AveragedSpectra> {
            let welch = Welch::new(segment)?
                .with_overlap(overlap)?
                .with_window(window)
                .with_detrend(detrend);
            Ok(welch.spectra(&samples(n)?)?)
        };
        let title = name.replace('_', " ");
        let mut check = |what: &str, tolerance: f64, found: &dyn Fn(&AveragedSpectra) -> Found| {
            report.check(
                Claim::new(format!("{title}: {what}"), SCIPY).within(tolerance, why),
                || found(&spectra()?),
            );
        };
        check("power densities of both channels", 1e-12, &|spectra| {
            Ok(largest([
                apart(
                    &complex(&spectra.power_density("x")?),
                    &reference(name, "gxx")?,
                ),
                apart(
                    &complex(&spectra.power_density("y")?),
                    &reference(name, "gyy")?,
                ),
            ]))
        });
        check("cross power density", 1e-12, &|spectra| {
            let found = spectra.cross_power_density("x", "y")?;
            Ok(apart(&found, &reference(name, "gxy")?))
        });
        check("coherence", 1e-12, &|spectra| {
            let found = spectra.coherence("x", "y")?.values;
            Ok(apart(&complex(&found), &reference(name, "coherence")?))
        });
        check("H1 and H2 from its spectra", 2e-12, &|spectra| {
            let (gxx, gyy) = (reference(name, "gxx")?, reference(name, "gyy")?);
            let gxy = reference(name, "gxy")?;
            let h1: Vec<Complex64> = gxy.iter().zip(&gxx).map(|(xy, xx)| xy / xx).collect();
            let h2: Vec<Complex64> = gyy
                .iter()
                .zip(&gxy)
                .map(|(yy, xy)| yy / xy.conj())
                .collect();
            Ok(largest([
                apart(&spectra.response(Estimator::H1, "x", "y")?.values, &h1),
                apart(&spectra.response(Estimator::H2, "x", "y")?.values, &h2),
            ]))
        });
    }
}

fn closed_forms(report: &mut Claims) {
    report.check(
        Claim::new(
            "energy of 200 and 201 random samples by their lines, relative",
            "Parseval's theorem",
        )
        .within(1e-13, "200 terms of one sign"),
        || {
            worst([200, 201], |n| {
                let rate = 1234.0;
                let mut rng = ChaCha8Rng::seed_from_u64(1);
                let x = noise(&mut rng, n, 1.0);
                let energy: f64 = x.iter().map(|x| x * x).sum::<f64>() / rate;
                let spectra = AveragedSpectra::of([&hit(&x, &x, rate)?], Window::Rectangular)?;
                let lines: f64 = spectra.auto("x")?.iter().sum();
                Ok(lines * spectra.line_spacing_hz() / energy - 1.0)
            })
        },
    );
    for (name, window) in [
        ("rectangular", Window::Rectangular),
        ("Hann", Window::HannPeriodic),
    ] {
        report.check(
            Claim::new(
                format!("amplitude of a sine of 3 through the coherent gain, {name} window"),
                "closed form",
            )
            .expects(3.0, "m/s")
            .within_part(1e-13, "rounding"),
            || {
                let (n, rate, line) = (64, 32.0, 5);
                let sine: Vec<f64> = (0..n)
                    .map(|i| 3.0 * (TAU * (line * i) as f64 / n as f64 + 0.4).sin())
                    .collect();
                let spectra = AveragedSpectra::of([&hit(&sine, &sine, rate)?], window)?;
                let sampled = window.sample(n)?;
                let peak = spectra.auto("y")?[line];
                let duration = n as f64 / rate;
                Ok((2.0 * peak * sampled.power_gain).sqrt() / (duration * sampled.coherent_gain))
            },
        );
    }
    report.check(
        Claim::new(
            "exponential window: spectrum on the line σ + iω, relative to its largest",
            "direct sum of the damped transform",
        )
        .within(1e-13, "forty terms"),
        || {
            let (n, rate, sigma) = (40, 10.0, 1.5);
            let mut rng = ChaCha8Rng::seed_from_u64(22);
            let x = noise(&mut rng, n, 1.0);
            let hit = record(&[("x", Quantity::Velocity, &x)], rate)?;
            let mut averager = SpectrumAverager::for_records_like(&hit, Window::Rectangular)?
                .with_exponential_window(AddedDamping::new(sigma)?)?;
            averager.add(&hit)?;
            let spectra = averager.spectra()?;
            let auto = spectra.auto("x")?;
            let peak = largest(auto.iter().copied());
            Ok(largest(spectra.frequency_hz().iter().zip(&auto).map(
                |(f, g)| {
                    let s = Complex64::new(sigma, TAU * f);
                    let laplace: Complex64 = (0..n)
                        .map(|i| x[i] * (-s * i as f64 / rate).exp() / rate)
                        .sum();
                    let sides = if *f <= 0.0 || *f >= rate / 2.0 {
                        1.0
                    } else {
                        2.0
                    };
                    (g - sides * laplace.norm_sqr()) / peak
                },
            )))
        },
    );
}

/// The analyser of paper E, section 3.1: 4096 samples, whose period is printed as 28 ms.
fn analyser(report: &mut Claims) {
    const SOURCE: &str = "paper E, section 3.1, with the erratum 28 µs for 28 ms";
    let silence = || -> Fallible<Record> {
        let mut impulse = vec![0.0; 4096];
        impulse[0] = 1.0;
        hit(&impulse, &impulse, 1.0 / 28e-6)
    };
    report.check(
        Claim::new("record of the mobility tests: duration", SOURCE)
            .expects(0.115, "s")
            .within(5e-4, "half the last printed digit"),
        || Ok(silence()?.duration()),
    );
    report.check(
        Claim::new(
            "record of the mobility tests: end of the lower half of the lines",
            SOURCE,
        )
        .expects(8900.0, "Hz")
        .within(50.0, "half the last printed digit"),
        || {
            let spectra = AveragedSpectra::of([&silence()?], Window::Rectangular)?;
            Ok(0.5 * spectra.frequency_hz().last().copied().unwrap_or(f64::NAN))
        },
    );
}

fn scatter(report: &mut Claims) {
    const HITS: u32 = 10;
    // 2nG/E[G] is χ² with 2n degrees of freedom; 4095 independent lines, four standard errors of each moment
    let relative = || -> Fallible<Vec<f64>> {
        let (n, rate) = (8192, 1000.0);
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let channels = [Channel::new("x", Quantity::Velocity)?];
        let mut averager = SpectrumAverager::new(&channels, n, rate, Window::Rectangular)?;
        for _ in 0..HITS {
            let x = noise(&mut rng, n, 1.0);
            averager.add(&record(&[("x", Quantity::Velocity, &x)], rate)?)?;
        }
        let expected = 2.0 / rate * n as f64 / rate;
        let auto = averager.spectra()?.auto("x")?;
        Ok(auto[1..n / 2].iter().map(|g| g / expected).collect())
    };
    report.check(
        Claim::new(
            "white noise, ten hits: mean of the spectrum by its density",
            "χ² with 20 degrees of freedom",
        )
        .expects(1.0, "1")
        .within(4.0 * 0.0049, "four standard errors over 4095 lines"),
        || Ok(mean(&relative()?)),
    );
    report.check(
        Claim::new(
            "white noise, ten hits: relative variance of a line",
            "χ² with 20 degrees of freedom: 1/n",
        )
        .expects(0.1, "1")
        .within(4.0 * 0.0025, "four standard errors over 4095 lines"),
        || {
            let squares: Vec<f64> = relative()?.iter().map(|g| (g - 1.0).powi(2)).collect();
            Ok(mean(&squares))
        },
    );
    report.check(
        Claim::new(
            "random error of an auto-spectrum of ten hits",
            "closed form 1/√n",
        )
        .expects(0.1_f64.sqrt(), "1")
        .within_part(1e-14, "rounding"),
        || {
            let x = noise(&mut ChaCha8Rng::seed_from_u64(8), 64, 1.0);
            let hit = hit(&x, &x, 100.0)?;
            let hits: Vec<&Record> = (0..HITS).map(|_| &hit).collect();
            Ok(AveragedSpectra::of(hits, Window::Rectangular)?.auto_random_error())
        },
    );
}
