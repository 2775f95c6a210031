//! Forces from virtual responses of a struck rod, which are computed by the Laplace transform on a
//! damped line and inverted with frequency responses on the axis.

use impulse::{Reconstruction, ResponseEnd};

use crate::reconstruction::{BODY, PULSE, SUPPORT, chi_square, coverage, truth};
use crate::virtual_body::Faces;
use testbed::claim::{Claims, Ours, Within, of};
use testbed::difference::largest;
use testbed::hold;

const SEEDS: u64 = 60;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims.by("force of a virtual blow on a rod of loss factor 0.1");
    let faces = || -> Ours<Faces> { Ok(BODY.struck_by(PULSE)?) };
    let faces = faces();
    for (face, name) in [(0, "struck"), (1, "far")] {
        claims.deviation(
            format!("force from the acceleration of the {name} face, without noise"),
            Within(1e-3, "aliasing of the part of the pulse above 25 kHz"),
            faces
                .as_ref()
                .map_err(Clone::clone)
                .and_then(|faces| without_noise(faces, face)),
        );
    }
    for (sensors, name) in [(1, "one sensor"), (2, "two sensors")] {
        claims.by("force of a virtual blow, 60 draws of the noise");
        let covered = faces
            .as_ref()
            .map_err(Clone::clone)
            .and_then(|faces| coverage(faces, sensors, Some(SUPPORT), SEEDS));
        claims.claim(
            format!("{name}: fraction of the force inside its pointwise band of 95 %"),
            "1",
            0.95,
            Within(
                0.055,
                "fractions of 60 histories scatter by 0.13: 3.3 errors of the mean",
            ),
            of(&covered, |covered| covered.inside),
        );
        claims.claim(
            format!("{name}: mean square of the error over the stated variance"),
            "1",
            1.0,
            Within(
                0.43,
                "mean squares of 60 histories scatter by 1: 3.3 errors of the mean",
            ),
            of(&covered, |covered| covered.squares),
        );
        claims.claim(
            format!("{name}: whole histories inside the simultaneous band of 95 %"),
            "1",
            0.95,
            Within(
                0.09,
                "sqrt(0.95 0.05/60) = 2.8 % and 1.1 % of its factor, both times three",
            ),
            of(&covered, |covered| covered.whole),
        );
    }
    claims.by("chi-square of the residual over its degrees of freedom");
    claims.claim(
        "far face with noise as stated: reduced chi-square",
        "1",
        1.0,
        Within(0.13, "sqrt(2/2003) = 3 %, times four"),
        faces
            .as_ref()
            .map_err(Clone::clone)
            .and_then(|faces| chi_square(faces, &faces.frequency_responses[1])),
    );
    hold!(claims);
}

fn without_noise(faces: &Faces, face: usize) -> Ours {
    let lines = &faces.frequency_responses[face];
    let found = Reconstruction::new(&faces.responses[face], BODY.sampling_rate_hz, lines)?
        .acting_during(SUPPORT)
        .solve()?;
    assert_eq!(found.response_end, ResponseEnd::DiedOut);
    let truth = truth();
    let pairs = found.history.force().iter().zip(&truth);
    Ok(largest(pairs.map(|(a, b)| (a - b).abs() / PULSE.peak)))
}
