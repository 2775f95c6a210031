//! Observations of a phase that is known only up to full turns and, in most cases, up to its sign.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

use num_complex::Complex64;

use super::FreeEndRoot;

/// Ratio Ψ(x) of two spectra that depends on x = γℓ alone and is ambiguous: many x give the same Ψ.
///
/// # Requirements
/// `expand` is analytic, and real for real x, so that a conjugate ratio belongs to a conjugate
/// root. `visit_roots` must not omit any root within the given phases.
pub trait PhaseObservation {
    /// Returns Ψ, dΨ/dx and d²Ψ/dx² at x.
    fn expand(&self, x: Complex64) -> [Complex64; 3];

    /// Visits all x with Ψ(x) = `observed` and a phase Im x in `phases` \[rad\], for either sign of
    /// Re x.
    fn visit_roots(
        &self,
        observed: Complex64,
        phases: Range<f64>,
        visit: &mut dyn FnMut(Complex64),
    );

    /// Returns the two roots nearest to `expected`, the nearest first; `None` if the equation
    /// cannot be solved from `expected`.
    ///
    /// The default approximates Ψ by a parabola about `expected`, which has two roots, and refines
    /// both by Newton's iteration.
    fn nearest_roots(&self, observed: Complex64, expected: Complex64) -> Option<[Complex64; 2]> {
        nearest_by_parabola(self, observed, expected)
    }
}

/// Ratio Ψ = cosh x of a specimen of length ℓ with a free end (paper A), or of three gauges spaced
/// by ℓ (paper B).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FreeEnd;

/// Ratio Ψ = cosh x + μ x sinh x of a specimen as in [`FreeEnd`], with a mass of μ times the mass
/// of the specimen at its free end (paper A, eq. 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndMass {
    /// Mass ratio μ, 0 or above.
    pub mass_ratio: f64,
}

/// Ratio Ψ = e^{-x} of a wave that has travelled the distance ℓ, for example between two sections
/// without reflections, or from a gauge to an end and back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Travel;

impl PhaseObservation for FreeEnd {
    fn expand(&self, x: Complex64) -> [Complex64; 3] {
        let (cosh, sinh) = cosh_sinh(x);
        [cosh, sinh, cosh]
    }

    fn visit_roots(
        &self,
        observed: Complex64,
        phases: Range<f64>,
        visit: &mut dyn FnMut(Complex64),
    ) {
        let root = FreeEndRoot::of(observed).principal();
        for turn in turns(&phases, 0.0) {
            let turns = Complex64::new(0.0, f64::from(turn) * TAU);
            for candidate in [turns + root, turns - root] {
                if phases.contains(&candidate.im) {
                    visit(candidate);
                }
            }
        }
    }

    fn nearest_roots(&self, observed: Complex64, expected: Complex64) -> Option<[Complex64; 2]> {
        Some(FreeEndRoot::of(observed).nearest_roots(expected))
    }
}

impl PhaseObservation for EndMass {
    fn expand(&self, x: Complex64) -> [Complex64; 3] {
        let (cosh, sinh) = cosh_sinh(x);
        let mass = self.mass_ratio;
        [
            cosh + mass * x * sinh,
            (1.0 + mass) * sinh + mass * x * cosh,
            (1.0 + 2.0 * mass) * cosh + mass * x * sinh,
        ]
    }

    /// The substitution tanh η = μx gives cosh(x + η) (1 - μ²x²)^½ = Ψ, where η changes little with
    /// x: the closed form of the free end and a few iterations suffice. Where two roots nearly
    /// meet, both iterations may end at the same root; the other root is then found from the
    /// parabola about this root.
    fn visit_roots(
        &self,
        observed: Complex64,
        phases: Range<f64>,
        visit: &mut dyn FnMut(Complex64),
    ) {
        const REPETITIONS: usize = 12;
        const CLOSE: f64 = 0.05;
        // η is between 0 and about iπ/2
        const LAG: f64 = FRAC_PI_2;
        const NEARLY_MEET: f64 = 1.5;
        let mut recent = Recent::default();
        for turn in turns(&phases, LAG) {
            let turns = Complex64::new(0.0, f64::from(turn) * TAU);
            for sign in [-1.0, 1.0] {
                let mut x = turns;
                for _ in 0..REPETITIONS {
                    let load = self.mass_ratio * x;
                    let free = FreeEndRoot::of(observed / (1.0 - load * load).sqrt()).principal();
                    let before = x;
                    x = sign * free + turns - half_log_ratio(load);
                    if (x - before).norm_sqr() < CLOSE * CLOSE {
                        break;
                    }
                }
                let Some(root) = settle(self, observed, x) else {
                    continue;
                };
                let reflected = root.reflected();
                let other = if (reflected - root.x).norm_sqr() < NEARLY_MEET * NEARLY_MEET {
                    settle_beside(self, observed, reflected, root.x).filter(|other| {
                        (other - root.x).norm_sqr() < 4.0 * NEARLY_MEET * NEARLY_MEET
                    })
                } else {
                    None
                };
                for root in [Some(root.x), other].into_iter().flatten() {
                    if phases.contains(&root.im) && recent.is_new(root) {
                        visit(root);
                    }
                }
            }
        }
    }
}

