//! Strain gauges in a Wheatstone bridge.

use super::Rating;
use crate::error::{check_positive, non_physical};
use crate::{LabioError, Quantity};

/// The arms of the bridge that carry gauges, and the normal strain that these measure.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum BridgeLayout {
    /// One axial gauge (a dummy gauge for temperature does not count).
    Quarter,
    /// Two axial gauges in opposite arms, on opposite sides of a rod: bending cancels.
    HalfOpposite,
    /// One axial and one transverse gauge in adjacent arms.
    HalfPoisson {
        /// Poisson's ratio of the rod \[-\].
        poisson_ratio: f64,
    },
    /// Two gauges for bending, in adjacent arms with strains of opposite sign.
    HalfBending,
    /// Two axial gauges and two transverse ones, each pair in opposite arms: bending cancels.
    FullPoisson {
        /// Poisson's ratio of the rod \[-\].
        poisson_ratio: f64,
    },
    /// Four gauges for bending, with strains of opposite sign in adjacent arms.
    FullBending,
    /// Two axial gauges and two transverse ones for bending, one of each on each side of a beam,
    /// each pair in adjacent arms.
    FullBendingPoisson {
        /// Poisson's ratio of the beam \[-\].
        poisson_ratio: f64,
    },
}

impl BridgeLayout {
    /// Constants n, a and b of the bridge equation $`x = n r/(a - b r)`$.
    fn constants(self) -> [f64; 3] {
        match self {
            Self::Quarter => [4.0, 1.0, 2.0],
            Self::HalfOpposite => [2.0, 1.0, 1.0],
            Self::HalfPoisson { poisson_ratio: nu } => [4.0, 1.0 + nu, 2.0 * (1.0 - nu)],
            Self::HalfBending => [2.0, 1.0, 0.0],
            Self::FullPoisson { poisson_ratio: nu } => [2.0, 1.0 + nu, 1.0 - nu],
            Self::FullBending => [1.0, 1.0, 0.0],
            Self::FullBendingPoisson { poisson_ratio: nu } => [2.0, 1.0 + nu, 0.0],
        }
    }

    /// Relative change x of the resistance of an axial gauge at `r` = V/V_ex; NaN if no finite
    /// change of resistance gives `r`.
    pub(crate) fn relative_resistance(self, r: f64) -> f64 {
        let [n, a, b] = self.constants();
        if a - b * r <= 0.0 {
            return f64::NAN;
        }
        n * r / (a - b * r)
    }
}

/// Gauges, their bridge and its excitation.
///
/// With the bridge balanced at rest and $`r = V/V_{\rm ex}`$, the strain $`\varepsilon = x/k`$
/// follows from the gauge factor $`k`$ and
///
/// | layout | $`x`$ |
/// |---|---|
/// | quarter | $`4r/(1-2r)`$ |
/// | half, opposite | $`2r/(1-r)`$ |
/// | half, Poisson | $`4r/(1+\nu-2r(1-\nu))`$ |
/// | half, bending | $`2r`$ |
/// | full, Poisson | $`2r/(1+\nu-r(1-\nu))`$ |
/// | full, bending | $`r`$ |
/// | full, bending with Poisson | $`2r/(1+\nu)`$ |
///
/// which is exact, without expansion in small strains. A positive output is tension;
/// [`Polarity`](crate::Polarity) describes wiring that inverts it.
///
/// # Validity
///
/// Valid for leads without resistance and gauges of equal resistance and gauge factor; the
/// transverse sensitivity of the gauges is neglected.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StrainBridgeSheet"))]
pub struct StrainBridge {
    layout: BridgeLayout,
    gauge_factor: Rating,
    excitation: Rating,
}

impl StrainBridge {
    /// Creates a bridge of gauges with `gauge_factor` \[-\] under `excitation` \[V\].
    ///
    /// # Errors
    ///
    /// - [`LabioError::UnitMismatch`]: the gauge factor is not dimensionless or the excitation is
    ///   not a voltage.
    /// - [`LabioError::NonPhysical`]: one of them is not positive, or Poisson's ratio is outside
    ///   0..0.5.
    pub fn new(
        layout: BridgeLayout,
        gauge_factor: Rating,
        excitation: Rating,
    ) -> Result<Self, LabioError> {
        gauge_factor.expect_quantity("gauge factor", Quantity::Strain)?;
        excitation.expect_quantity("bridge excitation", Quantity::Voltage)?;
        check_positive("gauge factor [-]", gauge_factor.si())?;
        check_positive("bridge excitation [V]", excitation.si())?;
        if let BridgeLayout::HalfPoisson { poisson_ratio }
        | BridgeLayout::FullPoisson { poisson_ratio }
        | BridgeLayout::FullBendingPoisson { poisson_ratio } = layout
            && !(0.0..=0.5).contains(&poisson_ratio)
        {
            return non_physical(
                "Poisson's ratio [-]",
                poisson_ratio,
                "a value from 0 to 0.5",
            );
        }
        Ok(Self {
            layout,
            gauge_factor,
            excitation,
        })
    }

