//! Tests of inconsistent models, which are reported as errors before they are used.

use super::*;
use crate::catalogue::Law;
use crate::design::{Design, Estimated};
use crate::samples::{Pattern, StandardSamples};
use crate::selection::{Candidate, Selection};
use crate::test::{Provenance, RodTest, RodTestData};
use crate::{Fit, profile};
use rodwave::InelasticRod;
use rodwave::inelastic::Maxwell;
use testbed::struck_rod::{driven_by_samples, pulse};

#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    None,
    FewerLimits,
    FewerBounds,
    ReversedBounds,
    ShorterStarts,
    NoSuchDamping,
    ShorterResponse,
    LongerResponse,
    FewerDerivatives,
    ShorterDerivatives,
}

/// A Maxwell rod with one fault.
#[derive(Debug, Clone, Copy)]
struct Faulty {
    law: Maxwell,
    fault: Fault,
}

impl Faulty {
    fn with(fault: Fault) -> Self {
        let law = Maxwell::new(2e6).unwrap();
        Self { law, fault }
    }

    fn spoil<T: Clone>(&self, fewer: Fault, more: Fault, mut values: Vec<T>) -> Vec<T> {
        if self.fault == fewer {
            values.pop();
        } else if self.fault == more {
            values.extend_from_within(..1);
        }
        values
    }
}

