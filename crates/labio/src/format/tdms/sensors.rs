//! Scales of strain gauges, resistance thermometers and thermocouples.
//!
//! Formulas: the Wheatstone bridge of [`StrainBridge`](crate::StrainBridge), whose sign the
//! vendor's software inverts; Callendar and Van Dusen (IEC 60751); ITS-90 (NIST Monograph 175).

use super::thermocouples::Thermocouple;
use crate::BridgeLayout;

/// Largest number of Newton iterations for temperatures below 0 degC; from a start 10 K off, four
/// are needed.
const ITERATIONS: u32 = 20;

/// A sensor whose voltage was recorded.
#[derive(Debug)]
pub(super) enum Sensor {
    /// Strain \[-\] from the voltage \[V\] of a bridge.
    Bridge {
        layout: BridgeLayout,
        gauge_factor: f64,
        /// Excitation \[V\].
        excitation: f64,
        /// Voltage at rest \[V\].
        at_rest: f64,
        /// Factor for the shunt calibration and for leads in series with gauges.
        factor: f64,
    },
    /// Temperature \[degC\] from the voltage \[V\] of a resistance that carries a known current.
    Resistance {
        /// Current \[A\].
        current: f64,
        /// R₀ at 0 degC \[Ω\].
        at_zero: f64,
        /// A, B and C of R/R₀ = 1 + At + Bt² + C(t - 100)t³.
        coefficients: [f64; 3],
        /// Resistance of the leads within the measured voltage \[Ω\].
        leads: f64,
    },
    /// Temperature \[degC\] from a voltage \[µV\].
    Thermocouple(&'static Thermocouple),
    /// Voltage \[µV\] from a temperature \[degC\], such as that of a cold junction.
    ColdJunction(&'static Thermocouple),
}

/// Returns the bridge layout with the vendor's code `number`; `None` for an unknown code.
pub(super) fn layout(number: u32, poisson_ratio: f64) -> Option<BridgeLayout> {
    Some(match number {
        10_183 => BridgeLayout::FullBending,
        10_184 => BridgeLayout::FullBendingPoisson { poisson_ratio },
        10_185 => BridgeLayout::FullPoisson { poisson_ratio },
        10_188 => BridgeLayout::HalfPoisson { poisson_ratio },
        10_189 => BridgeLayout::HalfBending,
        10_271 | 10_272 => BridgeLayout::Quarter,
        _ => return None,
    })
}

impl Sensor {
    /// Returns the measured quantity for a recorded number.
    pub(super) fn value(&self, x: f64) -> f64 {
        match self {
            Self::Bridge {
                layout,
                gauge_factor,
                excitation,
                at_rest,
                factor,
            } => layout.relative_resistance((at_rest - x) / excitation) / gauge_factor * factor,
            Self::Resistance {
                current,
                at_zero,
                coefficients,
                leads,
            } => celsius((x / current - leads) / at_zero, *coefficients),
            Self::Thermocouple(kind) => kind.temperature(x / 1000.0),
            Self::ColdJunction(kind) => 1000.0 * kind.voltage(x),
        }
    }
}

/// Returns the temperature \[degC\] at which the resistance is `ratio` times the resistance at 0
/// degC.
fn celsius(ratio: f64, [a, b, c]: [f64; 3]) -> f64 {
    // the quadratic equation, which is valid above 0 degC
    let warm = 2.0 * (ratio - 1.0) / (a + (a * a + 4.0 * b * (ratio - 1.0)).sqrt());
    if ratio >= 1.0 {
        return warm;
    }
    let mut t = warm;
    for _ in 0..ITERATIONS {
        let excess = 1.0 + t * (a + t * (b + t * c * (t - 100.0))) - ratio;
        let slope = a + t * (2.0 * b + t * c * (4.0 * t - 300.0));
        let next = t - excess / slope;
        if next.total_cmp(&t).is_eq() {
            break;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table of resistances of the Pt100 in IEC 60751.
    #[test]
    fn a_platinum_thermometer_has_the_table_of_its_standard() {
        let coefficients = [3.9083e-3, -5.775e-7, -4.183e-12];
        for (ohms, t) in [
            (18.52, -200.0),
            (60.26, -100.0),
            (100.0, 0.0),
            (138.51, 100.0),
            (247.09, 400.0),
        ] {
            // the table is rounded to 0.01 ohm, an error of up to 0.0125 K
            let found = celsius(ohms / 100.0, coefficients);
            assert!((found - t).abs() < 0.013, "{ohms}: {found}");
        }
    }

    /// Values from the table of type K, in µV.
    #[test]
    fn a_thermocouple_has_the_table_of_its_standard() {
        let kind = Thermocouple::of_code(10_073).unwrap();
        for (celsius, microvolts) in [
            (-100.0, -3554.0),
            (0.0, 0.0),
            (100.0, 4096.0),
            (500.0, 20644.0),
            (1000.0, 41276.0),
        ] {
            let found = Sensor::ColdJunction(kind).value(celsius);
            assert!((found - microvolts).abs() < 0.51, "{celsius}: {found}");
            // the inverse has a stated error of 0.05 K
            let back = Sensor::Thermocouple(kind).value(microvolts);
            assert!((back - celsius).abs() < 0.06, "{microvolts}: {back}");
        }
    }
}
