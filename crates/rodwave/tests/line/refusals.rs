//! Impossible lines, which are rejected.

use super::*;

#[test]
fn impossible_lines_are_refused() {
    let rod = || line([steel(1.0, AREA)]);
    let gauge = |position| {
        rod()
            .run(1e-6, 1e-4, &[Gauge { body: 0, position }])
            .unwrap_err()
    };
    let unknown = Parameter {
        segment: 0,
        branch: 1,
        name: "ln_modulus",
    };
    let driven = |end: End| {
        rod()
            .with_right_end(end)
            .unwrap()
            .run(1e-6, 1e-4, &[])
            .unwrap_err()
    };
    let short = SampledHistory::new(&[0.0, 1.0, 0.0, 0.0], 51_200.0).unwrap();
    let refusals = [
        Segment::new(0.0, AREA, 7780.0).unwrap_err(),
        Segment::new(1.0, -1.0, 7780.0).unwrap_err(),
        Segment::new(1.0, AREA, f64::NAN).unwrap_err(),
        Segment::elastic(1.0, AREA, 7780.0, 0.0).unwrap_err(),
        Body::new([]).unwrap_err(),
        Body::new([steel(1.0, AREA), Segment::new(1.0, AREA, 1e3).unwrap()]).unwrap_err(),
        rod().with_gap(0, 0.0).unwrap_err(),
        rod().with_left_end(End::Mass(-1.0)).unwrap_err(),
        rod().with_left_end(End::Dashpot(0.0)).unwrap_err(),
        gauge(1.1),
        gauge(-0.1),
        gauge(f64::NAN),
        rod()
            .run(
                1e-6,
                1e-4,
                &[Gauge {
                    body: 1,
                    position: 0.0,
                }],
            )
            .unwrap_err(),
        rod().run(0.0, 1e-4, &[]).unwrap_err(),
        rod().run(1e-6, f64::INFINITY, &[]).unwrap_err(),
        rod()
            .run_with_derivatives(1e-6, 1e-4, &[], &[unknown])
            .unwrap_err(),
        driven(End::Velocity(Drive::of(|_| f64::NAN))),
        driven(End::Force(Drive::history(short))),
    ]
    .map(|error| error.to_string())
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    length [m] is 0, expected a finite value above 0
    cross-sectional area [m^2] is -1, expected a finite value above 0
    density [kg/m^3] is NaN, expected a finite value above 0
    modulus of a branch [Pa] is 0, expected a finite value above 0
    list of segments of a body has 0 entries, expected 1
    element 1: sum of the moduli of the branches [Pa] is 0, expected a finite value above 0
    list of contacts has 0 entries, expected 1
    mass at an end [kg] is -1, expected a finite value above 0
    resistance at an end [N s/m] is 0, expected a finite value above 0
    a gauge is 1.1 m from the end of a body of 1 m, expected a position inside the body
    a gauge is -0.1 m from the end of a body of 1 m, expected a position inside the body
    a gauge is NaN m from the end of a body of 1 m, expected a position inside the body
    list of bodies of a line has 1 entries, expected 2
    time step [s] is 0, expected a finite value above 0
    duration [s] is inf, expected a finite value above 0
    segment 0, branch 1 has no parameter `ln_modulus`
    velocity prescribed at the right end [m/s] is NaN, expected a finite value
    the response is requested until 0.0000592977947728372 s, but the excitation ends at 0.00005859375 s
    ");
}
