//! The measuring chain of one channel, from the quantity to the recorded number.

use super::{Date, Rating, StrainBridge};
use crate::error::{check_finite, check_not_negative, check_positive, unit_mismatch};
use crate::{Dimension, LabioError, Quantity};

/// The transducer, which converts the physical quantity into an electrical one.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Transducer {
    /// A sensor of constant sensitivity, for example 10.2 mV/g or 4.1 pC/N.
    Sensitivity(Rating),
    /// Strain gauges.
    Bridge(StrainBridge),
}

/// Sign of the signal for a positive quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Polarity {
    /// Positive signal for a positive quantity.
    #[default]
    Normal,
    /// Negative signal for a positive quantity.
    Inverted,
}

impl Polarity {
    fn sign(self) -> f64 {
        match self {
            Self::Normal => 1.0,
            Self::Inverted => -1.0,
        }
    }
}

/// The direction in which a sensor measures; x is along the rod.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[allow(missing_docs, reason = "the names are self-explanatory")]
pub enum Direction {
    PlusX,
    MinusX,
    PlusY,
    MinusY,
    PlusZ,
    MinusZ,
}

/// Position of a sensor along the rod.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Position {
    /// Coordinate along the rod \[m\].
    pub x: f64,
    /// Standard uncertainty of the coordinate \[m\].
    pub standard_uncertainty: f64,
}

/// The measuring chain of one channel: transducer, amplifier and wiring.
///
/// For a transducer of sensitivity $`S`$, an amplifier of gain $`G`$, polarity $`p = \pm 1`$ and a
/// recorder offset $`u_0`$, the recorded number $`u`$ represents the quantity
///
/// ```math
/// y = p\,\frac{u - u_0}{G\,S}
/// ```
///
/// and for strain gauges $`p(u-u_0)/G`$ is the voltage of their [`StrainBridge`]. Units are
/// checked: $`u`$ divided by $`GS`$ must have the dimension of a [`Quantity`].
///
/// # Examples
///
/// ```
/// use labio::{Quantity, Rating, SensorChain};
///
/// # fn main() -> Result<(), labio::LabioError> {
/// let accelerometer = Rating::new(10.2, "mV/g")?.with_uncertainty(0.1)?;
/// let chain = SensorChain::of_sensitivity(accelerometer)?.with_gain(Rating::new(10.0, "1")?)?;
/// assert_eq!(chain.quantity_from(Quantity::Voltage)?, Quantity::Acceleration);
/// // 0.102 V after the amplifier are 10.2 mV before it: one standard gravity
/// assert!((chain.si_from(0.102) - 9.80665).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "SensorChainSheet"))]
pub struct SensorChain {
    transducer: Transducer,
    gain: Rating,
    polarity: Polarity,
    offset: f64,
    time_skew: f64,
    time_skew_uncertainty: f64,
    position: Option<Position>,
    direction: Option<Direction>,
    serial: Option<String>,
    calibrated_on: Option<Date>,
}

impl SensorChain {
    /// Creates the chain of a sensor of constant `sensitivity` and an amplifier of gain 1.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the sensitivity is not positive; use [`Polarity`] for a
    /// negative one.
    pub fn of_sensitivity(sensitivity: Rating) -> Result<Self, LabioError> {
        positive("sensitivity", &sensitivity)?;
        Ok(Self::of(Transducer::Sensitivity(sensitivity)))
    }

    /// Creates the chain of strain gauges and an amplifier of gain 1.
    #[must_use]
    pub fn of_bridge(bridge: StrainBridge) -> Self {
        Self::of(Transducer::Bridge(bridge))
    }

    fn of(transducer: Transducer) -> Self {
        Self {
            transducer,
            gain: Rating::one(),
            polarity: Polarity::Normal,
            offset: 0.0,
            time_skew: 0.0,
            time_skew_uncertainty: 0.0,
            position: None,
            direction: None,
            serial: None,
            calibrated_on: None,
        }
    }

    /// Sets the gain of the amplifier: a pure number or, for a charge amplifier, for example 10
    /// mV/pC.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if it is not positive.
    pub fn with_gain(self, gain: Rating) -> Result<Self, LabioError> {
        positive("amplifier gain", &gain)?;
        Ok(Self { gain, ..self })
    }

    /// Sets the sign of the signal.
    #[must_use]
    pub fn with_polarity(self, polarity: Polarity) -> Self {
        Self { polarity, ..self }
    }

