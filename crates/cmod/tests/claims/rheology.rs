//! Master curves and the laws of their shifts.

use cmod::rheology::{FitOptions, MasterCurve, ShiftLaws};
use rodwave::modulus::ComplexModulus;

use crate::rheology::sweep::{arrhenius, four_branches, sweep, wlf};
use testbed::claim::{Claims, Ours, Within, of};
use testbed::difference::largest;
use testbed::hold;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    shifts(claims);
    hold!(claims);
}

fn curve(log_shift: &dyn Fn(f64) -> f64) -> Ours<(MasterCurve, ShiftLaws)> {
    let law = four_branches();
    let sweep = sweep(&|omega| law.at(omega), log_shift, 0.01, 0);
    let curve = MasterCurve::new(&sweep, 6, &FitOptions::default())?;
    let laws = curve.shift_laws()?;
    Ok((curve, laws))
}

fn shifts(claims: &mut Claims) {
    claims
        .by("Williams, Landel and Ferry with C_1 = 8, C_2 = 180 K; 13 temperatures, noise of 1 %");
    let exact = |temperature: f64| wlf(8.0, 180.0, temperature);
    let by_wlf = curve(&exact);
    claims.claim(
        "master curve: root mean square of the errors of the shifts, in their standard errors",
        "1",
        1.0,
        Within(
            0.7,
            "12 shifts with correlated errors count as some five independent ones",
        ),
        of(&by_wlf, |(curve, _)| {
            let errors = curve
                .shifts
                .iter()
                .filter(|shift| shift.standard_error > 0.0);
            let squares = errors.map(|shift| {
                ((shift.log_shift - exact(shift.temperature)) / shift.standard_error).powi(2)
            });
            (squares.sum::<f64>() / 12.0).sqrt()
        }),
    );
    claims.claim(
        "master curve: largest error of the logarithm of an identified shift",
        "1",
        0.0,
        Within(
            0.3,
            "some standard errors of shifts whose logarithm is up to 6",
        ),
        of(&by_wlf, |(curve, _)| {
            largest(
                curve
                    .shifts
                    .iter()
                    .filter(|shift| shift.verdict.is_identified())
                    .map(|shift| (shift.log_shift - exact(shift.temperature)).abs()),
            )
        }),
    );
    claims.claim(
        "master curve: C_1 minus its true value, in standard errors",
        "1",
        0.0,
        Within(3.0, "three standard errors"),
        of(&by_wlf, |(_, laws)| {
            (laws.wlf.c1 - 8.0) / laws.wlf.c1_standard_error
        }),
    );
    claims.claim(
        "master curve: C_2 minus its true value, in standard errors",
        "1",
        0.0,
        Within(3.0, "three standard errors"),
        of(&by_wlf, |(_, laws)| {
            (laws.wlf.c2 - 180.0) / laws.wlf.c2_standard_error
        }),
    );
    claims.claim(
        "master curve of a WLF material: probability of an Arrhenius law",
        "1",
        0.0,
        Within(0.01, "the level at which it is refused"),
        of(&by_wlf, |(_, laws)| laws.arrhenius_p_value),
    );
    claims.by("Arrhenius with 120 kJ/mol; 13 temperatures, noise of 1 %");
    let by_arrhenius = curve(&|temperature| arrhenius(120e3, temperature));
    claims.claim(
        "master curve: activation energy minus its true value, in standard errors",
        "1",
        0.0,
        Within(3.0, "three standard errors"),
        of(&by_arrhenius, |(_, laws)| {
            (laws.arrhenius.activation_energy - 120e3) / laws.arrhenius.standard_error
        }),
    );
    claims.claim(
        "master curve: activation energy",
        "J/mol",
        120e3,
        Within(2.4e3, "2 %, from moduli of 1 %"),
        of(&by_arrhenius, |(_, laws)| laws.arrhenius.activation_energy),
    );
}
