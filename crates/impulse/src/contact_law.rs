//! Contact laws between the faces: rigid or compliant.
//!
//! Theory: `docs/theory/contact.md#time-step`.

mod tabulated;

use crate::ImpulseError;
use crate::error::check_positive;

pub use tabulated::TabulatedContact;

/// Contact force as a function of the approach $`\delta`$ of the faces ($`\delta \le 0`$: a gap).
/// The force is never tensile.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ContactLaw {
    /// Contact without compliance: $`0 \le F \perp -\delta \ge 0`$ (Ödeen 1993, paper E, section 2,
    /// with re-contact).
    Rigid,
    /// $`F = k\,\delta_+`$; created by [`ContactLaw::linear`] or [`ContactLaw::flat_punch`].
    Linear {
        /// Stiffness k [N/m].
        stiffness: f64,
    },
    /// $`F = K\,\delta_+^{3/2}`$; created by [`ContactLaw::hertz`] or [`ContactLaw::hertz_sphere`].
    Hertz {
        /// K \[N/m^(3/2)\].
        coefficient: f64,
    },
    /// A measured curve, with an optional separate unloading curve.
    Tabulated(TabulatedContact),
}

/// Elastic constants of a material in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticMaterial {
    /// Young's modulus E \[Pa\].
    pub modulus: f64,
    /// Poisson's ratio ν, from -1 to 1/2.
    pub poisson_ratio: f64,
}

impl ElasticMaterial {
    /// $`(1-\nu^2)/E`$ [1/Pa].
    fn compliance(self) -> Result<f64, ImpulseError> {
        check_positive("Young's modulus [Pa]", self.modulus)?;
        if self.poisson_ratio > -1.0 && self.poisson_ratio <= 0.5 {
            Ok((1.0 - self.poisson_ratio.powi(2)) / self.modulus)
        } else {
            Err(ImpulseError::NonPhysical {
                quantity: "Poisson's ratio",
                value: self.poisson_ratio,
                expected: "above -1 and at most 1/2",
            })
        }
    }
}

impl ContactLaw {
    /// Creates a spring of `stiffness` k [N/m].
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] unless it is finite and above 0.
    pub fn linear(stiffness: f64) -> Result<Self, ImpulseError> {
        Ok(Self::Linear {
            stiffness: check_positive("contact stiffness [N/m]", stiffness)?,
        })
    }

    /// Creates the contact of a thin rod of `radius` a \[m\] with the plane face of a wide body of
    /// this `material`: a rigid flat punch on a half space, $`k = 2aE/(1-\nu^2)`$.
    /// One-dimensional theory neglects this compliance where a cone's wide end meets a thin rod.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`].
    pub fn flat_punch(radius: f64, material: ElasticMaterial) -> Result<Self, ImpulseError> {
        check_positive("radius of the punch [m]", radius)?;
        Self::linear(2.0 * radius / material.compliance()?)
    }

    /// Creates the law $`F = K\delta^{3/2}`$ with this `coefficient` K \[N/m^(3/2)\].
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] unless it is finite and above 0.
    pub fn hertz(coefficient: f64) -> Result<Self, ImpulseError> {
        Ok(Self::Hertz {
            coefficient: check_positive("coefficient of the contact [N/m^(3/2)]", coefficient)?,
        })
    }

    /// Creates the contact of a spherical face of `radius` R \[m\] on a plane one: $`K =
    /// \tfrac43E^*\sqrt R`$, $`1/E^* = (1-\nu_1^2)/E_1 + (1-\nu_2^2)/E_2`$.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`].
    pub fn hertz_sphere(
        radius: f64,
        sphere: ElasticMaterial,
        plane: ElasticMaterial,
    ) -> Result<Self, ImpulseError> {
        check_positive("radius of the sphere [m]", radius)?;
        let compliance = sphere.compliance()? + plane.compliance()?;
        Self::hertz(4.0 / 3.0 * radius.sqrt() / compliance)
    }

    /// Rejects constants that the constructors would refuse, because the variants can be created
    /// without a constructor.
    pub(crate) fn check(&self) -> Result<(), ImpulseError> {
        match self {
            Self::Rigid | Self::Tabulated(_) => Ok(()),
            Self::Linear { stiffness } => Self::linear(*stiffness).map(|_| ()),
            Self::Hertz { coefficient } => Self::hertz(*coefficient).map(|_| ()),
        }
    }

    /// Returns the force at the approach `delta`, on the path given by `memory`.
    pub(crate) fn force(&self, memory: Memory, delta: f64) -> f64 {
        let pressed = delta.max(0.0);
        match self {
            Self::Rigid => 0.0,
            Self::Linear { stiffness } => stiffness * pressed,
            Self::Hertz { coefficient } => coefficient * pressed * pressed.sqrt(),
            Self::Tabulated(table) => table.force(memory.deepest, pressed),
        }
    }

    /// Returns the approach at which the force vanishes on unloading: the dent, 0 if there is none.
    pub(crate) fn dent(&self, memory: Memory) -> f64 {
        match self {
            Self::Tabulated(table) => table.dent(memory.deepest),
            _ => 0.0,
        }
    }

    /// Returns the energy \[J\] absorbed by the contact between the approaches `from` and `to`;
    /// `memory` is the state at `from`.
    pub(crate) fn work(&self, memory: Memory, from: f64, to: f64) -> f64 {
        let (begin, end) = (from.max(0.0), to.max(0.0));
        match self {
            Self::Rigid => 0.0,
            Self::Linear { stiffness } => 0.5 * stiffness * (end - begin) * (end + begin),
            Self::Hertz { coefficient } => {
                let energy = |delta: f64| 0.4 * coefficient * delta * delta * delta.sqrt();
                energy(end) - energy(begin)
            }
            Self::Tabulated(table) => {
                table.energy(memory.deepest, end) - table.energy(memory.deepest, begin)
            }
        }
    }

    /// Returns the mean force between `from` and `to`, work divided by distance; it increases with
    /// `to`.
    pub(crate) fn mean_force(&self, memory: Memory, from: f64, to: f64) -> f64 {
        let way = to - from;
        let size = from.abs().max(to.abs());
        // for closer points, the rounding of the energy difference exceeds the error of the force
        // in the middle
        if way.abs() <= 1e-5 * size {
            self.force(memory, 0.5 * (from + to))
        } else {
            self.work(memory, from, to) / way
        }
    }
}