    /// Sets the offset: the number recorded for zero input, in the SI unit of the recorded
    /// quantity.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if it is not finite.
    pub fn with_offset(mut self, offset: f64) -> Result<Self, LabioError> {
        self.offset = check_finite("recorder offset", offset)?;
        Ok(self)
    }

    /// Sets the time skew: the delay \[s\] of the samples relative to the record's time axis.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if it is not finite.
    pub fn with_time_skew(mut self, time_skew: f64) -> Result<Self, LabioError> {
        self.time_skew = check_finite("time skew [s]", time_skew)?;
        Ok(self)
    }

    /// Sets the standard uncertainty of the time skew \[s\]; 0 by default.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if it is not finite or negative.
    pub fn with_time_skew_uncertainty(mut self, uncertainty: f64) -> Result<Self, LabioError> {
        self.time_skew_uncertainty =
            check_not_negative("uncertainty of the time skew [s]", uncertainty)?;
        Ok(self)
    }

    /// Sets the position of the sensor.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the coordinate is not finite or its uncertainty negative.
    pub fn with_position(mut self, position: Position) -> Result<Self, LabioError> {
        check_finite("sensor position [m]", position.x)?;
        check_not_negative(
            "uncertainty of the sensor position [m]",
            position.standard_uncertainty,
        )?;
        self.position = Some(position);
        Ok(self)
    }

    /// Sets the direction in which the sensor measures.
    #[must_use]
    pub fn with_direction(mut self, direction: Direction) -> Self {
        self.direction = Some(direction);
        self
    }

    /// Sets the serial number of the sensor.
    #[must_use]
    pub fn with_serial(mut self, serial: impl Into<String>) -> Self {
        self.serial = Some(serial.into());
        self
    }

    /// Sets the day of the calibration.
    #[must_use]
    pub fn with_calibration_date(mut self, date: Date) -> Self {
        self.calibrated_on = Some(date);
        self
    }

    /// The transducer.
    #[must_use]
    pub fn transducer(&self) -> &Transducer {
        &self.transducer
    }

    /// Gain of the amplifier.
    #[must_use]
    pub fn gain(&self) -> &Rating {
        &self.gain
    }

    /// Sign of the signal.
    #[must_use]
    pub fn polarity(&self) -> Polarity {
        self.polarity
    }

    /// The number that the recorder gives for zero input.
    #[must_use]
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// Delay of the samples relative to the record's time axis \[s\].
    #[must_use]
    pub fn time_skew(&self) -> f64 {
        self.time_skew
    }

    /// Standard uncertainty of the time skew \[s\]. It remains after the skew itself has been
    /// corrected ([`Record::aligned`](crate::Record::aligned)).
    #[must_use]
    pub fn time_skew_uncertainty(&self) -> f64 {
        self.time_skew_uncertainty
    }

    /// Position of the sensor.
    #[must_use]
    pub fn position(&self) -> Option<Position> {
        self.position
    }

    /// Direction in which the sensor measures.
    #[must_use]
    pub fn direction(&self) -> Option<Direction> {
        self.direction
    }

    /// Serial number of the sensor.
    #[must_use]
    pub fn serial(&self) -> Option<&str> {
        self.serial.as_deref()
    }

    /// Day of the sensor's calibration.
    #[must_use]
    pub fn calibrated_on(&self) -> Option<Date> {
        self.calibrated_on
    }

    /// Relative standard uncertainty of a quantity measured by this chain: the root sum of squares
    /// of the relative uncertainties of its factors, which are assumed independent.
    ///
    /// # Validity
    ///
    /// For bridges, to first order in the strain: a strain of 0.001 changes the uncertainty by a
    /// relative 0.001, which is neglected.
    #[must_use]
    pub fn relative_uncertainty(&self) -> f64 {
        let gain = self.gain.relative_uncertainty();
        match &self.transducer {
            Transducer::Sensitivity(sensitivity) => gain.hypot(sensitivity.relative_uncertainty()),
            Transducer::Bridge(bridge) => gain
                .hypot(bridge.gauge_factor().relative_uncertainty())
                .hypot(bridge.excitation().relative_uncertainty()),
        }
    }

