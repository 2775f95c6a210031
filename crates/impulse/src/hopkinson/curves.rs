//! Histories at the faces and in the specimen.

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

use super::plan::{Plan, StressFrom, WaveSeparation};
use super::record::HopkinsonRecord;
use super::separation::{BarLines, Spectra};
use super::source::Setup;
use super::specimen::Loading;
use crate::ImpulseError;

/// A history of a result.
///
/// Waves are strains, positive in tension. Forces, stress and strain are positive in the sense of
/// the loading. In torsion forces are torques [N m], velocities are angular [rad/s], and strains
/// are shear strains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    /// Incident wave at the face of the incident bar.
    IncidentWave,
    /// Reflected wave at the face of the incident bar.
    ReflectedWave,
    /// Transmitted wave, which leaves the specimen, at the face of the transmitted bar.
    TransmittedWave,
    /// Force at the face of the incident bar \[N\].
    Force1,
    /// Force at the face of the transmitted bar \[N\].
    Force2,
    /// Difference of the two forces \[N\].
    ForceDifference,
    /// Velocity of the face of the incident bar along x [m/s].
    Velocity1,
    /// Velocity of the face of the transmitted bar along x [m/s].
    Velocity2,
    /// Engineering stress \[Pa\].
    Stress,
    /// Engineering strain.
    Strain,
    /// Engineering strain rate [1/s].
    StrainRate,
    /// True stress \[Pa\], at constant volume.
    TrueStress,
    /// True (logarithmic) strain.
    TrueStrain,
}

impl Curve {
    /// All histories, in the order of [`Curves`].
    pub const ALL: [Self; 13] = [
        Self::IncidentWave,
        Self::ReflectedWave,
        Self::TransmittedWave,
        Self::Force1,
        Self::Force2,
        Self::ForceDifference,
        Self::Velocity1,
        Self::Velocity2,
        Self::Stress,
        Self::Strain,
        Self::StrainRate,
        Self::TrueStress,
        Self::TrueStrain,
    ];

    /// Index of the history in [`Curves`].
    pub(super) fn place(self) -> usize {
        self as usize
    }
}

/// All histories of a result, sample by sample.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curves(pub(super) Vec<Vec<f64>>);

impl Curves {
    /// Returns one history.
    #[must_use]
    pub fn of(&self, curve: Curve) -> &[f64] {
        self.0.get(curve.place()).map_or(&[], Vec::as_slice)
    }
}

/// Choices of an evaluation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Recipe {
    pub(super) loading: Loading,
    pub(super) separation: [WaveSeparation; 2],
    pub(super) stress: StressFrom,
}

/// The lines of both bars.
pub(super) fn lines_of(
    setup: &Setup,
    plan: &Plan,
    loading: Loading,
) -> Result<[BarLines; 2], ImpulseError> {
    let torsion = loading == Loading::Torsion;
    Ok([
        BarLines::of(&setup.bars[0], plan, torsion)?,
        BarLines::of(&setup.bars[1], plan, torsion)?,
    ])
}

/// Evaluates a record:
///
/// ```math
/// \sigma = \pm\frac{F}{A_s} ,\qquad \dot\varepsilon = \pm\frac{v_2 - v_1}{L_s} ,\qquad
/// \varepsilon = \int\dot\varepsilon\,dt ,\qquad
/// \sigma_t = \sigma(1 \pm \varepsilon) ,\qquad \varepsilon_t = \pm\ln(1 \pm \varepsilon) ,
/// ```
///
/// with the upper sign for tension and the lower sign for compression. In torsion true and
/// engineering values are the same.
pub(super) fn evaluate(
    setup: &Setup,
    lines: &[BarLines; 2],
    record: &HopkinsonRecord,
    plan: &Plan,
    recipe: Recipe,
) -> Curves {
    let mut spectra = Spectra {
        plan,
        setup,
        record,
        transform: RealFourier::new(plan.n_transform),
    };
    let [first, second] = lines;
    let far = spectra.transmitted(recipe.separation[1], second);
    let force = |waves: &[Complex64], others: &[Complex64], bar: &BarLines| -> Vec<Complex64> {
        let sum = waves.iter().zip(others).zip(&bar.stiffness);
        sum.map(|((p, n), stiffness)| (p + n) * stiffness).collect()
    };
    let velocity = |waves: &[Complex64], others: &[Complex64], bar: &BarLines| -> Vec<Complex64> {
        let difference = waves.iter().zip(others).zip(&bar.speed);
        difference.map(|((p, n), speed)| (n - p) * speed).collect()
    };
    let force_2 = force(&far.along, &far.against, second);
    let near = spectra.incident(recipe.separation[0], first, &force_2);
    let force_1 = force(&near.along, &near.against, first);
    let velocity_1 = velocity(&near.along, &near.against, first);
    let velocity_2 = velocity(&far.along, &far.against, second);

    let sign = recipe.loading.sign();
    let transform = &mut spectra.transform;
    let mut history = |lines: &[Complex64], factor: f64| -> Vec<f64> {
        transform.lines().fill(Complex64::ZERO);
        for (to, from) in transform.lines().iter_mut().zip(lines) {
            *to = *from;
        }
        let scale = factor / plan.n_transform as f64;
        let samples = transform.inverse();
        let wanted = samples.get(plan.result.clone()).unwrap_or(&[]);
        wanted.iter().map(|x| scale * x).collect()
    };
    let incident = history(&near.along, 1.0);
    let reflected = history(&near.against, 1.0);
    let transmitted = history(&far.along, 1.0);
    let (f1, f2) = (history(&force_1, sign), history(&force_2, sign));
    let (v1, v2) = (history(&velocity_1, 1.0), history(&velocity_2, 1.0));
    let pairs = |a: &[f64], b: &[f64], of: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| of(*a, *b)).collect()
    };
    let difference = pairs(&f1, &f2, &|a, b| a - b);
    let per_area = setup.specimen.stress_per_force();
    let stress = match recipe.stress {
        StressFrom::Incident => f1.iter().map(|f| f * per_area).collect(),
        StressFrom::Transmitted => f2.iter().map(|f| f * per_area).collect(),
        StressFrom::Both => pairs(&f1, &f2, &|a, b| 0.5 * (a + b) * per_area),
    };
    let per_velocity = sign * setup.specimen.rate_per_velocity();
    let rate = pairs(&v1, &v2, &|a, b| (b - a) * per_velocity);
    let half_step = 0.5 / plan.rate_hz;
    let mut strain = Vec::with_capacity(rate.len());
    let (mut sum, mut last) = (0.0, 0.0);
    for rate in &rate {
        sum += half_step * (last + rate);
        last = *rate;
        strain.push(sum);
    }
    let (true_stress, true_strain) = if recipe.loading == Loading::Torsion {
        (stress.clone(), strain.clone())
    } else {
        (
            pairs(&stress, &strain, &|stress, strain| {
                stress * (1.0 + sign * strain)
            }),
            strain.iter().map(|e| sign * (sign * e).ln_1p()).collect(),
        )
    };
    Curves(vec![
        incident,
        reflected,
        transmitted,
        f1,
        f2,
        difference,
        v1,
        v2,
        stress,
        strain,
        rate,
        true_stress,
        true_strain,
    ])
}
