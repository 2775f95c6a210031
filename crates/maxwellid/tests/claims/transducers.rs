//! Claims on velocities from displacements, and on gain, offset and delay of a transducer.

use std::f64::consts::TAU;

use maxwellid::{Differentiator, Fit, Freedom, Nuisances, RodTest};
use rodwave::inelastic::MaxwellNorton;

use crate::virtual_rod::{LENGTH, RATE, V0, struck};
use testbed::claim::{Claims, Ours, Within, of};
use testbed::difference::largest;
use testbed::hold;
use testbed::noise::Noise;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    differentiator(claims);
    nuisances(claims);
    hold!(claims);
}

fn differentiator(claims: &mut Claims) {
    claims.by(
        "Savitzky and Golay, Anal. Chem. 36 (1964) 1627: tables of weights of the first derivative",
    );
    // five points, degree 2: (-2, -1, 0, 1, 2)/10; seven points, degree 4: (22, -67, -58, 0, 58,
    // 67, -22)/252
    for (name, half_width, degree, printed, divisor) in [
        (
            "five points, degree 2",
            2,
            2,
            &[-2.0, -1.0, 0.0, 1.0, 2.0][..],
            10.0,
        ),
        (
            "seven points, degree 4",
            3,
            4,
            &[22.0, -67.0, -58.0, 0.0, 58.0, 67.0, -22.0],
            252.0,
        ),
    ] {
        let worst = || -> Ours {
            let filter = Differentiator::new(half_width, degree)?;
            let pairs = filter.weights().iter().zip(printed);
            Ok(largest(
                pairs.map(|(found, printed)| (found - printed / divisor).abs()),
            ))
        };
        claims.deviation(
            format!("weights of {name}, largest difference"),
            Within(1e-13, "rounding of a system of five equations"),
            worst(),
        );
    }
    let filter = Differentiator::new(3, 4);
    claims.by("slope of a sinusoid");
    let gain = || -> Ours {
        let filter = filter.as_ref()?;
        let mut worst = 0.0_f64;
        for k in 1..=12 {
            let frequency = 0.03 * f64::from(k);
            let samples: Vec<f64> = (0..200)
                .map(|n| (TAU * frequency * f64::from(n)).sin())
                .collect();
            // the velocity at a sample is the true slope times the gain
            let velocity = filter.velocity(&samples, 1.0);
            let slopes = velocity.iter().enumerate().map(|(n, v)| {
                let phase = TAU * frequency * (n + filter.half_width()) as f64;
                (v - filter.gain(frequency) * TAU * frequency * phase.cos()).abs()
            });
            worst = worst.max(largest(slopes));
        }
        Ok(worst)
    };
    claims.deviation(
        "seven points, degree 4: velocity of sinusoids by the stated gain",
        Within(1e-12, "rounding"),
        gain(),
    );
    claims.by("white noise of variance 1, 200 000 samples");
    let noise = || -> Ours {
        let filter = filter.as_ref()?;
        let white = Noise::seeded(3).added_to(&[0.0; 200_000], 1.0);
        let velocity = filter.velocity(&white, 1.0);
        let squares: f64 = velocity.iter().map(|v| v * v).sum();
        Ok((squares / velocity.len() as f64).sqrt() / filter.noise_gain())
    };
    claims.claim(
        "seven points, degree 4: noise of the velocity over the stated",
        "1",
        1.0,
        Within(
            0.01,
            "1/sqrt(2 200 000), times four because neighbours are correlated",
        ),
        noise(),
    );
}

/// Claims on a response with a gain of 1.03, an offset of 0.05 m/s and a delay of two samples.
fn nuisances(claims: &mut Claims) {
    claims.by("transducer with a known gain, offset and delay on a virtual rod without noise");
    let found = || -> Ours<[f64; 5]> {
        let truth = MaxwellNorton::new(2.0, 1.3e13)?;
        let mut data = struck(LENGTH, V0, 2.6e9, &truth, 100).data;
        for value in &mut data.response {
            *value = 1.03 * *value + 0.05;
        }
        data.response.splice(0..0, [0.05, 0.05]);
        data.response.truncate(data.excitation.len());
        let start = MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6)?;
        let test = [RodTest::new(data)?];
        let blind = Fit::of(start).to(&test)?;
        assert!((blind.modulus() / 2.6e9 - 1.0).abs() > 0.05);
        let fit = Fit::of(start)
            .with_nuisances(Nuisances {
                response_gain: Freedom::Free,
                response_offset: Freedom::Free,
                delay: Freedom::Free,
                ..Nuisances::default()
            })
            .to(&test)?;
        let of_name = |name: &str| {
            let found = fit.nuisances().first();
            let same = found.and_then(|all| all.iter().find(|n| n.name.starts_with(name)));
            same.map_or(f64::NAN, |nuisance| nuisance.value)
        };
        Ok([
            of_name("response gain"),
            of_name("response offset"),
            of_name("delay"),
            fit.modulus(),
            fit.law().exponent(),
        ])
    };
    let found = found();
    for (index, (name, unit, expected, within)) in [
        (
            "gain",
            "1",
            1.03,
            Within(
                2e-3,
                "an error of 1e-4 of the impact velocity, divided by the effect of the damping",
            ),
        ),
        (
            "offset",
            "m/s",
            0.05,
            Within(
                5e-3,
                "an error of 1e-4 of the impact velocity in some samples",
            ),
        ),
        (
            "delay",
            "s",
            2.0 / RATE,
            Within(
                1e-6,
                "a twentieth of a sample; only reflections distinguish it from E",
            ),
        ),
        (
            "modulus, identified together with the transducer",
            "Pa",
            2.6e9,
            Within(7.8e6, "0.3 %: a delay of 0.1 % of the flight is 0.2 % of E"),
        ),
        (
            "exponent, identified together with the transducer",
            "1",
            2.0,
            Within(
                0.06,
                "an error of 1e-4 of the impact velocity, divided by the effect of the exponent",
            ),
        ),
    ]
    .into_iter()
    .enumerate()
    {
        claims.claim(
            format!("unknown transducer: {name}"),
            unit,
            expected,
            within,
            of(&found, |found| found[index]),
        );
    }
}