    /// Returns the measured quantity of a channel that was recorded as `recorded`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnitMismatch`] if the result has the dimension of no [`Quantity`].
    pub fn quantity_from(&self, recorded: Quantity) -> Result<Quantity, LabioError> {
        let at_transducer = recorded.dimension().quotient(self.gain.unit().dimension());
        let felt = match &self.transducer {
            Transducer::Sensitivity(sensitivity) => at_transducer
                .and_then(|signal| signal.quotient(sensitivity.unit().dimension()))
                .and_then(Quantity::of_dimension),
            Transducer::Bridge(_) => {
                (at_transducer == Some(Quantity::Voltage.dimension())).then_some(Quantity::Strain)
            }
        };
        if let Some(felt) = felt {
            return Ok(felt);
        }
        let (unit, gain) = (recorded.unit(), self.gain.unit());
        let channel = format!("a channel recorded in {unit}");
        let Transducer::Sensitivity(sensitivity) = &self.transducer else {
            let found = format!("{unit} divided by {gain}");
            return unit_mismatch(channel, found, "a bridge voltage");
        };
        let sensitivity = sensitivity.unit();
        if !matches!(recorded, Quantity::Voltage | Quantity::Charge) {
            let expected = format!(
                "the unit of a signal, such as V; if the file is in {unit} already, leave out the sensitivity in {sensitivity}"
            );
            return unit_mismatch("the file", unit, expected);
        }
        if sensitivity.symbol().ends_with('V') {
            return unit_mismatch(
                "the sensitivity",
                sensitivity.to_string(),
                "its reciprocal, the signal divided by the measured quantity, such as \"2.25 mV/N\"",
            );
        }
        let of_charge = Quantity::Charge
            .dimension()
            .quotient(sensitivity.dimension())
            .and_then(Quantity::of_dimension);
        if at_transducer == Some(Quantity::Voltage.dimension()) && of_charge.is_some() {
            let charge = Quantity::Charge.unit();
            let expected = format!(
                "{charge} for a sensitivity in {sensitivity}: with a charge amplifier, state its gain, such as \"10 mV/pC\""
            );
            return unit_mismatch("the record", unit, expected);
        }
        unit_mismatch(
            channel,
            format!("{unit} divided by {gain} and {sensitivity}"),
            format!(
                "the unit of a channel quantity{}",
                misread(sensitivity.symbol())
            ),
        )
    }

    /// Returns the quantity, in SI units, for the recorded number `recorded` (in SI units); NaN for
    /// a voltage that no strain produces.
    #[must_use]
    pub fn si_from(&self, recorded: f64) -> f64 {
        let signal = self.polarity.sign() * (recorded - self.offset);
        match &self.transducer {
            Transducer::Sensitivity(sensitivity) => signal / (self.gain.si() * sensitivity.si()),
            Transducer::Bridge(bridge) => bridge.strain(signal / self.gain.si()),
        }
    }

    /// Returns the number that is recorded for the quantity `si`, the inverse of [`Self::si_from`].
    #[must_use]
    pub fn recorded_from(&self, si: f64) -> f64 {
        let signal = match &self.transducer {
            Transducer::Sensitivity(sensitivity) => si * (self.gain.si() * sensitivity.si()),
            Transducer::Bridge(bridge) => bridge.voltage(si) * self.gain.si(),
        };
        self.polarity.sign() * signal + self.offset
    }

    /// Returns the dimension of the recorded number for `quantity`, the inverse of
    /// [`Self::quantity_from`].
    pub(crate) fn recorded_dimension(&self, quantity: Quantity) -> Option<Dimension> {
        let signal = match &self.transducer {
            Transducer::Sensitivity(sensitivity) => quantity
                .dimension()
                .product(sensitivity.unit().dimension())?,
            Transducer::Bridge(_) if quantity == Quantity::Strain => Quantity::Voltage.dimension(),
            Transducer::Bridge(_) => return None,
        };
        signal.product(self.gain.unit().dimension())
    }
}

/// Spellings of "per m/s²" on data sheets that have another meaning as a unit, and that meaning.
const MISREAD: [(&str, &str); 8] = [
    ("/ms2", "square milliseconds"),
    ("/ms^2", "square milliseconds"),
    ("/ms²", "square milliseconds"),
    ("/ms-2", "milliseconds to the power -2"),
    ("/ms^-2", "milliseconds to the power -2"),
    ("/ms⁻²", "milliseconds to the power -2"),
    ("/m/s2", "a division by both m and s2"),
    ("/m/s²", "a division by both m and s²"),
];

