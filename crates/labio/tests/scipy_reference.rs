//! Spectra, coherence, windows and analogue low-pass filters, compared with SciPy's for the same
//! samples: `fixtures/reference/scipy`.

use labio::instrument::AntiAlias;
use labio::{AveragedSpectra, Detrend, Estimator, Record, Welch, Window};
use num_complex::Complex64;

use super::hits::hit;
use testbed::claim::{Claim, Claims, Fallible, Found};
use testbed::difference::{largest, relative, worst};
use testbed::hold;

const SPECTRA: &str = include_str!("../../../fixtures/reference/scipy/spectra.csv");
const FILTERS: &str = include_str!("../../../fixtures/reference/scipy/filters.csv");
const SCIPY: &str = "SciPy, fixtures/reference/scipy";

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    windows(&mut report);
    spectra(&mut report);
    low_passes(&mut report);
    hold!(report);
}

/// Values of one quantity of a reference case, in order.
fn reference(case: &str, quantity: &str) -> Fallible<Vec<Complex64>> {
    let mut values = Vec::new();
    for row in SPECTRA.lines().skip(1) {
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

/// Largest difference on any line, relative to the reference.
fn apart(found: &[Complex64], expected: &[Complex64]) -> Found {
    if found.len() != expected.len() {
        return Err(format!("{} lines, expected {}", found.len(), expected.len()).into());
    }
    let pairs = found.iter().zip(expected);
    Ok(largest(
        pairs.map(|(f, e)| if f == e { 0.0 } else { relative(*f, *e) }),
    ))
}

fn complex(values: &[f64]) -> Vec<Complex64> {
    values.iter().map(|&value| value.into()).collect()
}

fn windows(report: &mut Claims) {
    let taper = 0.3;
    let windows = [
        ("hann_periodic", Window::HannPeriodic),
        ("hann_symmetric", Window::HannSymmetric),
        ("hamming_periodic", Window::HammingPeriodic),
        ("hamming_symmetric", Window::HammingSymmetric),
        ("blackman_harris_periodic", Window::BlackmanHarrisPeriodic),
        ("blackman_harris_symmetric", Window::BlackmanHarrisSymmetric),
        ("flat_top_periodic", Window::FlatTopPeriodic),
        ("flat_top_symmetric", Window::FlatTopSymmetric),
        ("tukey_periodic", Window::TukeyPeriodic { taper }),
        ("tukey_symmetric", Window::TukeySymmetric { taper }),
    ];
    report.check(
        Claim::new("weights of ten windows, 16 and 15 samples", SCIPY)
            .within(2e-15, "some rounding errors of at most five cosines"),
        || {
            worst(windows, |(case, window)| {
                worst([16, 15], |n| {
                    let expected = reference(case, &format!("weights_{n}"))?;
                    let weights = window.sample(n)?.weights;
                    assert_eq!(weights.len(), expected.len());
                    let pairs = weights.iter().zip(&expected);
                    Ok(largest(pairs.map(|(weight, e)| weight - e.re)))
                })
            })
        },
    );
}

/// Generator of the same numbers, bit for bit, as in the script of the reference.
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

/// An input with an offset and a drift, and an output that is the input after a first-order filter,
/// with independent noise.
fn samples(n: usize) -> Fallible<Record> {
    let mut congruence = Congruence(1);
    let x: Vec<f64> = (0..n).map(|_| congruence.next()).collect();
    let drift = x.iter().enumerate();
    let x: Vec<f64> = drift.map(|(i, x)| x + 0.25 + i as f64 / 1024.0).collect();
    let mut previous = 0.0;
    let filtered = x.iter().map(|x| {
        previous = 0.5 * previous + x;
        previous + 0.25 * congruence.next()
    });
    let y: Vec<f64> = filtered.collect();
    hit(&x, &y, 2048.0)
}

/// Name of the case in the reference; numbers of samples of the record, of a segment and of the
/// overlap; window; detrending.
#[rustfmt::skip]
const CASES: [(&str, [usize; 3], Window, Detrend); 12] = [
    ("hann_periodic", [700, 64, 32], Window::HannPeriodic, Detrend::None),
    ("hann_periodic_mean", [700, 64, 32], Window::HannPeriodic, Detrend::Mean),
    ("hann_symmetric_odd", [500, 63, 31], Window::HannSymmetric, Detrend::Mean),
    ("blackman_harris_odd_linear", [500, 51, 20], Window::BlackmanHarrisPeriodic, Detrend::Linear),
    ("flat_top_mean", [600, 48, 36], Window::FlatTopPeriodic, Detrend::Mean),
    ("tukey", [333, 40, 10], Window::TukeyPeriodic { taper: 0.25 }, Detrend::None),
    ("hamming_odd", [333, 45, 22], Window::HammingPeriodic, Detrend::Mean),
    ("rectangular", [512, 64, 0], Window::Rectangular, Detrend::None),
    ("hamming_symmetric_linear_75", [411, 32, 24], Window::HammingSymmetric, Detrend::Linear),
    ("tukey_symmetric_odd_mean", [407, 33, 16], Window::TukeySymmetric { taper: 0.5 }, Detrend::Mean),
    ("flat_top_symmetric_linear", [300, 60, 40], Window::FlatTopSymmetric, Detrend::Linear),
    ("hann_periodic_linear_90", [200, 20, 18], Window::HannPeriodic, Detrend::Linear),
];

fn spectra(report: &mut Claims) {
    let mut check = |what: &str, found: &dyn Fn(&str, &AveragedSpectra) -> Found| {
        report.check(
            Claim::new(
                format!(
                    "averaged spectra in twelve combinations of window, overlap and detrending: {what}"
                ),
                SCIPY,
            )
            .within(
                1e-14,
                "transforms of 64 samples, and the weakest line compared",
            ),
            || {
                worst(CASES, |(name, [n, segment, overlap], window, detrend)| {
                    let welch = Welch::new(segment)?.with_overlap(overlap)?;
                    let welch = welch.with_window(window).with_detrend(detrend);
                    found(name, &welch.spectra(&samples(n)?)?)
                })
            },
        );
    };
    check(
        "frequencies, power densities and mean squares",
        &|name, spectra| {
            let density = |channel| spectra.power_density(channel).map(|g| complex(&g));
            let cases = [
                ("frequency", complex(spectra.frequency_hz())),
                ("gxx", density("x")?),
                ("gyy", density("y")?),
                ("mean_squares", complex(&spectra.mean_squares("x")?)),
            ];
            worst(cases, |(quantity, found)| {
                apart(&found, &reference(name, quantity)?)
            })
        },
    );
    check("cross power density", &|name, spectra| {
        apart(
            &spectra.cross_power_density("x", "y")?,
            &reference(name, "gxy")?,
        )
    });
    check("coherence", &|name, spectra| {
        let found = spectra.coherence("x", "y")?.values;
        apart(&complex(&found), &reference(name, "coherence")?)
    });
    check("H1 and H2 as ratios of its spectra", &|name, spectra| {
        let (gxx, gyy) = (reference(name, "gxx")?, reference(name, "gyy")?);
        let gxy = reference(name, "gxy")?;
        let h1: Vec<Complex64> = gxy.iter().zip(&gxx).map(|(xy, xx)| xy / xx).collect();
        let h2: Vec<Complex64> = gyy
            .iter()
            .zip(&gxy)
            .map(|(yy, xy)| yy / xy.conj())
            .collect();
        worst(
            [(Estimator::H1, h1), (Estimator::H2, h2)],
            |(estimator, expected)| {
                apart(&spectra.response(estimator, "x", "y")?.values, &expected)
            },
        )
    });
}

fn low_passes(report: &mut Claims) {
    report.check(
        Claim::new("Butterworth and Bessel filters at 10 kHz, 240 points down to 1e-9 of the passband, relative", SCIPY)
            .within(1e-13, "roots of Bessel's polynomials and the half-power frequency, each to some 1e-14"),
        || {
            assert_eq!(FILTERS.lines().count(), 241);
            worst(FILTERS.lines().skip(1), |line| {
                let cells: Vec<&str> = line.split(',').collect();
                let order: u32 = cells[1].parse()?;
                let filter = match cells[0] {
                    "butterworth" => AntiAlias::butterworth(order, 10e3),
                    _ => AntiAlias::bessel(order, 10e3),
                }?;
                let expected = Complex64::new(cells[3].parse()?, cells[4].parse()?);
                Ok(relative(filter.response(cells[2].parse()?), expected))
            })
        },
    );
}
