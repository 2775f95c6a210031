//! Extreme numbers for every argument: each is refused, or its result is finite or flagged.

use impulse::{
    ContactLaw, ElasticMaterial, ForceHistory, FrequencyBand, Impact, ImpedanceHead, ImpulseError,
    LineBand, LowFrequency, MeasuredBody, MobilityLaw, Parameter, Penalty, Projection, Reciprocity,
    Reconstruction, Regularisation, ResponseNoise, Sensor, Settlement, StickProblem,
    StickUncertainty, TabulatedContact, TimeInterval, WeighedMass, ZeroLine, separate,
};
use num_complex::Complex64;

use super::hostile::{self, HOSTILE};
use crate::bodies::{long_rod, mass};

type Made = Result<Vec<f64>, ImpulseError>;

fn sweep(name: &str, door: impl Fn(f64) -> Made) {
    hostile::sweep(name, door);
}

#[test]
fn contacts() {
    let none: fn(ContactLaw) -> Vec<f64> = |_| Vec::new();
    sweep("stiffness", |x| ContactLaw::linear(x).map(none));
    sweep("coefficient", |x| ContactLaw::hertz(x).map(none));
    let steel = |modulus, poisson_ratio| ElasticMaterial {
        modulus,
        poisson_ratio,
    };
    sweep("radius of a punch", |x| {
        ContactLaw::flat_punch(x, steel(2e11, 0.3)).map(none)
    });
    sweep("modulus", |x| {
        ContactLaw::flat_punch(0.01, steel(x, 0.3)).map(none)
    });
    sweep("Poisson's ratio", |x| {
        ContactLaw::hertz_sphere(0.01, steel(2e11, x), steel(2e11, 0.3)).map(none)
    });
    for value in HOSTILE {
        for points in [
            [(0.0, 0.0), (value, 1.0), (2.0, 2.0)],
            [(0.0, 0.0), (1.0, value), (2.0, 2.0)],
        ] {
            let Ok(table) = TabulatedContact::new(&points) else {
                continue;
            };
            // a march with an accepted table gives finite forces without tension, or an error
            let found = Impact::between(&mass(1.0), &mass(2.0))
                .at_velocity(1.0)
                .through(ContactLaw::Tabulated(table))
                .in_steps_of(1e-3)
                .predict(0.1);
            if let Ok(found) = found {
                assert!(
                    found
                        .history
                        .force()
                        .iter()
                        .all(|f| f.is_finite() && *f >= 0.0),
                    "{points:?}"
                );
            }
        }
    }
}

/// Contact laws created as enum variants, without their constructors, are checked by the march.
#[test]
fn contact_constants_that_no_constructor_gives_are_refused() {
    let (first, second) = (mass(1.0), long_rod(1e3));
    for value in HOSTILE.into_iter().filter(|x| !(x.is_finite() && *x > 0.0)) {
        for law in [
            ContactLaw::Linear { stiffness: value },
            ContactLaw::Hertz { coefficient: value },
        ] {
            let impact = Impact::between(&first, &second)
                .at_velocity(1.0)
                .through(law.clone());
            for refused in [
                impact.predict(1e-3).map(|_| ()),
                impact.stick_force(1e-3).map(|_| ()),
                impact.stick_force_damped(1e-3, 1e-6).map(|_| ()),
            ] {
                let is_named = matches!(refused, Err(ImpulseError::NonPhysical { value: found, .. }) if found.to_bits() == value.to_bits());
                assert!(is_named, "{law:?}: {refused:?}");
            }
        }
    }
}

#[test]
fn impacts() {
    let (first, second) = (mass(0.5), long_rod(1e3));
    let predicted = |velocity, duration, step: Option<f64>| -> Made {
        let mut impact = Impact::between(&first, &second).at_velocity(velocity);
        if let Some(step) = step {
            impact = impact.in_steps_of(step);
        }
        let found = impact.predict(duration)?;
        let balance = found.balance();
        let mut all = found.history.force().to_vec();
        all.extend([
            balance.impulse,
            balance.energy_residual,
            balance.energy_before.unwrap(),
            balance.restitution.unwrap(),
        ]);
        all.extend(balance.inner);
        Ok(all)
    };
    sweep("velocity", |x| predicted(x, 1e-3, None));
    sweep("duration", |x| predicted(1.0, x, None));
    sweep("step", |x| predicted(1.0, 1e-3, Some(x)));
    sweep("mass", |x| {
        let body = MobilityLaw::analytic(move |s| 1.0 / (s * x)).free(x)?;
        Impact::between(&body, &second)
            .at_velocity(1.0)
            .predict(1e-3)
            .map(|p| p.history.force().to_vec())
    });
    sweep("mobility", |x| {
        let body = MobilityLaw::analytic(move |_| Complex64::from(x));
        Impact::between(&first, &body)
            .at_velocity(1.0)
            .predict(1e-3)
            .map(|p| p.history.force().to_vec())
    });
    sweep("damped interval", |x| {
        Ok(Impact::between(&first, &second)
            .at_velocity(1.0)
            .stick_force_damped(1e-3, x)?
            .force()
            .to_vec())
    });
    sweep("damped duration", |x| {
        Ok(Impact::between(&first, &second)
            .at_velocity(1.0)
            .stick_force_damped(x, 1e-6)?
            .force()
            .to_vec())
    });
    sweep("band", |x| {
        let band = LineBand {
            highest_hz: x,
            n_samples: 256,
        };
        Ok(Impact::between(&first, &second)
            .at_velocity(1.0)
            .stick_force_on_lines(band)?
            .history
            .force()
            .to_vec())
    });
}