impl RodModel for Faulty {
    fn name(&self) -> &str {
        "faulty"
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn parameter_names(&self) -> Vec<&str> {
        self.law.parameter_names()
    }

    fn step_limits(&self) -> Vec<f64> {
        self.spoil(
            Fault::FewerLimits,
            Fault::FewerLimits,
            self.law.step_limits(),
        )
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        let bounds = self.spoil(Fault::FewerBounds, Fault::FewerBounds, self.law.bounds());
        let turned = |(low, high)| {
            if self.fault == Fault::ReversedBounds {
                (high, low)
            } else {
                (low, high)
            }
        };
        bounds.into_iter().map(turned).collect()
    }

    fn damping_parameter(&self) -> Option<usize> {
        Some(if self.fault == Fault::NoSuchDamping {
            7
        } else {
            1
        })
    }

    fn parameters(&self, modulus: f64) -> Vec<f64> {
        RodModel::parameters(&self.law, modulus)
    }

    fn starts(&self, modulus: f64, duration: f64) -> Vec<Vec<f64>> {
        let starts = self.law.starts(modulus, duration).into_iter();
        starts
            .map(|start| self.spoil(Fault::ShorterStarts, Fault::ShorterStarts, start))
            .collect()
    }

    fn stated(&self, parameters: &[f64]) -> Vec<StatedParameter> {
        RodModel::stated(&self.law, parameters)
    }

    fn specimen_sensitivities(&self, parameters: &[f64]) -> Vec<SpecimenSensitivity> {
        RodModel::specimen_sensitivities(&self.law, parameters)
    }

    fn response(&self, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>> {
        let response = self.law.response(rod, parameters)?;
        Some(self.spoil(Fault::ShorterResponse, Fault::LongerResponse, response))
    }

    fn linearised_response(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
    ) -> Option<LinearisedResponse> {
        let mut response = self.law.linearised_response(rod, parameters)?;
        if self.fault == Fault::FewerDerivatives {
            response.by_parameter.pop();
        }
        if self.fault == Fault::ShorterDerivatives
            && let Some(last) = response.by_parameter.last_mut()
        {
            last.pop();
        }
        Some(response)
    }
}

/// A virtual test of a Maxwell rod by the chain of masses.
fn virtual_test() -> RodTest {
    let rate = 51_200.0;
    let excitation = pulse(90, 30.0, 4.0);
    let rod = InelasticRod::new(0.391, 1140.0, 3.2e9, Maxwell::new(2e6).unwrap()).unwrap();
    let response = driven_by_samples(&rod, 100, &excitation, rate).unwrap();
    RodTest::new(RodTestData {
        name: "virtual".into(),
        length: 0.391,
        density: 1140.0,
        impact_velocity: 10.0,
        sampling_rate_hz: rate,
        excitation,
        response,
        provenance: Provenance::Virtual {
            generator: rodwave::lumped::GENERATOR.into(),
        },
    })
    .unwrap()
    .with_noise(0.05, 0.05)
    .unwrap()
}

/// Messages of a fit, a comparison, profiles and standard samples for a faulty model.
fn said_of(fault: Fault) -> [String; 4] {
    fn said<T>(outcome: Result<T, MaxwellidError>) -> String {
        outcome.map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
    }
    let tests = [virtual_test()];
    let model = Faulty::with(fault);
    let ranges = [(-5.0, 5.0)];
    let candidate = Candidate::of_model(Arc::new(model), &ranges, false).unwrap();
    let laws = vec![candidate.clone()];
    [
        said(Fit::of(model).with_cell(8e-3).to(&tests)),
        said(Selection::new(laws.clone()).and_then(|of| of.with_cell(8e-3)?.compare(&tests))),
        said(profile::profiles(&candidate, &tests, 8e-3)),
        said(StandardSamples::of(&laws, &tests, 3, Pattern::Signed)),
    ]
}

#[test]
fn a_model_without_fault_is_accepted() {
    assert_eq!(said_of(Fault::None), ["accepted"; 4]);
}

#[test]
fn models_that_contradict_themselves_are_named() {
    for (fault, expected) in [
        (
            Fault::FewerLimits,
            "model `faulty` states 1 step limits for 2 parameters",
        ),
        (
            Fault::FewerBounds,
            "model `faulty` states 1 bounds for 2 parameters",
        ),
        (
            Fault::ShorterStarts,
            "model `faulty` states 1 starting values for 2 parameters",
        ),
        (
            Fault::NoSuchDamping,
            "model `faulty` states 7 as index of the damping for 2 parameters",
        ),
        (
            Fault::ReversedBounds,
            "the range of `ln_modulus` is 29.933606208922594 to 6.907755278982137, expected finite bounds in ascending order",
        ),
    ] {
        let [fit, selection, profiles, _] = said_of(fault);
        assert_eq!([fit, selection, profiles], [expected; 3], "{fault:?}");
    }
}

/// Checks that a response of another length than requested is treated as missing.
#[test]
fn responses_of_another_length_count_as_none() {
    for fault in [
        Fault::ShorterResponse,
        Fault::LongerResponse,
        Fault::FewerDerivatives,
        Fault::ShorterDerivatives,
    ] {
        let [fit, selection, profiles, _] = said_of(fault);
        assert!(
            fit.starts_with("the direct problem fails at the starting values"),
            "{fit}"
        );
        for said in [selection, profiles] {
            assert!(
                said.starts_with("no candidate law was given, or none exists"),
                "{said}"
            );
        }
    }
    let [.., samples] = said_of(Fault::ShorterResponse);
    assert_eq!(
        samples,
        "`faulty` has 0 standard samples, at least 2 are needed"
    );
}

/// Checks that estimates with another number of parameters than the law are refused.
#[test]
fn estimates_of_another_law_are_refused() {
    let tests = [virtual_test()];
    let design = Design {
        tests: &tests,
        cell: 8e-3,
    };
    let maxwell = Candidate::inelastic(Maxwell::new(2e6).unwrap(), &[]).unwrap();
    for parameters in [&[][..], &[21.9], &[21.9, 1.6, 0.0]] {
        let law = Estimated {
            candidate: &maxwell,
            parameters,
        };
        let expected = format!(
            "model `Maxwell` states {} estimates for 2 parameters",
            parameters.len()
        );
        assert_eq!(
            design.deviations(law, &[]).unwrap_err().to_string(),
            expected
        );
        assert_eq!(
            design
                .separation(law, &maxwell, &[])
                .unwrap_err()
                .to_string(),
            expected
        );
    }
}

/// Checks a comparison whose public field `decision` was set to a law that is not among its laws.
#[test]
fn a_comparison_without_its_laws_names_none() {
    let selection = Selection::new(vec![Candidate::of(Law::Elastic)]).unwrap();
    let mut comparison = selection
        .with_levels(0.5, 1e-300)
        .unwrap()
        .compare(&[virtual_test()])
        .unwrap();
    comparison.decision = crate::selection::Decision::Law {
        candidate: 3,
        probability: 1.0,
    };
    assert!(comparison.law().is_none() && !comparison.is_nonlinear_verdict());
}

#[test]
fn more_starts_and_samples_than_memory_are_refused() {
    let tests = [virtual_test()];
    let fit = Fit::of(Maxwell::new(2e6).unwrap()).with_starts(usize::MAX);
    assert!(
        fit.to(&tests)
            .unwrap_err()
            .to_string()
            .starts_with("number of starts is")
    );
    let laws = [Candidate::of(Law::Elastic)];
    let error = StandardSamples::of(&laws, &tests, usize::MAX, Pattern::Signed).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("number of standard samples per law is")
    );
}
