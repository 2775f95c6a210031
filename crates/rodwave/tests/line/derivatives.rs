//! Derivatives compared with differences.

use super::*;

/// Time step of the line of [`Joined`] \[s\].
const STEP: f64 = 0.1e-6;

/// Parameters of an elastic striker, a rod with two branches in parallel and a rod with one branch.
/// A front crosses each in a whole number of steps, `cells`.
#[derive(Clone, Copy)]
struct Joined {
    cells: [i32; 3],
    /// modulus of the elastic branch of the second segment; the other branch has the remainder
    elastic_modulus: f64,
    rates: [f64; 2],
    exponent: f64,
    sharpness: f64,
}

const JOINED: Joined = Joined {
    cells: [200, 975, 1190],
    elastic_modulus: 1.1e9,
    rates: [400.0, 300.0],
    exponent: 2.1,
    sharpness: 1.5,
};

impl Joined {
    const LENGTHS: [f64; 3] = [0.1, 0.15, 0.2];
    const DENSITIES: [f64; 3] = [2700.0, 1140.0, 910.0];

    fn modulus(&self, segment: usize) -> f64 {
        let speed = Self::LENGTHS[segment] / (f64::from(self.cells[segment]) * STEP);
        Self::DENSITIES[segment] * speed * speed
    }

    fn line(&self) -> Line {
        let segment = |index: usize, area: f64| {
            Segment::new(Self::LENGTHS[index], area, Self::DENSITIES[index]).unwrap()
        };
        let norton =
            MaxwellNorton::from_reference_rate(self.exponent, self.rates[0], 10e6).unwrap();
        let gurevich =
            MaxwellGurevichRabinovich::from_reference_rate(self.sharpness, self.rates[1], 10e6)
                .unwrap();
        let striker = segment(0, AREA)
            .with_branch(self.modulus(0), Elastic)
            .unwrap();
        let parallel = segment(1, 0.8 * AREA)
            .with_branch(self.modulus(1) - self.elastic_modulus, norton)
            .unwrap()
            .with_branch(self.elastic_modulus, Elastic)
            .unwrap();
        let single = segment(2, AREA)
            .with_branch(self.modulus(2), gurevich)
            .unwrap();
        let bodies = [
            Body::new([striker]).unwrap(),
            Body::new([parallel, single]).unwrap(),
        ];
        let push = |t: f64| 3000.0 * (-((t - 100e-6) / 20e-6).powi(2)).exp();
        Line::new(bodies)
            .unwrap()
            .with_left_end(End::Force(Drive::of(push)))
            .unwrap()
            .with_right_end(End::Mass(0.02))
            .unwrap()
    }

    /// Returns the line with one parameter changed by `notches`, and the change. A notch of a
    /// modulus shortens the transit through the segment by one step; a notch of another parameter
    /// is 5e-4.
    fn changed(&self, parameter: &Parameter, notches: i32) -> (Line, f64) {
        let mut to = *self;
        let small = 5e-4 * f64::from(notches);
        let change = match (parameter.segment, parameter.branch, parameter.name) {
            (segment, branch, "ln_modulus") => {
                to.cells[segment] -= notches;
                let total = to.modulus(segment) - self.modulus(segment);
                let own = match (segment, branch) {
                    (1, 0) => self.modulus(1) - self.elastic_modulus,
                    (1, _) => {
                        to.elastic_modulus += total;
                        self.elastic_modulus
                    }
                    _ => self.modulus(segment),
                };
                (total / own).ln_1p()
            }
            (_, _, "exponent") => {
                to.exponent += small;
                small
            }
            (_, _, "sharpness") => {
                to.sharpness += small;
                small
            }
            (segment, ..) => {
                to.rates[segment - 1] *= small.exp();
                small
            }
        };
        (to.line(), change)
    }
}

/// Weights for the derivative at 0 of the polynomial through values at the four `points` and at 0;
/// the weight of the value at 0 is the last.
fn derivative_at_zero(points: [f64; 4]) -> [f64; 5] {
    let weight = |i: usize| -> f64 {
        // derivative at 0 of x Π (x - xⱼ), j ≠ i, over the value of this polynomial at xᵢ
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        others.fold(1.0 / points[i], |w, (_, x)| w * -x / (points[i] - x))
    };
    let [a, b, c, d] = std::array::from_fn(weight);
    [a, b, c, d, -(a + b + c + d)]
}

/// Compares derivatives with differences of the same solver, through joints, branches, a contact
/// and a mass.
///
/// If a modulus changes by one notch, a wave that has crossed the striker a dozen times is shifted
/// by a dozen time steps, 0.03 of its duration. The difference quotient of fourth order is accurate
/// to 1e-6; the tolerance of 1e-4 allows for the second-order error of the tangent in a cell. For
/// other parameters, only rounding, divided by the change, and the shift of the first contact by
/// less than a step remain.
#[test]
fn derivatives_agree_with_differences() {
    let line = JOINED.line();
    let gauges = [0.07, 0.29].map(|position| Gauge { body: 1, position });
    let parameters = line.parameters();
    assert_eq!(parameters.len(), 1 + 3 + 1 + 3);
    let (step, duration) = (STEP * (1.0 + 1e-9), 0.35e-3);
    let run = |line: &Line| line.run(step, duration, &gauges).unwrap();
    let with = line
        .run_with_derivatives(step, duration, &gauges, &parameters)
        .unwrap();
    let plain = run(&line);
    closes(&with);
    for (a, b) in with.gauges[1]
        .velocity
        .iter()
        .zip(&plain.gauges[1].velocity)
    {
        // tolerance: the same sums in a different order
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    // the bodies separate only later, when a derivative of the force jumps and differences do not
    // apply
    assert!(
        plain.contacts[0].force[1000..]
            .iter()
            .all(|force| *force > 0.0)
    );
    for (parameter, derivatives) in parameters.iter().zip(&with.derivatives) {
        let changed = [-2, -1, 1, 2].map(|notches| JOINED.changed(parameter, notches));
        let weights = derivative_at_zero([0, 1, 2, 3].map(|i| changed[i].1));
        let runs = [0, 1, 2, 3].map(|i| run(&changed[i].0));
        let tolerance = if parameter.name == "ln_modulus" {
            1e-4
        } else {
            1e-7
        };
        let check = |what: &str, of: &dyn Fn(&LineHistory) -> &[f64], by: &[f64]| {
            let (scale, at) = (largest(by.iter().copied()), of(&with));
            let worst = largest((0..by.len()).map(|k| {
                let around: f64 = runs
                    .iter()
                    .zip(weights)
                    .map(|(run, w)| w * of(run)[k])
                    .sum();
                around + weights[4] * at[k] - by[k]
            }));
            assert!(
                scale > 0.0 && worst <= tolerance * scale,
                "{parameter:?} {what}: {worst:e} of {scale:e}"
            );
        };
        for (gauge, by) in derivatives.gauges.iter().enumerate() {
            check("velocity", &|run| &run.gauges[gauge].velocity, &by.velocity);
            check("stress", &|run| &run.gauges[gauge].stress, &by.stress);
            check("strain", &|run| &run.gauges[gauge].strain, &by.strain);
        }
        check(
            "contact",
            &|run| &run.contacts[0].force,
            &derivatives.contact_forces[0],
        );
        check(
            "mass",
            &|run| &run.ends[1].force,
            &derivatives.ends[1].force,
        );
        check(
            "mass",
            &|run| &run.ends[1].velocity,
            &derivatives.ends[1].velocity,
        );
    }
}
