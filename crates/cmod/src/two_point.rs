//! Two-point method: the modulus from the accelerations of the two ends of an impacted specimen.
//!
//! A rod hangs from thin cords, is struck at one end, and carries an accelerometer of mass m at
//! each end (Ödeen 1993, paper A). Beyond the accelerometer of the free end there is no force.
//! Therefore (eq. 1)
//!
//! ```text
//! Ψ = â₁/â₂ = cosh γL + μ γL sinh γL ,    μ = m/(ρAL)
//! ```
//!
//! where â₁ belongs to the **impacted** end and â₂ to the **free** end: the denominator is the end
//! with the known boundary condition. A heavy accelerometer at the impacted end changes the impact,
//! but not the ratio.
//!
//! Theory: `docs/theory/two-point-method.md`.

mod averages;
mod end_mass;
mod specimen;

pub use averages::{AveragedRatio, variance_from_coherence};
pub use end_mass::{EndMassEquation, EndMassRoot, MOST_NEWTON_STEPS, MassSeries};
pub use specimen::{Specimen, SpecimenUncertainty};

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::medium::modulus_from_propagation;

use crate::branch::ResolvedRoot;
use crate::complex_frequency::ComplexFrequency;
use crate::error::CmodError;
use crate::estimate::{
    Acceptance, ComplexCovariance, ErrorSource, Method, ModulusEstimate, ModulusLine, Refusal,
    Solution, SystematicShift, VarianceFreedom,
};
use crate::section_ratio::{self, MeasuredRatio, RatioAbout, RatioLines, RatioMethod, ratio_error};
use crate::validity::{AcceptanceLimits, Violation, conditions};
use end_mass::Slopes;

/// Solution method for equation 1 at one line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Solver {
    /// Continuation in the mass ratio. It follows the branch even at low losses. Where two roots
    /// come near each other, the root nearest to the value expected from all lines together is
    /// used.
    #[default]
    Continuation,
    /// Newton's iteration from the solution without end mass, as printed (paper A, eq. 5). It is
    /// kept for comparison: at low losses it converges on some lines to a wrong root, which
    /// conditions (i)-(iii) do not always reveal.
    Newton,
    /// Series in the mass ratio to four terms (paper A, eqs. 6-7), valid where the results of two
    /// and of four terms differ by at most one third.
    Series,
}

/// Two-point method for one specimen (paper A).
///
/// ```
/// use cmod::{Specimen, TwoPoint};
/// use num_complex::Complex64;
///
/// // Test 6 of paper A: polypropylene, 16 mm by 800 mm
/// let specimen = Specimen { length: 0.799, diameter: 0.0158, density: 912.0, accelerometer_mass: 2.9e-3 };
/// let frequency_hz = [500.0, 510.0, 520.0];
/// let acceleration_ratio = [
///     Complex64::new(0.0116, 0.1001),
///     Complex64::new(-0.0202, 0.1019),
///     Complex64::new(-0.0519, 0.1035),
/// ];
/// let estimate = TwoPoint::new(specimen)?.estimate(&frequency_hz, &acceleration_ratio, &[1e-6; 3])?;
/// for line in estimate.valid() {
///     println!("{} Hz: {:.3e} ± {:.0e} Pa", line.frequency_hz, line.modulus, line.standard_error);
/// }
/// assert_eq!(estimate.valid().count(), 3);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoPoint {
    specimen: Specimen,
    specimen_uncertainty: SpecimenUncertainty,
    solver: Solver,
    limits: AcceptanceLimits,
}

impl TwoPoint {
    /// Creates the method for `specimen`, with [`Solver::Continuation`].
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless length, diameter and density are finite and above 0, and
    /// the mass of the accelerometer is finite and not negative.
    pub fn new(specimen: Specimen) -> Result<Self, CmodError> {
        specimen.check()?;
        Ok(Self {
            specimen,
            specimen_uncertainty: SpecimenUncertainty::default(),
            solver: Solver::default(),
            limits: AcceptanceLimits::default(),
        })
    }

    /// Sets the solver.
    #[must_use]
    pub fn with_solver(mut self, solver: Solver) -> Self {
        self.solver = solver;
        self
    }

    /// Sets the standard uncertainties of the specimen, which are the systematic part of the
    /// errors.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless all uncertainties are finite and not negative.
    pub fn with_specimen_uncertainty(
        mut self,
        uncertainty: SpecimenUncertainty,
    ) -> Result<Self, CmodError> {
        uncertainty.check()?;
        self.specimen_uncertainty = uncertainty;
        Ok(self)
    }