impl PhaseObservation for Travel {
    fn expand(&self, x: Complex64) -> [Complex64; 3] {
        let value = (-x).exp();
        [value, -value, value]
    }

    fn visit_roots(
        &self,
        observed: Complex64,
        phases: Range<f64>,
        visit: &mut dyn FnMut(Complex64),
    ) {
        let root = -observed.ln();
        for turn in turns(&phases, 0.0) {
            let candidate = root + Complex64::new(0.0, f64::from(turn) * TAU);
            if phases.contains(&candidate.im) {
                visit(candidate);
            }
        }
    }

    fn nearest_roots(&self, observed: Complex64, expected: Complex64) -> Option<[Complex64; 2]> {
        let root = -observed.ln();
        if !root.is_finite() {
            return None;
        }
        let turns = ((expected.im - root.im) / TAU).round();
        let nearest = root + Complex64::new(0.0, TAU * turns);
        let side = if expected.im < nearest.im { -TAU } else { TAU };
        Some([nearest, nearest + Complex64::new(0.0, side)])
    }
}

/// Returns cosh x and sinh x, computed together from one exponential, one sine and one cosine.
fn cosh_sinh(x: Complex64) -> (Complex64, Complex64) {
    let (sin, cos) = x.im.sin_cos();
    let growing = x.re.exp();
    let cosh = 0.5 * (growing + 1.0 / growing);
    // for small x the difference of the exponentials loses digits
    let sinh = if x.re.abs() < 0.1 {
        x.re.sinh()
    } else {
        0.5 * (growing - 1.0 / growing)
    };
    (
        Complex64::new(cosh * cos, sinh * sin),
        Complex64::new(sinh * cos, cosh * sin),
    )
}

/// Returns artanh z for Im z >= 0, the half plane of a wave along +x.
fn half_log_ratio(z: Complex64) -> Complex64 {
    0.5 * ((1.0 + z) / (1.0 - z)).ln()
}

/// Returns the numbers m of the full turns 2πm that can have a root in `phases`: the phase of a
/// root of turn m is between 2πm - π - `lag` and 2πm + π.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the cast saturates at 0 and at 2^32, and no specimen is so many waves long"
)]
fn turns(phases: &Range<f64>, lag: f64) -> std::ops::RangeInclusive<u32> {
    let from = (phases.start / TAU - 0.5).ceil().max(0.0);
    let to = ((phases.end + lag) / TAU + 0.5).floor();
    from as u32..=to as u32
}

/// Last visited roots: if two iterations end at the same root, the second is ignored.
#[derive(Default)]
struct Recent {
    roots: [Complex64; 12],
    next: usize,
}

impl Recent {
    fn is_new(&mut self, root: Complex64) -> bool {
        if self.roots.iter().any(|known| is_same(*known, root)) {
            return false;
        }
        if let Some(slot) = self.roots.get_mut(self.next) {
            *slot = root;
        }
        self.next = (self.next + 1) % self.roots.len();
        true
    }
}

/// Root with the derivatives of Ψ near this root.
struct Root {
    x: Complex64,
    slope: Complex64,
    curvature: Complex64,
}

impl Root {
    /// Returns the other root of the parabola about this root.
    fn reflected(&self) -> Complex64 {
        self.x - 2.0 * self.slope / self.curvature
    }
}

/// Value of 2Ψ''δΨ/Ψ'² below which two roots are far apart.
const FAR: f64 = 0.1;
/// Maximum distance of the first root from the root of the parabola, as a fraction of half the
/// distance between the two roots of the parabola; farther away it may be another root.
const NEAR_PARABOLA: f64 = 0.5;