#[test]
fn stick_problems() {
    let lines = |value: f64| vec![Complex64::from(value); 65];
    let (first, second) = (lines(1e-3), lines(2e-3));
    let solved = |problem: StickProblem<'_>| -> Made {
        let stick = problem.solve()?;
        if let Settlement::Unsettled { relative_level } = stick.settlement {
            assert!(
                relative_level.is_nan() || relative_level > 0.01,
                "{relative_level}"
            );
        }
        Ok(stick.history.force().to_vec())
    };
    let plain = StickProblem {
        first: &first,
        second: &second,
        frequency_step_hz: 50.0,
        impact_velocity: 1.0,
        zero_line: ZeroLine::EffectiveMass(1.0),
        roll_off_from_hz: None,
        interpolation: 1,
        until: None,
    };
    sweep("line spacing", |x| {
        solved(StickProblem {
            frequency_step_hz: x,
            ..plain
        })
    });
    sweep("velocity", |x| {
        solved(StickProblem {
            impact_velocity: x,
            ..plain
        })
    });
    sweep("mass", |x| {
        solved(StickProblem {
            zero_line: ZeroLine::EffectiveMass(x),
            ..plain
        })
    });
    sweep("roll-off", |x| {
        solved(StickProblem {
            roll_off_from_hz: Some(x),
            ..plain
        })
    });
    sweep("mobility", |x| {
        solved(StickProblem {
            first: &lines(x),
            ..plain
        })
    });
    let error = |uncertainty: StickUncertainty<'_>| {
        plain
            .error(&uncertainty)
            .map(|e| e.standard_error().to_vec())
    };
    let none = StickUncertainty::default();
    sweep("scale", |x| {
        error(StickUncertainty {
            first_scale: x,
            ..none
        })
    });
    sweep("error of the velocity", |x| {
        error(StickUncertainty {
            impact_velocity: x,
            ..none
        })
    });
    sweep("error of the mass", |x| {
        error(StickUncertainty {
            effective_mass: x,
            ..none
        })
    });
    sweep("variance", |x| {
        error(StickUncertainty {
            first_variance: Some(&[x; 65]),
            ..none
        })
    });
    let history = |start, step, sample: f64| {
        let history = ForceHistory::new(start, step, vec![0.0, sample, 0.0])?;
        Ok(vec![
            history.time_at(2),
            history.peak().force,
            history.peak().time,
        ])
    };
    sweep("start of a history", |x| history(x, 1e-3, 1.0));
    sweep("step of a history", |x| history(0.0, x, 1.0));
    sweep("sample of a history", |x| history(0.0, 1e-3, x));
    let stick = ForceHistory::new(0.0, 1e-3, vec![0.0, 2.0, 1.0, -1.0]).unwrap();
    sweep("threshold", |x| {
        separate(&stick, x).map(|i| i.history.force().to_vec())
    });
}

#[test]
fn measured_bodies() {
    let lines = |mass: f64, step_hz: f64| -> Vec<Complex64> {
        (0..64)
            .map(|k| {
                let s = Complex64::new(0.0, std::f64::consts::TAU * step_hz * f64::from(k));
                if k == 0 {
                    Complex64::ZERO
                } else {
                    1.0 / (s * mass) + 1e-3
                }
            })
            .collect()
    };
    let free = |mass, standard_error| {
        LowFrequency::Free(WeighedMass {
            mass,
            standard_error,
        })
    };
    let of = |step_hz: f64, low| MeasuredBody::from_mobility(&lines(0.5, 10.0), step_hz, low);
    let parts = |body: MeasuredBody| {
        let projected = body.projected(Projection::Causal);
        body.mobility()
            .iter()
            .chain(projected.mobility())
            .flat_map(|g| [g.re, g.im])
            .collect::<Vec<f64>>()
    };
    sweep("spacing", |x| of(x, free(0.5, 0.0)).map(|_| Vec::new()));
    sweep("weighed mass", |x| {
        of(10.0, free(x, 0.0)).map(|_| Vec::new())
    });
    sweep("error of a weighing", |x| of(10.0, free(0.5, x)).map(parts));
    sweep("front impedance", |x| {
        of(10.0, free(0.5, 0.0))?
            .with_front_impedance(x)
            .map(|_| Vec::new())
    });
    sweep("variance of a line", |x| {
        of(10.0, free(0.5, 0.0))?
            .with_variance(&[x; 64])
            .map(|b| b.variance().unwrap().to_vec())
    });
    let head = ImpedanceHead::new(0.005).unwrap();
    sweep("mass of a head", |x| {
        Ok(ImpedanceHead::new(x)?
            .face_mobility(&[Complex64::ONE; 5], &[0.0; 5], 1.0)?
            .variance)
    });
    sweep("spacing of a head", |x| {
        Ok(head
            .face_mobility(&[Complex64::ONE; 5], &[0.1; 5], x)?
            .variance)
    });
    sweep("variance of a head", |x| {
        Ok(head
            .face_mobility(&[Complex64::ONE; 5], &[x; 5], 1.0)?
            .variance)
    });
    assert!(matches!(
        head.face_mobility(&[Complex64::ONE; 5], &[-1e-3; 5], 1.0),
        Err(ImpulseError::NonPhysical { .. })
    ));
}

