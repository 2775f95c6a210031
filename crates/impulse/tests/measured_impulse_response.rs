//! Figures 5 and 6 of paper E on virtual bodies: the force from a measured and a predicted impulse
//! response (I) and from two predicted ones (II), for the four cases.

use crate::virtual_laboratory;

use impulse::{ContactEnd, EndVerdict, separate};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use testbed::papers::paper_e::bodies::Face;
use testbed::papers::paper_e::load;
use virtual_laboratory::{bare_face, long_rod, on_long_rod, predicted, uncertainty};

/// Level of each of the four bands; all four cover with a probability of 96 %, and the seed is
/// fixed.
const LEVEL: f64 = 0.99;

#[test]
fn measured_and_predicted_bodies_give_the_same_force_within_its_band() {
    let paper = load().unwrap();
    let rod = long_rod(&paper).unwrap();
    for (face, is_by_force) in Face::ALL.into_iter().zip([true, false, true, false]) {
        let name = face.name();
        let mut random = ChaCha8Rng::seed_from_u64(1993);
        let tests = paper.hammer_tests(face, &mut random).unwrap();
        let merged = if is_by_force {
            tests.by_larger_force()
        } else {
            tests.by_inverse_variance()
        };
        let measured = bare_face(&paper, &merged.unwrap()).unwrap();
        let predicted = predicted(&paper, face).unwrap();
        let first = on_long_rod(&paper, face, &measured.mobility, &rod).unwrap();
        let second = on_long_rod(&paper, face, &predicted, &rod).unwrap();
        let error = first.error(&uncertainty(&measured)).unwrap();
        let (first, second) = (first.solve().unwrap(), second.solve().unwrap());
        let peak = second.history.peak().force;
        // 72 samples of 56 us: the first 4 ms from the contact on
        let contact = first.history.index_near(0.0).unwrap();
        let window = contact..contact + 72;
        let band = error
            .simultaneous(&first.history, LEVEL, window.clone(), 1000, &mut random)
            .unwrap();
        let stated = error.standard_error()[contact];
        assert!(
            stated < 0.02 * peak,
            "{name}: standard error {stated} N of a peak of {peak} N"
        );
        let largest = window
            .clone()
            .map(|n| (first.history.force()[n] - second.history.force()[n]).abs())
            .fold(0.0, f64::max);
        let inside = band.part_inside(second.history.force(), window);
        assert!(
            inside >= 1.0,
            "{name}: apart by {largest} N, standard error {stated} N, factor {}",
            band.factor
        );
        // the band is not too wide: the largest of 72 deviations exceeds one standard error
        assert!(largest > stated, "{name}: {largest} {stated}");

        let threshold = 0.02 * peak;
        let impacts = [&first, &second].map(|s| separate(&s.history, threshold).unwrap());
        let ContactEnd::Separated { time } = impacts[1].end else {
            // on this face the stick force hardly becomes tensile: its tension is within the
            // ringing of the band limit
            assert_eq!(face, Face::ConeB, "{:?}", impacts[1].end);
            continue;
        };
        let end = error.contact_end(&first.history, &impacts[0]).unwrap();
        // the force is nearly a straight line at the end; tolerance: three standard errors
        let is_early = matches!(end.verdict, EndVerdict::MayEndEarlier { .. });
        assert!(!is_early, "{name}: {end:?}");
        let apart = (end.time - time).abs();
        assert!(apart < 3.0 * end.standard_error, "{name}: {end:?} {time}");
    }
}