    /// Sets the error limits that a valid line must meet.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for limits that are NaN or not above 0, or for a least coherence
    /// outside the range from 0 to 1.
    pub fn with_limits(mut self, limits: AcceptanceLimits) -> Result<Self, CmodError> {
        self.limits = limits.check()?;
        Ok(self)
    }

    estimate! {
        /// Returns the complex modulus from the `acceleration_ratio` Ψ = â₁/â₂ of the impacted to
        /// the free end, at the increasing frequencies `frequency_hz` \[Hz\].
        ///
        /// `variance` is the known E|δΨ|², of real and imaginary part together, for an error
        /// without preferred phase; 0 means data without noise. For a variance from the coherence
        /// of a few hits, use [`TwoPoint::estimate_averaged`]. To first order the errors of the
        /// result are
        ///
        /// ```text
        /// dE/E = dρ/ρ + 2 dL/L - 2 dx/x ,    dx = (dΨ - x sinh x dμ)/f'(x) ,    x = γL ,
        /// dμ/μ = dm/m - dρ/ρ - dL/L - 2 dD/D .
        /// ```
        ///
        /// They are large near kL = nπ, where f' is small, and for kL → 0. If the second order in
        /// dΨ is not negligible, the line is marked as [near to a singular
        /// line](Violation::NearSingular).
        ///
        /// All three arrays have one entry per line. The lines must be dense enough to count the
        /// half waves in the specimen, see [`crate::branch`]. A line at 0 Hz and lines that are not
        /// finite are [refused](ModulusEstimate::refused) individually.
        ///
        /// # Errors
        /// [`CmodError::NoLines`], [`CmodError::LengthMismatch`], [`CmodError::Frequency`],
        /// [`CmodError::FrequencyOrder`], [`CmodError::NegativeVariance`].
        acceleration_ratio
    }

    /// Returns the complex modulus from spectra averaged over several hits: the variance follows
    /// from the coherence by [`variance_from_coherence`], and the errors have 2(n - 1) degrees of
    /// freedom.
    ///
    /// # Errors
    /// The errors of [`TwoPoint::estimate`] and [`variance_from_coherence`].
    pub fn estimate_averaged(
        &self,
        averaged: &AveragedRatio<'_>,
    ) -> Result<ModulusEstimate, CmodError> {
        let variance = variance_from_coherence(
            averaged.acceleration_ratio,
            averaged.coherence,
            averaged.averages,
        )?;
        let freedom = VarianceFreedom::of_averages(averaged.averages)?;
        self.estimate_ratio(&RatioLines {
            freedom: Some(&vec![freedom; variance.len()]),
            coherence: Some(averaged.coherence),
            ..RatioLines::of_known_variance(
                averaged.frequency_hz,
                averaged.acceleration_ratio,
                &variance,
            )
        })
    }

    /// Solves one line; refuses it if the result is not finite.
    fn line(
        &self,
        measured: &MeasuredRatio<'_>,
        free_end: ResolvedRoot,
        acceptance: &Acceptance,
    ) -> Result<ModulusLine, Refusal> {
        let Specimen {
            length,
            diameter,
            density,
            ..
        } = self.specimen;
        let equation = EndMassEquation {
            mass_ratio: self.specimen.mass_ratio(),
            acceleration_ratio: measured.ratio,
        };
        let omega = measured.omega();
        let modulus_of = |gamma_length: Complex64| {
            modulus_from_propagation(gamma_length / length, omega, density)
                .map_err(|_| Refusal::NoRoot)
        };

        let mut violations = Vec::new();
        let root = match self.solver {
            Solver::Continuation => {
                equation.continuation_checked(free_end.gamma_length, free_end.loaded_gamma_length)
            }
            Solver::Newton => equation.newton(free_end.gamma_length),
            Solver::Series => {
                let series = MassSeries::about(free_end.gamma_length);
                let gamma_length = series.four_terms(equation.mass_ratio);
                let four = modulus_of(gamma_length)?;
                let two = modulus_of(series.two_terms(equation.mass_ratio))?;
                violations.extend(series_truncated(two, four));
                EndMassRoot::in_closed_form(gamma_length)
            }
        };
        let gamma_length = root.gamma_length;
        let modulus = modulus_of(gamma_length)?;
        let gamma = gamma_length / length;

        violations.extend(conditions(gamma, diameter, length));
        violations.extend(free_end.ambiguity().map(Violation::BranchAmbiguous));
        if let Some(mass_ratio) = root.lost_at {
            violations.push(Violation::RootNotFollowed {
                mass_ratio,
                expected: equation.mass_ratio,
            });
        }
        violations.extend(
            measured
                .coherence
                .and_then(|coherence| acceptance.incoherent(coherence)),
        );

        let slopes = equation.slopes(gamma_length);
        let mut systematic = self.systematic(&slopes, gamma, modulus);
        systematic.extend(ratio_error::shifts(
            measured.common,
            measured.index,
            (gamma, modulus),
            (measured.ratio, (slopes.first * length).inv()),
        ));
        // dE/E = -2 dx/x, dx = dΨ/f'
        let relative_sensitivity = -2.0 / (gamma_length * slopes.first);
        Solution {
            index: measured.index,
            frequency: ComplexFrequency::on_axis(measured.frequency_hz),
            gamma,
            density,
            diameter,
            random: ComplexCovariance::circular(
                measured.variance / (length * length * slopes.first.norm_sqr()),
            ),
            systematic,
            error_amplification: measured.ratio.norm() * relative_sensitivity.norm(),
            second_order: bend(gamma_length, &slopes) * measured.variance.sqrt(),
            distance: length,
            closed_form: Some(free_end),
            termination: root.termination,
            violations,
        }
        .into_line(acceptance)
    }