/// The results of screening and reciprocity do not depend on the unit of the mobility.
#[test]
fn screening_and_reciprocity_have_no_unit() {
    let late: Vec<Complex64> = (0..200)
        .map(|k| 1e-3 * Complex64::cis(0.9 * f64::from(k)) / (1.0 + 0.01 * f64::from(k)))
        .collect();
    let part = |unit: f64| {
        let scaled: Vec<Complex64> = late.iter().map(|g| g * unit).collect();
        let body = MeasuredBody::from_mobility(&scaled, 10.0, LowFrequency::Fixed).unwrap();
        body.screen().causality.acausal_part
    };
    let (there, back) = (vec![Complex64::ONE; 9], vec![Complex64::new(1.0, 0.2); 9]);
    let difference = |unit: f64| {
        let [a, b] =
            [&there, &back].map(|lines| lines.iter().map(|g| g * unit).collect::<Vec<_>>());
        let variance = vec![1e-4 * unit * unit; 9];
        let found = Reciprocity::between(&a, &b, [&variance, &variance]).unwrap();
        (found.relative_difference, found.contradicting_lines)
    };
    let (plain, apart) = (part(1.0), difference(1.0));
    assert!(plain > 0.1 && apart.1 == 8, "{plain} {apart:?}");
    for power in [-580, -500, 500, 1000] {
        let unit = 2.0_f64.powi(power);
        assert!(
            (part(unit) - plain).abs() < 1e-12,
            "2^{power}: {} {plain}",
            part(unit)
        );
        let found = if power < 512 {
            difference(unit).0
        } else {
            apart.0
        };
        assert!((found - apart.0).abs() < 1e-12, "2^{power}");
    }
    let negative = Reciprocity::between(&there, &back, [&[-1.0; 9], &[0.1; 9]]);
    assert!(
        matches!(negative, Err(ImpulseError::NonPhysical { .. })),
        "{negative:?}"
    );
}

#[test]
fn reconstructions() {
    let response: Vec<f64> = (0..64)
        .map(|n| (-(f64::from(n) - 20.0).powi(2) / 9.0).exp())
        .collect();
    let path = vec![Complex64::new(1.0, 0.1); 33];
    let of = |reconstruction: Reconstruction<'_>| -> Made {
        let found = reconstruction.solve()?;
        let mut all = found.history.force().to_vec();
        all.extend([found.relative_residual, found.noise_gain]);
        all.extend(&found.regularisation_bias);
        if let Some(error) = found.error.known() {
            all.extend(error.standard_error());
        }
        Ok(all)
    };
    let plain = || Reconstruction::new(&response, 1000.0, &path).unwrap();
    sweep("sampling rate", |x| {
        of(Reconstruction::new(&response, x, &path)?)
    });
    sweep("response", |x| {
        let mut response = response.clone();
        response[30] = x;
        of(Reconstruction::new(&response, 1000.0, &path)?)
    });
    sweep("path", |x| {
        of(Reconstruction::new(
            &response,
            1000.0,
            &[Complex64::from(x); 33],
        )?)
    });
    sweep("white noise", |x| {
        let sensor = Sensor::new(&response, &path)?.with_noise(ResponseNoise::White(x))?;
        of(Reconstruction::of_sensors(vec![sensor], 1000.0)?)
    });
    let support = TimeInterval {
        from: 0.01,
        to: 0.04,
    };
    for penalty in [Penalty::Size, Penalty::Slope, Penalty::Curvature] {
        let with = |parameter| Regularisation::Tikhonov { penalty, parameter };
        sweep("parameter", |x| {
            of(plain().with_regularisation(with(Parameter::Given(x))))
        });
        sweep("parameter on a support", |x| {
            of(plain()
                .acting_during(support)
                .with_regularisation(with(Parameter::Given(x))))
        });
        sweep("rate of a penalty", |x| {
            of(Reconstruction::new(&response, x, &path)?
                .with_regularisation(with(Parameter::Given(1.0))))
        });
    }
    for other in [0.0, 0.03] {
        sweep("band", |x| {
            of(plain().within(FrequencyBand {
                from_hz: x,
                to_hz: 300.0 + other,
            }))
        });
        sweep("support", |x| {
            of(plain().acting_during(TimeInterval { from: other, to: x }))
        });
        sweep("begin of a support", |x| {
            of(plain().acting_during(TimeInterval { from: x, to: 0.04 }))
        });
    }
}