/// Returns a remark on the unit that was probably meant by `unit`, to be appended to a message;
/// empty if `unit` contains none of the [`MISREAD`] spellings.
fn misread(unit: &str) -> String {
    let found = MISREAD.iter().find(|(written, _)| unit.contains(written));
    found.map_or_else(String::new, |(written, read)| {
        format!(
            ": `{}` reads as {read}; for an acceleration write {}",
            written.trim_start_matches('/'),
            unit.replacen(written, "/(m/s2)", 1)
        )
    })
}

fn positive(what: &'static str, rating: &Rating) -> Result<(), LabioError> {
    check_positive(what, rating.value())?;
    // in SI units: a unit prefix may take the value out of the range of `f64`
    check_positive(what, rating.si())?;
    Ok(())
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct SensorChainSheet {
    transducer: Transducer,
    gain: Option<Rating>,
    #[serde(default)]
    polarity: Polarity,
    #[serde(default)]
    offset: f64,
    #[serde(default)]
    time_skew: f64,
    #[serde(default)]
    time_skew_uncertainty: f64,
    position: Option<Position>,
    direction: Option<Direction>,
    serial: Option<String>,
    calibrated_on: Option<Date>,
}

#[cfg(feature = "serde")]
impl TryFrom<SensorChainSheet> for SensorChain {
    type Error = LabioError;

    fn try_from(sheet: SensorChainSheet) -> Result<Self, LabioError> {
        let mut chain = match sheet.transducer {
            Transducer::Sensitivity(sensitivity) => Self::of_sensitivity(sensitivity)?,
            Transducer::Bridge(bridge) => Self::of_bridge(bridge),
        };
        if let Some(gain) = sheet.gain {
            chain = chain.with_gain(gain)?;
        }
        if let Some(position) = sheet.position {
            chain = chain.with_position(position)?;
        }
        let chain = chain
            .with_polarity(sheet.polarity)
            .with_offset(sheet.offset)?
            .with_time_skew(sheet.time_skew)?
            .with_time_skew_uncertainty(sheet.time_skew_uncertainty)?;
        Ok(Self {
            direction: sheet.direction,
            serial: sheet.serial,
            calibrated_on: sheet.calibrated_on,
            ..chain
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BridgeLayout;
    use proptest::prelude::*;

    fn rating(value: f64, unit: &str) -> Rating {
        Rating::new(value, unit).unwrap()
    }

    #[test]
    fn a_charge_amplifier_goes_from_newtons_to_volts_and_back() {
        let chain = SensorChain::of_sensitivity(rating(4.0, "pC/N"))
            .unwrap()
            .with_gain(rating(10.0, "mV/pC"))
            .unwrap()
            .with_polarity(Polarity::Inverted)
            .with_offset(0.25)
            .unwrap();
        assert_eq!(
            chain.quantity_from(Quantity::Voltage).unwrap(),
            Quantity::Force
        );
        // 100 N give 400 pC, hence 4 V, which are inverted and shifted by the offset; the
        // tolerances allow rounding errors
        assert!((chain.recorded_from(100.0) + 3.75).abs() < 1e-14);
        assert!((chain.si_from(-3.75) - 100.0).abs() < 1e-12);
        assert_eq!(
            chain.recorded_dimension(Quantity::Force),
            Some(Quantity::Voltage.dimension())
        );
    }

    #[test]
    fn a_chain_keeps_what_is_stated_of_the_sensor() {
        let chain = || SensorChain::of_sensitivity(rating(10.0, "mV/g")).unwrap();
        let position = Position {
            x: 0.3,
            standard_uncertainty: 1e-4,
        };
        let day = Date::new(2024, 2, 29).unwrap();
        let stated = chain()
            .with_polarity(Polarity::Inverted)
            .with_offset(0.25)
            .unwrap()
            .with_time_skew(-3e-6)
            .unwrap()
            .with_time_skew_uncertainty(1e-7)
            .unwrap()
            .with_position(position)
            .unwrap()
            .with_direction(Direction::MinusX)
            .with_serial("4711")
            .with_calibration_date(day);
        assert_eq!(stated.polarity(), Polarity::Inverted);
        for (found, expected) in [
            (stated.offset(), 0.25),
            (stated.time_skew(), -3e-6),
            (stated.time_skew_uncertainty(), 1e-7),
        ] {
            assert!((found - expected).abs() <= 0.0, "{found} {expected}");
        }
        assert_eq!(stated.position(), Some(position));
        assert_eq!(stated.direction(), Some(Direction::MinusX));
        assert_eq!(stated.serial(), Some("4711"));
        assert_eq!(stated.calibrated_on(), Some(day));
        assert_eq!(*stated.gain(), rating(1.0, "1"));
        let at = |x: f64, standard_uncertainty: f64| Position {
            x,
            standard_uncertainty,
        };
        assert!(chain().with_position(at(f64::NAN, 0.0)).is_err());
        assert!(chain().with_position(at(0.1, -1e-3)).is_err());
        assert!(chain().with_time_skew_uncertainty(-1e-9).is_err());
        assert!(chain().with_offset(f64::INFINITY).is_err());
    }

    #[test]
    fn units_that_do_not_fit_are_refused() {
        let accelerometer = SensorChain::of_sensitivity(rating(10.0, "mV/g")).unwrap();
        let bridge = StrainBridge::new(BridgeLayout::Quarter, rating(2.0, "1"), rating(5.0, "V"));
        let gauges = SensorChain::of_bridge(bridge.unwrap());
        let of = |unit: &str| {
            let chain = SensorChain::of_sensitivity(rating(1.0, unit)).unwrap();
            chain.quantity_from(Quantity::Voltage)
        };
        let refusals = [
            accelerometer.quantity_from(Quantity::Charge),
            gauges.quantity_from(Quantity::Charge),
            SensorChain::of_sensitivity(rating(1.0, "V/s"))
                .unwrap()
                .quantity_from(Quantity::Voltage),
            of("mV/ms2"),
            of("pC/ms-2"),
            of("mV/m/s2"),
            of("pC/g"),
            of("N/V"),
        ]
        .map(|result| result.unwrap_err().to_string())
        .join("\n");
        insta::assert_snapshot!(refusals, @r#"
        a channel recorded in C is in C divided by 1 and mV/g, expected the unit of a channel quantity
        a channel recorded in C is in C divided by 1, expected a bridge voltage
        a channel recorded in V is in V divided by 1 and V/s, expected the unit of a channel quantity
        a channel recorded in V is in V divided by 1 and mV/ms2, expected the unit of a channel quantity: `ms2` reads as square milliseconds; for an acceleration write mV/(m/s2)
        a channel recorded in V is in V divided by 1 and pC/ms-2, expected the unit of a channel quantity: `ms-2` reads as milliseconds to the power -2; for an acceleration write pC/(m/s2)
        a channel recorded in V is in V divided by 1 and mV/m/s2, expected the unit of a channel quantity: `m/s2` reads as a division by both m and s2; for an acceleration write mV/(m/s2)
        the record is in V, expected C for a sensitivity in pC/g: with a charge amplifier, state its gain, such as "10 mV/pC"
        the sensitivity is in N/V, expected its reciprocal, the signal divided by the measured quantity, such as "2.25 mV/N"
        "#);
        assert!(SensorChain::of_sensitivity(rating(-10.0, "mV/g")).is_err());
        assert!(accelerometer.with_gain(rating(0.0, "1")).is_err());
    }

    fn chains() -> impl Strategy<Value = SensorChain> {
        let transducer = prop_oneof![
            (0.1..1000.0).prop_map(|s| SensorChain::of_sensitivity(rating(s, "mV/g")).unwrap()),
            (0.0..0.5, 1.0..200.0).prop_map(|(poisson_ratio, factor)| {
                let layout = BridgeLayout::FullPoisson { poisson_ratio };
                let bridge = StrainBridge::new(layout, rating(factor, "1"), rating(5.0, "V"));
                SensorChain::of_bridge(bridge.unwrap())
            }),
        ];
        (transducer, 0.01..1000.0, any::<bool>(), -1.0..1.0).prop_map(
            |(chain, gain, inverted, offset)| {
                let polarity = if inverted {
                    Polarity::Inverted
                } else {
                    Polarity::Normal
                };
                let chain = chain.with_gain(rating(gain, "1")).unwrap();
                chain.with_polarity(polarity).with_offset(offset).unwrap()
            },
        )
    }

    proptest! {
        #[test]
        fn what_is_recorded_of_a_quantity_stands_for_it(chain in chains(), y in -1e-3..1e-3) {
            let back = chain.si_from(chain.recorded_from(y));
            // a signal smaller than the offset of 1 V loses digits in their sum
            let signal = (chain.recorded_from(y) - chain.offset()).abs();
            let lost = 1e-15 * (1.0 + chain.offset().abs() / signal.max(1e-300));
            prop_assert!((back - y).abs() <= 4.0 * lost * y.abs(), "{back} {y}");
        }
    }
}