/// History variables of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Memory {
    /// Largest approach so far \[m\].
    pub(crate) deepest: f64,
}

impl Memory {
    pub(crate) fn reach(&mut self, delta: f64) {
        self.deepest = self.deepest.max(delta);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: ElasticMaterial = ElasticMaterial {
        modulus: 206e9,
        poisson_ratio: 0.3,
    };

    #[test]
    fn a_body_that_keeps_its_shape_whatever_presses_it_has_no_stiffness() {
        let of = |poisson_ratio| ElasticMaterial {
            modulus: 1e9,
            poisson_ratio,
        };
        for refused in [-1.0, 0.500_001, f64::NAN] {
            assert!(
                ContactLaw::flat_punch(0.005, of(refused)).is_err(),
                "{refused}"
            );
        }
        assert!(ContactLaw::flat_punch(0.005, of(0.5)).is_ok());
    }

    #[test]
    fn work_is_the_integral_of_the_force() {
        let points = [(0.0, 0.0), (1e-5, 100.0), (3e-5, 500.0), (5e-5, 700.0)];
        let table = TabulatedContact::new(&points).unwrap();
        let hysteretic = table.clone().unloading_with(4e7).unwrap();
        for law in [
            ContactLaw::linear(2e7).unwrap(),
            ContactLaw::hertz(3e9).unwrap(),
            ContactLaw::Tabulated(table),
            ContactLaw::Tabulated(hysteretic),
        ] {
            for (deepest, from, to) in [
                (0.0, -1e-5, 4e-5),
                (3e-5, 3e-5, 1e-5),
                (3e-5, 1e-5, 4.5e-5),
                (4e-5, 4e-5, -2e-5),
            ] {
                let memory = Memory { deepest };
                let n = 20_000;
                let way = (to - from) / f64::from(n);
                let sum: f64 = (0..n)
                    .map(|k| law.force(memory, from + (f64::from(k) + 0.5) * way) * way)
                    .sum();
                let work = law.work(memory, from, to);
                // tolerance: error of the midpoint rule in the step where the slope of the force
                // jumps
                assert!(
                    (work - sum).abs() < 1e-6 * work.abs(),
                    "{law:?} {work} {sum}"
                );
            }
        }
    }

    #[test]
    fn what_is_no_stiffness_is_refused() {
        assert!(ContactLaw::linear(-1.0).is_err());
        assert!(ContactLaw::hertz(f64::NAN).is_err());
        assert!(ContactLaw::flat_punch(0.0, STEEL).is_err());
        let foam = ElasticMaterial {
            poisson_ratio: 0.7,
            ..STEEL
        };
        assert!(ContactLaw::hertz_sphere(0.01, foam, STEEL).is_err());
    }
}