    /// Returns the shifts of a line due to one standard uncertainty of each uncertain quantity of
    /// the specimen.
    fn systematic(
        &self,
        slopes: &Slopes,
        gamma: Complex64,
        modulus: Complex64,
    ) -> Vec<SystematicShift> {
        let uncertainty = &self.specimen_uncertainty;
        if *uncertainty == SpecimenUncertainty::default() {
            return Vec::new();
        }
        let specimen = &self.specimen;
        let length = uncertainty.length / specimen.length;
        let diameter = uncertainty.diameter / specimen.diameter;
        let density = uncertainty.density / specimen.density;
        // the uncertainty of the mass is not relative, because the mass itself may be 0
        let mass =
            uncertainty.accelerometer_mass / (specimen.density * specimen.area() * specimen.length);
        let mass_ratio = specimen.mass_ratio();
        // change dx/x of the root for dμ = 1
        let root = -slopes.by_mass_ratio / (slopes.first * gamma * specimen.length);
        // each source with its dμ, dL/L and dρ/ρ
        let sources = [
            (ErrorSource::Length, -mass_ratio * length, length, 0.0),
            (
                ErrorSource::Diameter,
                -2.0 * mass_ratio * diameter,
                0.0,
                0.0,
            ),
            (ErrorSource::Density, -mass_ratio * density, 0.0, density),
            (ErrorSource::AccelerometerMass, mass, 0.0, 0.0),
        ];
        // one more element for the error of one-dimensional theory
        let mut shifts = Vec::with_capacity(sources.len() + 1);
        let known = sources.into_iter().zip([length, diameter, density, mass]);
        let known = known.filter(|(_, uncertainty)| *uncertainty > 0.0);
        shifts.extend(
            known.map(|((source, of_mass_ratio, of_length, of_density), _)| {
                let of_root = root * of_mass_ratio;
                SystematicShift::new(
                    source,
                    modulus * (of_density + 2.0 * of_length - 2.0 * of_root),
                    gamma * (of_root - of_length),
                )
            }),
        );
        shifts
    }
}

impl RatioMethod for TwoPoint {
    fn estimate_ratio(&self, lines: &RatioLines<'_>) -> Result<ModulusEstimate, CmodError> {
        let mut estimate = ModulusEstimate::empty(Method("two-point method"), self.limits);
        let measured = section_ratio::usable(lines, "acceleration ratio", &mut estimate)?;
        estimate.expect_lines(measured.len());
        let branches =
            section_ratio::branches(&measured, self.specimen.length, self.specimen.mass_ratio())?;
        for (line, free_end) in measured.iter().zip(branches) {
            let acceptance = Acceptance::of_line(self.limits, line.freedom)?;
            let judged = self.line(line, free_end, &acceptance);
            let judged = judged.map_err(|_| Refusal::NoRoot);
            estimate.add(line.index, line.frequency_hz, judged);
        }
        Ok(estimate)
    }

    fn has_all_lines(&self) -> bool {
        true
    }

    fn ratio_about(&self, frequency_hz: f64, gamma: Complex64) -> Option<RatioAbout> {
        let Specimen {
            length, density, ..
        } = self.specimen;
        let equation = EndMassEquation {
            mass_ratio: self.specimen.mass_ratio(),
            acceleration_ratio: Complex64::ZERO,
        };
        let modulus = modulus_from_propagation(gamma, TAU * frequency_hz, density).ok()?;
        let slopes = equation.slopes(gamma * length);
        RatioAbout {
            ratio: equation.value(gamma * length),
            by_ratio: (slopes.first * length).inv(),
            modulus,
            shifts: self.systematic(&slopes, gamma, modulus),
        }
        .finite()
    }