fn nearest_by_parabola<O: PhaseObservation + ?Sized>(
    observation: &O,
    observed: Complex64,
    expected: Complex64,
) -> Option<[Complex64; 2]> {
    let at_expected = observation.expand(expected);
    let [value, slope, curvature] = at_expected;
    let misfit = observed - value;
    if (2.0 * curvature * misfit).norm_sqr() < FAR * FAR * slope.norm_sqr().powi(2) {
        // far from the points where roots meet, the exact position of the other root is unimportant
        let first = settle_from(observation, observed, expected, at_expected)?;
        return Some([first.x, first.reflected()]);
    }
    let mut root = (slope * slope + 2.0 * curvature * misfit).sqrt();
    if (root.conj() * slope).re < 0.0 {
        root = -root;
    }
    // half of the distance between the two roots of the parabola
    let apart = (root / curvature).norm();
    let mut nearest = Nearest {
        expected,
        first: None,
        second: None,
    };
    let start = expected + 2.0 * misfit / (slope + root);
    let first = settle(observation, observed, start)
        .filter(|first| (first.x - start).norm() < NEAR_PARABOLA * apart);
    if let Some(first) = first {
        let start = expected - (slope + root) / curvature;
        let second = settle_beside(observation, observed, start, first.x)
            .filter(|second| (second - start).norm() < 2.0 * NEAR_PARABOLA * apart);
        nearest.offer(first.x);
        nearest.offer(second.unwrap_or_else(|| first.reflected()));
    } else {
        let phases = expected.im - TAU..expected.im + TAU;
        observation.visit_roots(observed, phases, &mut |root| nearest.offer(root));
    }
    Some([nearest.first?, nearest.second?])
}

/// Two nearest of all visited roots.
struct Nearest {
    expected: Complex64,
    first: Option<Complex64>,
    second: Option<Complex64>,
}

impl Nearest {
    fn is_nearer(&self, root: Complex64, other: Option<Complex64>) -> bool {
        let distance = |root: Complex64| (root - self.expected).norm_sqr();
        other.is_none_or(|other| distance(root) < distance(other))
    }

    fn offer(&mut self, root: Complex64) {
        let known = [self.first, self.second];
        if known
            .into_iter()
            .flatten()
            .any(|known| is_same(known, root))
        {
            return;
        }
        if self.is_nearer(root, self.first) {
            self.second = self.first.replace(root);
        } else if self.is_nearer(root, self.second) {
            self.second = Some(root);
        }
    }
}

/// Returns true if two results of an iteration are the same root.
fn is_same(root: Complex64, other: Complex64) -> bool {
    const SAME: f64 = 1e-6;
    (root - other).norm_sqr() < SAME * SAME
}

/// Performs Newton's iteration on (Ψ(x) - Ψ)/(x - `known`), which has all roots of Ψ(x) = Ψ except
/// the known one.
fn settle_beside<O: PhaseObservation + ?Sized>(
    observation: &O,
    observed: Complex64,
    start: Complex64,
    known: Complex64,
) -> Option<Complex64> {
    const MOST_STEPS: usize = 30;
    const SMALLEST_STEP: f64 = 1e-10;
    let mut x = start;
    for _ in 0..MOST_STEPS {
        let [value, slope, _] = observation.expand(x);
        let misfit = observed - value;
        let step = misfit / (slope + misfit / (x - known));
        x += step;
        if !x.is_finite() || (x - start).norm_sqr() > PI * PI {
            return None;
        }
        if step.norm_sqr() <= SMALLEST_STEP * SMALLEST_STEP * x.norm_sqr() {
            return Some(x);
        }
    }
    None
}

/// Performs Halley's iteration; returns `None` if it does not converge, or moves beyond the
/// neighbouring root.
fn settle<O: PhaseObservation + ?Sized>(
    observation: &O,
    observed: Complex64,
    start: Complex64,
) -> Option<Root> {
    settle_from(observation, observed, start, observation.expand(start))
}

