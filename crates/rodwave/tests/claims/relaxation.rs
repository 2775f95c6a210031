//! Relaxation and creep of the linear laws, and Prony series that stand for others.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::modulus::{
    ConstantQ, CutPlaneModulus, FractionalZener, KelvinVoigt, LaplaceModulus, Maxwell, OmegaBand,
    PronyStandIn, SpringPot, TimeDomainModulus, Zener,
};

use super::moduli::prony;
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::{relative, worst};
use testbed::hold;

/// Inverse Laplace transform at time t on the contour of Talbot with 20 points (Abate & Valkó, Int. J. Numer. Meth. Engng 60
/// (2004) 979): errors of truncation and rounding of 1e-12 each.
fn inverse_laplace(time: f64, transform: impl Fn(Complex64) -> Complex64) -> f64 {
    const POINTS: u32 = 20;
    let m = f64::from(POINTS);
    let r = 0.4 * m / time;
    let first = 0.5 * (transform(Complex64::from(r)) * (r * time).exp()).re;
    let others: f64 = (1..POINTS)
        .map(|k| {
            let theta = f64::from(k) * PI / m;
            let cot = 1.0 / theta.tan();
            let s = r * theta * Complex64::new(cot, 1.0);
            let sigma = theta + (theta * cot - 1.0) * cot;
            ((s * time).exp() * transform(s) * Complex64::new(1.0, sigma)).re
        })
        .sum();
    r / m * (first + others)
}

/// From 10 ns, a ten-thousandth of most relaxation times, to 1 s.
fn times() -> impl Iterator<Item = f64> {
    (0..=32).map(|j| 1e-8 * 10f64.powf(0.25 * f64::from(j)))
}

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    const SOURCE: &str = "numerical inverse Laplace transform (Talbot's contour)";
    let why = "1e-12 of the inversion, and what cancels on its contour";
    type Law = fn() -> Fallible<Box<dyn TimeDomainModulus>>;
    let laws: [(&str, Law); 9] = [
        ("Maxwell", || Ok(Box::new(Maxwell::new(2.7e9, 2.7e5)?))),
        ("Kelvin-Voigt", || {
            Ok(Box::new(KelvinVoigt::new(2.7e9, 2.7e4)?))
        }),
        ("Zener", || Ok(Box::new(Zener::new(0.5e9, 2.9e9, 1e-4)?))),
        ("Prony series, solid", || Ok(Box::new(prony(0.4e9)?))),
        ("Prony series, fluid", || Ok(Box::new(prony(0.0)?))),
        ("constant Q", || {
            Ok(Box::new(ConstantQ::new(2.7e9, 0.1, 1e4)?))
        }),
        ("spring-pot", || {
            Ok(Box::new(SpringPot::new(2.7e9, 0.4, 1e4)?))
        }),
        ("fractional Zener, α = 0.3", || {
            Ok(Box::new(FractionalZener::new(0.5e9, 2.9e9, 1e-4, 0.3)?))
        }),
        ("fractional Zener, α = 0.8", || {
            Ok(Box::new(FractionalZener::new(0.5e9, 2.9e9, 1e-4, 0.8)?))
        }),
    ];
    for (name, law) in laws {
        let claim = Claim::new(
            format!("{name}: relaxation modulus against E(s)/s, 10 ns to 1 s"),
            SOURCE,
        );
        report.check(claim.within(1e-8, why), || {
            let law = law()?;
            worst(times(), |time| {
                let relaxation = law.relaxation_modulus(time)?;
                let inverse = inverse_laplace(time, |s| law.at_s(s) / s);
                // of a fluid after many relaxation times nothing is left; the inversion has the rounding of what was
                let scale = relaxation.max(1e-3 * law.at(1.0 / time).norm());
                Ok((inverse - relaxation) / scale)
            })
        });
        let claim = Claim::new(
            format!("{name}: creep compliance against 1/(sE(s)), 10 ns to 1 s"),
            SOURCE,
        );
        report.check(claim.within(1e-8, why), || {
            let law = law()?;
            worst(times(), |time| {
                let creep = law.creep_compliance(time)?;
                let inverse = inverse_laplace(time, |s| (s * law.at_s(s)).inv());
                Ok(inverse / creep - 1.0)
            })
        });
    }
    report.check(
        Claim::new(
            "Prony series: its chain of Kelvin-Voigt elements has the compliance 1/E(s)",
            "equivalence of the two chains",
        )
        .within(
            1e-12,
            "its zeros, each found to a rounding of the distance to the next pole",
        ),
        || {
            let law = prony(0.4e9)?;
            let chain = law.retardation_spectrum();
            worst(-20..=40, |j| {
                let omega = 1e4 * 10f64.powf(0.25 * f64::from(j));
                let s = Complex64::new(omega, omega);
                let elements: Complex64 = chain
                    .elements
                    .iter()
                    .map(|element| element.compliance / (1.0 + s * element.retardation_time))
                    .sum();
                let compliance = elements + chain.instantaneous_compliance + chain.fluidity / s;
                Ok((compliance * law.at_s(s) - 1.0).norm())
            })
        },
    );
    report.check(
        Claim::new(
            "fractional Zener by 4 Maxwell branches a decade, 100 Hz to 20 kHz: error in its own estimate of it",
            "the law itself, at lines between those of the fit",
        )
        .expects(1.0, "1")
        .within(0.1, "both seek the peaks of the error on lines of their own"),
        || {
            let law = FractionalZener::new(0.5e9, 2.9e9, 1e-4, 0.5)?;
            stand_in_error(law)
        },
    );
    hold!(report);
}

/// Largest relative error of a Prony series in place of a law, by what the series says of itself.
fn stand_in_error<L: CutPlaneModulus>(law: L) -> Fallible<f64> {
    let band = OmegaBand {
        from: TAU * 100.0,
        to: TAU * 20e3,
    };
    let stand_in = PronyStandIn::new(&law, band, 4.0)?;
    let decades = (band.to / band.from).log10();
    let found = worst(0..=371, |j| {
        let omega = band.from * 10f64.powf(decades * f64::from(j) / 371.0);
        Ok(relative(
            stand_in.law().at_s(Complex64::new(0.0, omega)),
            law.at_s(Complex64::new(0.0, omega)),
        ))
    })?;
    Ok(found / stand_in.greatest_error())
}