    fn without_error_of_mass(&self, size: f64) -> Option<Box<dyn RatioMethod + '_>> {
        let uncertainty = self.specimen_uncertainty.accelerometer_mass;
        let accelerometer_mass = self.specimen.accelerometer_mass - size * uncertainty;
        (uncertainty > 0.0 && accelerometer_mass >= 0.0).then(|| {
            let specimen = Specimen {
                accelerometer_mass,
                ..self.specimen
            };
            Box::new(Self { specimen, ..*self }) as Box<dyn RatioMethod>
        })
    }
}

/// Returns the ratio of the second-order to the first-order error of E, for |δΨ| = 1:
/// ½|E''(Ψ)/E'(Ψ)| of E ~ x(Ψ)⁻².
fn bend(gamma_length: Complex64, slopes: &Slopes) -> f64 {
    let first = slopes.first;
    0.5 * (3.0 / (gamma_length * first) + slopes.second / (first * first)).norm()
}

/// Applies the criterion of paper A, section 5: E' and E'' from two terms and from four terms may
/// not differ by more than one third.
fn series_truncated(two: Complex64, four: Complex64) -> Option<Violation> {
    let storage_change = (two.re - four.re).abs() / four.re.abs();
    let loss_change = (two.im - four.im).abs() / four.im.abs();
    let accepted = storage_change <= 1.0 / 3.0 && loss_change <= 1.0 / 3.0;
    (!accepted).then_some(Violation::SeriesTruncated {
        storage_change,
        loss_change,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECIMEN: Specimen = Specimen {
        length: 0.8,
        diameter: 0.0107,
        density: 1118.0,
        accelerometer_mass: 2.9e-3,
    };

    #[test]
    fn mass_ratio_is_that_of_paper_a() {
        // Test 10: an accelerometer of 2.9 g on a rod of 0.25π (10.7 mm)² · 800 mm · 1118 kg/m³ =
        // 80.42 g
        assert!((SPECIMEN.mass_ratio() - 2.9 / 80.42).abs() < 1e-5);
    }

    #[test]
    fn impossible_specimens_are_refused() {
        type Change = fn(&mut Specimen);
        let cases: [(Change, &str); 4] = [
            (
                |specimen| specimen.length = 0.0,
                "length [m] is 0, expected a finite value above 0",
            ),
            (
                |specimen| specimen.diameter = f64::NAN,
                "diameter [m] is NaN, expected a finite value above 0",
            ),
            (
                |specimen| specimen.density = -1.0,
                "density [kg/m^3] is -1, expected a finite value above 0",
            ),
            (
                |specimen| specimen.accelerometer_mass = -2.9e-3,
                "accelerometer mass [kg] is -0.0029, expected a finite value, 0 or above",
            ),
        ];
        for (change, text) in cases {
            let mut specimen = SPECIMEN;
            change(&mut specimen);
            assert_eq!(TwoPoint::new(specimen).unwrap_err().to_string(), text);
        }
    }

    #[test]
    fn a_line_without_information_is_refused_alone() {
        let method = TwoPoint::new(SPECIMEN).unwrap();
        let gamma_length = |f: f64| Complex64::new(0.02, 1.0) * (f / 400.0);
        let frequency_hz = [0.0, 300.0, 400.0, 500.0, 600.0];
        let mut ratio = frequency_hz.map(|f| {
            EndMassEquation {
                mass_ratio: SPECIMEN.mass_ratio(),
                acceleration_ratio: Complex64::ZERO,
            }
            .value(gamma_length(f))
        });
        ratio[2] = Complex64::new(f64::NAN, 0.0);
        let variance = [0.0, 0.0, 0.0, f64::INFINITY, 0.0];
        let estimate = method.estimate(&frequency_hz, &ratio, &variance).unwrap();
        let refused: Vec<_> = estimate
            .refused()
            .iter()
            .map(|l| (l.index, l.reason))
            .collect();
        assert_eq!(
            refused,
            [
                (0, Refusal::ZeroFrequency),
                (2, Refusal::NotFinite),
                (3, Refusal::NotFinite)
            ]
        );
        let kept: Vec<_> = estimate.lines().iter().map(|line| line.index).collect();
        assert_eq!(kept, [1, 4]);
        // if every line is refused, the result has no lines, which is not an error
        let nothing = method.estimate(&[0.0], &[Complex64::ONE], &[0.0]).unwrap();
        assert!(nothing.lines().is_empty() && nothing.refused().len() == 1);
        // a rigid specimen: Ψ = 1 at a frequency above 0 gives γ = 0
        let rigid = method
            .estimate(&[100.0], &[Complex64::ONE], &[0.0])
            .unwrap();
        assert_eq!(rigid.refused()[0].reason, Refusal::NoRoot);
    }
}
