//! Requests that are refused as a whole.

use cmod::branch::{Branch, BranchTracker, FreeEnd, PhaseRecord};
use num_complex::Complex64;

fn refusal(length: f64, frequency_hz: &[f64], lines: usize, variance: Option<&[f64]>) -> String {
    let observed = vec![Complex64::new(0.5, 0.1); lines];
    BranchTracker::new()
        .track(&[PhaseRecord {
            observation: &FreeEnd,
            length,
            frequency_hz,
            observed: &observed,
            variance,
        }])
        .unwrap_err()
        .to_string()
}

#[test]
fn records_that_do_not_fit() {
    let f = [10.0, 20.0];
    let nothing = BranchTracker::new().track(&[]).unwrap_err().to_string();
    for (found, expected) in [
        (nothing, "no line to evaluate"),
        (refusal(1.0, &[], 0, None), "no line to evaluate"),
        (
            refusal(0.0, &f, 2, None),
            "length [m] is 0, expected a finite value above 0",
        ),
        (
            refusal(1.0, &f, 3, None),
            "observed ratio has 3 lines, expected 2, one per frequency",
        ),
        (
            refusal(1.0, &f, 2, Some(&[1.0])),
            "variance has 1 lines, expected 2, one per frequency",
        ),
        (
            refusal(1.0, &f, 2, Some(&[1.0, -1.0])),
            "variance of line 1 is -1, expected 0 or above",
        ),
        (
            refusal(1.0, &[20.0, 10.0], 2, None),
            "frequency of line 1 is 10 Hz, expected more than the 20 Hz of the previous line",
        ),
        (
            refusal(1.0, &[20.0, 20.0], 2, None),
            "frequency of line 1 is 20 Hz, expected more than the 20 Hz of the previous line",
        ),
        (
            refusal(1.0, &[f64::NAN, 20.0], 2, None),
            "frequency of line 0 is NaN Hz, expected a finite value, 0 or above",
        ),
    ] {
        assert_eq!(found, expected);
    }
}

#[test]
fn anchors_that_cannot_be() {
    let tracker = BranchTracker::new;
    for (found, expected) in [
        (
            tracker().with_wave_speed(-1.0, 0.1),
            "wave speed [m/s] is -1, expected a finite value above 0",
        ),
        (
            tracker().with_wave_speed(1e3, 0.0),
            "relative error of the wave speed is 0, expected a finite value above 0",
        ),
        (
            tracker().with_wave_number(0.0, 1.0, 1.0),
            "frequency of the known wave number [Hz] is 0, expected a finite value above 0",
        ),
        (
            tracker().with_wave_number(1.0, 1.0, f64::NAN),
            "standard error of the wave number [rad/m] is NaN, expected a finite value above 0",
        ),
        (
            tracker().with_branch(1.0, Branch::in_quadrant(0), 0.0),
            "length [m] is 0, expected a finite value above 0",
        ),
    ] {
        assert_eq!(found.unwrap_err().to_string(), expected);
    }
}

/// Records of missing lines only, or of noise only, give no root or no confidence.
#[test]
fn records_without_information() {
    let frequency_hz: Vec<f64> = (0..50).map(|j| 10.0 * f64::from(j)).collect();
    let missing = vec![Complex64::new(f64::NAN, 0.0); 50];
    let tracked = BranchTracker::new()
        .track(&[PhaseRecord {
            observation: &FreeEnd,
            length: 0.5,
            frequency_hz: &frequency_hz,
            observed: &missing,
            variance: None,
        }])
        .unwrap();
    assert!(tracked.hypotheses.is_empty());
    let lines = &tracked.records[0];
    assert_eq!(lines[0].root, Some(Complex64::ZERO));
    assert!(
        lines[1..]
            .iter()
            .all(|line| { line.root.is_none() && line.confidence == 0.0 && line.doubt.is_some() })
    );
}
