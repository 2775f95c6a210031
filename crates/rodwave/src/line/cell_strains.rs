//! Strains of the cells of a bar.

use super::bar::Bar;

#[derive(Debug, Clone)]
pub(super) enum CellStrains {
    /// The bar is elastic: the strain is σ/E.
    OfStress,
    /// The bar is inelastic: the strain is the sum of dσ/E over the elastic parts of all steps, the
    /// only parts that change it.
    Own(Vec<f64>),
}

impl CellStrains {
    pub(super) fn of(bar: &Bar) -> Self {
        if bar.is_elastic() {
            Self::OfStress
        } else {
            Self::Own(vec![0.0; bar.cells()])
        }
    }

    /// Subtracts the stress before the elastic part of a step.
    pub(super) fn before_shift(&mut self, bar: &Bar) {
        self.add_stress(bar, -1.0);
    }

    /// Adds the stress after the elastic part of a step.
    pub(super) fn after_shift(&mut self, bar: &Bar) {
        self.add_stress(bar, 1.0);
    }

    fn add_stress(&mut self, bar: &Bar, sign: f64) {
        let Self::Own(strains) = self else {
            return;
        };
        let factor = 0.5 * sign * bar.specific_impedance / bar.modulus;
        let waves = bar.right.as_slice().iter().zip(bar.left.as_slice());
        for (strain, (r, l)) in strains.iter_mut().zip(waves) {
            *strain += factor * (r + l);
        }
    }
}
