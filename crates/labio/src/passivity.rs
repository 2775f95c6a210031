//! Whether a driving point takes energy, line by line.
//!
//! Theory: `docs/theory/spectra.md#kinds-low-lines-causality-passivity`.

use crate::{FrequencyResponse, LabioError, LineValidity, ResponseKind};

/// What the real part of a driving-point mobility says of one line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Passivity {
    /// The real part is not negative: on the average over a period the body takes energy.
    Passive,
    /// The real part is negative, but by no more than the stated multiple of its standard error.
    WithinError,
    /// The real part is negative by more: a passive body cannot have done it. A wrong sign, a wrong delay between the channels, a
    /// point that is not the driving point, or an error that is not random has.
    Active,
    /// The line carries no information.
    Unknown,
}

/// The passivity of a driving point, line by line.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PassivityReport {
    /// Frequencies of the lines \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Real part of the mobility \[m/(N s)\]; NaN without information.
    pub real_part: Vec<f64>,
    /// Its standard error \[m/(N s)\]; NaN without information.
    pub standard_error: Vec<f64>,
    /// The verdicts.
    pub lines: Vec<Passivity>,
}

impl PassivityReport {
    /// Indices of the lines that a passive body cannot have.
    pub fn active_lines(&self) -> impl Iterator<Item = usize> + '_ {
        let lines = self.lines.iter().enumerate();
        lines
            .filter(|(_, verdict)| **verdict == Passivity::Active)
            .map(|(line, _)| line)
    }
}

impl FrequencyResponse {
    /// Compares the real part of the mobility with zero. Of a body without a source of energy it is nowhere negative,
    /// $`\mathrm{Re}\,Y(i\omega) \ge 0`$, if force and motion are of the same point and direction and the force is
    /// positive where it does work on a positive motion; on the line $`s = \sigma + i\omega`$ of an exponential window as well.
    ///
    /// `coverage` is the number of standard errors that are allowed, and $`\sqrt{\mathrm{Var}/2}`$ the standard error of the real part.
    /// With 2, of lines whose real part is zero one in 44 is flagged by chance; more if the variance is from few hits, as by Student's
    /// law with 2(n-1) degrees of freedom (of 5 hits one in 18). Each of the six kinds may be given.
    ///
    /// # Errors
    ///
    /// [`LabioError::NoResponseKind`], [`LabioError::TooFewAverages`] for a response without variance,
    /// [`LabioError::NonPhysical`] for a coverage that is negative or not finite.
    pub fn passivity(&self, coverage: f64) -> Result<PassivityReport, LabioError> {
        if !(coverage.is_finite() && coverage >= 0.0) {
            return Err(LabioError::NonPhysical {
                quantity: "coverage [standard errors]",
                value: coverage,
                expected: "a finite value, not negative",
            });
        }
        let mobility = self.to_kind(ResponseKind::Mobility)?;
        let Some(variances) = mobility.variance else {
            return Err(LabioError::TooFewAverages {
                estimate: "the passivity of a driving point",
                found: self.n_averages,
                expected: 2,
            });
        };
        let real_part: Vec<f64> = mobility.values.iter().map(|value| value.re).collect();
        let standard_error: Vec<f64> = variances.iter().map(|v| (v / 2.0).sqrt()).collect();
        let lines = mobility
            .validity
            .iter()
            .zip(real_part.iter().zip(&standard_error))
            .map(|(validity, (real, error))| {
                if *validity != LineValidity::Valid {
                    Passivity::Unknown
                } else if *real >= 0.0 {
                    Passivity::Passive
                } else if *real >= -coverage * error {
                    Passivity::WithinError
                } else {
                    Passivity::Active
                }
            })
            .collect();
        Ok(PassivityReport {
            frequency_hz: mobility.frequency_hz,
            real_part,
            standard_error,
            lines,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AveragedSpectra, Channel, Provenance, Quantity, Record, Window};
    use ndarray::Array2;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Hits on a damper of mobility `mobility` whose velocity comes `delay` samples late, with noise of level `noise` on it.
    fn damper(mobility: f64, delay: usize, noise: f64) -> AveragedSpectra {
        let n = 256;
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let channels = vec![
            Channel::new("force", Quantity::Force).unwrap(),
            Channel::new("velocity", Quantity::Velocity).unwrap(),
        ];
        let hits: Vec<Record> = (0..8)
            .map(|_| {
                let mut samples = Array2::zeros((2, n));
                samples[(0, 0)] = 1.0;
                for i in 0..n {
                    let unit: f64 = StandardNormal.sample(&mut rng);
                    samples[(1, i)] = noise * unit;
                }
                samples[(1, delay)] += mobility;
                let provenance = Provenance::computed("damper");
                Record::new(samples, 256.0, 0.0, channels.clone(), provenance).unwrap()
            })
            .collect();
        AveragedSpectra::of(&hits, Window::Rectangular).unwrap()
    }

    #[test]
    fn a_damper_is_passive_and_its_negative_is_not() {
        let count = |mobility, delay| {
            let response = damper(mobility, delay, 1e-6).h1("force", "velocity");
            let report = response.unwrap().passivity(2.0).unwrap();
            report.active_lines().count()
        };
        assert_eq!(count(2.0, 0), 0);
        assert_eq!(count(-2.0, 0), 129);
        // late by one sample: the phase is behind by more than a right angle above half the Nyquist frequency
        let response = damper(2.0, 1, 1e-6).h1("force", "velocity").unwrap();
        let report = response.passivity(2.0).unwrap();
        for (f, verdict) in report.frequency_hz.iter().zip(&report.lines) {
            if *f < 63.5 {
                assert_eq!(*verdict, Passivity::Passive, "{f} Hz");
            } else if *f > 64.5 {
                assert_eq!(*verdict, Passivity::Active, "{f} Hz");
            }
        }
    }

    #[test]
    fn nothing_but_noise_is_flagged_as_often_as_the_coverage_says() {
        let response = damper(0.0, 0, 1.0).h1("force", "velocity").unwrap();
        let report = response.passivity(0.0).unwrap();
        let active = report.active_lines().count() as f64 / 129.0;
        // half of the lines, binomial standard error 0.044: four of these
        assert!((active - 0.5).abs() < 0.18, "{active}");
        let report = response.passivity(2.0).unwrap();
        let active = report.active_lines().count() as f64 / 129.0;
        // Student's t with 14 degrees of freedom beyond 2 sqrt(7/8): 4.1 %, standard error 1.7 %; four of these: 11 %
        assert!(active < 0.11, "{active}");
        assert!(report.lines.contains(&Passivity::WithinError));
    }

    #[test]
    fn every_kind_gives_the_same_verdicts_and_one_hit_none() {
        let response = damper(2.0, 1, 0.1).h1("force", "velocity").unwrap();
        let direct = response.passivity(2.0).unwrap();
        let dynamic_mass = response.to_kind(ResponseKind::DynamicMass).unwrap();
        let by_mass = dynamic_mass.passivity(2.0).unwrap();
        assert_eq!(direct.lines[1..], by_mass.lines[1..]);
        assert_eq!(by_mass.lines[0], Passivity::Unknown);
        let mut single = response.clone();
        single.variance = None;
        assert!(single.passivity(2.0).is_err() && response.passivity(-1.0).is_err());
    }
}