/// Performs Halley's iteration, given Ψ and its derivatives at the start.
fn settle_from<O: PhaseObservation + ?Sized>(
    observation: &O,
    observed: Complex64,
    start: Complex64,
    at_start: [Complex64; 3],
) -> Option<Root> {
    const MOST_STEPS: usize = 20;
    // convergence is cubic: the next step would be below rounding
    const SMALLEST_STEP: f64 = 1e-5;
    // the accuracy of Ψ, which ends the iteration: at a double root the steps do not become small
    const ROUNDING: f64 = 1e-15;
    let mut x = start;
    let [mut value, mut slope, mut curvature] = at_start;
    for _ in 0..MOST_STEPS {
        let misfit = observed - value;
        let step = 2.0 * misfit * slope / (2.0 * slope * slope + misfit * curvature);
        x += step;
        if !x.is_finite() || (x - start).norm_sqr() > PI * PI {
            return None;
        }
        if step.norm_sqr() <= SMALLEST_STEP * SMALLEST_STEP * x.norm_sqr()
            || misfit.norm_sqr() <= ROUNDING * ROUNDING * (1.0 + observed.norm_sqr())
        {
            return Some(Root {
                x,
                slope,
                curvature,
            });
        }
        [value, slope, curvature] = observation.expand(x);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const OBSERVATIONS: [(&str, &dyn PhaseObservation); 5] = [
        ("free end", &FreeEnd),
        ("light mass", &EndMass { mass_ratio: 0.02 }),
        ("heavy mass", &EndMass { mass_ratio: 0.2 }),
        ("mass of the specimen", &EndMass { mass_ratio: 1.0 }),
        ("travel", &Travel),
    ];

    fn phases() -> impl Iterator<Item = Complex64> {
        (0..60).map(|j| Complex64::new(0.02 + 0.03 * f64::from(j % 9), 0.35 + 0.31 * f64::from(j)))
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        for (name, observation) in OBSERVATIONS {
            for x in phases() {
                let h = 1e-4;
                let [plus, slope_plus, _] = observation.expand(x + h);
                let [minus, slope_minus, _] = observation.expand(x - h);
                let [_, slope, curvature] = observation.expand(x);
                // The truncation error is h²/6 times the derivative two orders higher, which is
                // below 100 here.
                assert!(
                    ((plus - minus) / (2.0 * h) - slope).norm() < 3e-7,
                    "{name} {x}"
                );
                let second = (slope_plus - slope_minus) / (2.0 * h);
                assert!((second - curvature).norm() < 3e-7, "{name} {x}");
            }
        }
    }

    /// Checks that an iteration that starts nearer to one root than to any other root finds that
    /// root.
    #[test]
    fn the_nearest_root_is_found() {
        for (name, observation) in OBSERVATIONS {
            for x in phases() {
                let [observed, slope, curvature] = observation.expand(x);
                // a quarter of the distance to the point where two roots meet, at most 0.25 rad
                let way = 0.25 * (slope / curvature).norm().min(1.0);
                for direction in 0..8 {
                    let expected = x + Complex64::from_polar(way, 0.8 * f64::from(direction));
                    let [nearest, other] = observation.nearest_roots(observed, expected).unwrap();
                    // tolerance: rounding of 1e-14 divided by a slope of at least 0.05
                    assert!((nearest - x).norm() < 1e-11, "{name} {x}: {nearest}");
                    assert!((other - expected).norm() > way, "{name} {x}: {other}");
                }
            }
        }
    }

    /// Near kL = nπ, where two roots are 0.02 apart, both roots are found.
    #[test]
    fn roots_that_nearly_meet_are_told_apart() {
        for mass_ratio in [0.0, 0.05, 0.2] {
            let observation = EndMass { mass_ratio };
            // the point where the slope vanishes, by Newton's iteration from near kL = 3π
            let mut meeting =
                Complex64::new(0.0, 3.0 * PI - 3.0 * PI * mass_ratio / (1.0 + mass_ratio));
            for _ in 0..50 {
                let [_, slope, curvature] = observation.expand(meeting);
                meeting -= slope / curvature;
            }
            let x = meeting + Complex64::new(0.006, 0.008);
            let observed = observation.expand(x)[0];
            for (expected, sign) in [(x, 1.0), (2.0 * meeting - x, -1.0)] {
                let expected = expected + Complex64::new(0.001, -0.002);
                let [nearest, other] = observation.nearest_roots(observed, expected).unwrap();
                let reflected = 2.0 * meeting - x;
                let (here, there) = if sign > 0.0 {
                    (x, reflected)
                } else {
                    (reflected, x)
                };
                // tolerance: the other root is accurate only to the third order of the distance
                // between the two roots
                assert!(
                    (nearest - here).norm() < 3e-4,
                    "{mass_ratio}: {nearest} {here}"
                );
                assert!(
                    (other - there).norm() < 3e-4,
                    "{mass_ratio}: {other} {there}"
                );
                assert!((observation.expand(nearest)[0] - observed).norm() < 1e-13);
            }
        }
    }

    /// Checks that no root in 20 half waves is missed, and that every result is a root.
    #[test]
    fn all_roots_of_a_range_are_visited() {
        for (name, observation) in OBSERVATIONS {
            let damped = phases().map(|x| x + x.im * 0.06);
            for x in phases().chain(damped) {
                let observed = observation.expand(x)[0];
                for phases in [0.0..63.0, (x.im - 4.0).max(0.0)..x.im + 4.0] {
                    let mut roots = Vec::new();
                    observation.visit_roots(observed, phases.clone(), &mut |root| {
                        assert!(phases.contains(&root.im));
                        let residual = (observation.expand(root)[0] - observed).norm();
                        assert!(
                            residual < 1e-10 * (1.0 + observed.norm()),
                            "{name} {x}: {root}"
                        );
                        roots.push(root);
                    });
                    let found = roots.iter().any(|root| (root - x).norm() < 1e-9);
                    assert!(found, "{name} {x}: {roots:?}");
                    if phases.end > 60.0 {
                        // two roots per turn, or one for a travelling wave, plus or minus one root
                        // at either end
                        let turns = if name == "travel" { 10.0 } else { 20.0 };
                        assert!(
                            (roots.len() as f64 - turns).abs() <= 2.0,
                            "{name} {x}: {}",
                            roots.len()
                        );
                    }
                }
            }
        }
    }
}