    /// Arms that carry gauges.
    #[must_use]
    pub fn layout(&self) -> BridgeLayout {
        self.layout
    }

    /// Gauge factor \[-\].
    #[must_use]
    pub fn gauge_factor(&self) -> &Rating {
        &self.gauge_factor
    }

    /// Excitation.
    #[must_use]
    pub fn excitation(&self) -> &Rating {
        &self.excitation
    }

    /// Strain \[-\] at the bridge voltage \[V\]; NaN for a voltage that no finite resistance of a
    /// gauge gives.
    pub(super) fn strain(&self, voltage: f64) -> f64 {
        let x = self
            .layout
            .relative_resistance(voltage / self.excitation.si());
        x / self.gauge_factor.si()
    }

    /// Bridge voltage \[V\] at the strain \[-\], the inverse of [`Self::strain`].
    pub(super) fn voltage(&self, strain: f64) -> f64 {
        let [n, a, b] = self.layout.constants();
        let x = strain * self.gauge_factor.si();
        a * x / (n + b * x) * self.excitation.si()
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StrainBridgeSheet {
    layout: BridgeLayout,
    gauge_factor: Rating,
    excitation: Rating,
}

#[cfg(feature = "serde")]
impl TryFrom<StrainBridgeSheet> for StrainBridge {
    type Error = LabioError;

    fn try_from(sheet: StrainBridgeSheet) -> Result<Self, LabioError> {
        Self::new(sheet.layout, sheet.gauge_factor, sheet.excitation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bridge(layout: BridgeLayout) -> StrainBridge {
        let gauge_factor = Rating::new(2.1, "1").unwrap();
        let excitation = Rating::new(5000.0, "mV").unwrap();
        StrainBridge::new(layout, gauge_factor, excitation).unwrap()
    }

    /// Checks that voltage and strain are inverse functions.
    #[test]
    fn the_voltage_of_a_strain_gives_this_strain() {
        let poisson_ratio = 0.35;
        for layout in [
            BridgeLayout::Quarter,
            BridgeLayout::HalfOpposite,
            BridgeLayout::HalfPoisson { poisson_ratio },
            BridgeLayout::HalfBending,
            BridgeLayout::FullPoisson { poisson_ratio },
            BridgeLayout::FullBending,
        ] {
            for strain in [0.1, 0.002, -0.03] {
                let back = bridge(layout).strain(bridge(layout).voltage(strain));
                // tolerance: a few rounding errors
                assert!((back / strain - 1.0).abs() < 1e-12, "{layout:?}: {back}");
            }
        }
    }

    #[test]
    fn a_voltage_that_no_strain_gives_is_no_strain() {
        // the output of a quarter bridge approaches half the excitation as the resistance grows
        // without limit
        assert!(bridge(BridgeLayout::Quarter).strain(2.5).is_nan());
        assert!(bridge(BridgeLayout::Quarter).strain(2.4).is_finite());
    }

    #[test]
    fn a_sheet_of_impossible_numbers_is_refused() {
        let number = |value| Rating::new(value, "1").unwrap();
        let volts = |value| Rating::new(value, "V").unwrap();
        let rubber = BridgeLayout::HalfPoisson { poisson_ratio: 0.6 };
        let refusals = [
            StrainBridge::new(rubber, number(2.0), volts(5.0)),
            StrainBridge::new(BridgeLayout::Quarter, volts(2.0), volts(5.0)),
            StrainBridge::new(BridgeLayout::Quarter, number(2.0), number(5.0)),
            StrainBridge::new(BridgeLayout::Quarter, number(-2.0), volts(5.0)),
        ]
        .map(|result| result.unwrap_err().to_string())
        .join("\n");
        insta::assert_snapshot!(refusals, @r"
        Poisson's ratio [-] is 0.6, expected a value from 0 to 0.5
        gauge factor is in V, expected a unit of 1
        bridge excitation is in 1, expected a unit of V
        gauge factor [-] is -2, expected a finite value above 0
        ");
    }
}
