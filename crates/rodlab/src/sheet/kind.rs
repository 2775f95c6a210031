//! Kinds of quantities in the fields of a sheet.

use labio::{Dimension, Quantity};

/// The kind of quantity of a field.
pub trait Kind {
    /// Name with article, such as `a length`.
    const NAME: &'static str;
    /// Example of a text of this kind, without an uncertainty.
    const EXAMPLE: &'static str;
    /// Dimension of the quantity.
    const DIMENSION: Dimension;
    /// True if zero and negative values are refused.
    const POSITIVE: bool;
    /// Smallest and largest value in SI units, and the words for a value outside of them, as in
    /// "`40` is outside -1 to 0.5"; by default any value is allowed.
    const RANGE: Option<([f64; 2], &'static str)> = None;
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident: $words:literal, $example:literal, $unit:expr, $positive:literal $(, $range:expr)?;)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub enum $name {}

        impl Kind for $name {
            const NAME: &'static str = $words;
            const EXAMPLE: &'static str = $example;
            const DIMENSION: Dimension = $unit;
            const POSITIVE: bool = $positive;
            $(const RANGE: Option<([f64; 2], &'static str)> = Some($range);)?
        }
    )*};
}

const fn dimension(length: i8, mass: i8, time: i8, temperature: i8) -> Dimension {
    Dimension {
        length,
        mass,
        time,
        current: 0,
        temperature,
    }
}

kinds! {
    /// A length above 0 \[m\], at most 100 m.
    Length: "a length", "\"800 mm\"", dimension(1, 0, 0, 0), true,
        ([0.0, 100.0], "is above 100 m, the limit of a length: mm is the usual unit");
    /// A coordinate \[m\], of any sign, at most 100 m from 0.
    Coordinate: "a coordinate", "\"0 mm\" or \"-12 mm\"", dimension(1, 0, 0, 0), false,
        ([-100.0, 100.0], "is more than 100 m from 0, the limit of a coordinate: mm is the usual unit");
    /// A mass above 0 \[kg\].
    ImpactMass: "a mass", "\"1.5 kg\" or \"2.9 gram\"", dimension(0, 1, 0, 0), true;
    /// A mass of 0 or more \[kg\]; 0 means that there is no accelerometer.
    AddedMass: "a mass", "\"2.9 gram\" or \"0 kg\"", dimension(0, 1, 0, 0), false;
    /// A density above 0 \[kg/m³\].
    Density: "a density", "\"1150 kg/m3\"", dimension(-3, 1, 0, 0), true;
    /// A duration above 0 \[s\].
    Duration: "a duration", "\"4 ms\"", dimension(0, 0, 1, 0), true;
    /// A time of any sign \[s\].
    Time: "a time", "\"0.5 s\" or \"120 us\"", dimension(0, 0, 1, 0), false;
    /// A frequency above 0 \[Hz\].
    Frequency: "a frequency", "\"51.2 kHz\"", dimension(0, 0, -1, 0), true;
    /// A velocity above 0 \[m/s\].
    Velocity: "a velocity", "\"0.93 m/s\"", dimension(1, 0, -1, 0), true;
    /// A force above 0 \[N\].
    Force: "a force", "\"5 N\" or \"2 kN\"", dimension(1, 1, -2, 0), true;
    /// A modulus or a stress above 0 \[Pa\].
    Pressure: "a modulus or stress", "\"2.6 GPa\"", dimension(-1, 1, -2, 0), true;
    /// A stress of any sign \[Pa\].
    Stress: "a stress", "\"45 MPa\" or \"0 MPa\"", dimension(-1, 1, -2, 0), false;
    /// A characteristic impedance above 0 \[kg/s\].
    SpecificImpedance: "a characteristic impedance", "\"1000 kg/s\" or \"1000 N s/m\"", dimension(0, 1, -1, 0), true;
    /// A stiffness above 0 \[N/m\].
    Stiffness: "a stiffness", "\"20 MN/m\"", dimension(0, 1, -2, 0), true;
    /// A viscosity above 0 \[Pa s\].
    Viscosity: "a viscosity", "\"20 kPa s\"", dimension(-1, 1, -1, 0), true;
    /// A temperature \[K\].
    Temperature: "a temperature", "\"23 degC\" or \"296 K\"", dimension(0, 0, 0, 1), true;
    /// A relative change per kelvin \[1/K\].
    PerKelvin: "a change per degree", "\"-0.004 1/K\" or \"-0.004 1/K ± 0.001 1/K\"", dimension(0, 0, 0, -1), false;
    /// A pure number above 0.
    Ratio: "a pure number", "\"0.094\" or \"9.4 %\"", Dimension::NONE, true;
    /// A Poisson's ratio, from -1 to 0.5.
    PoissonRatio: "Poisson's ratio", "\"0.40\" or \"0.40 ± 0.02\"", Dimension::NONE, false,
        ([-1.0, 0.5], "is outside -1 to 0.5");
}

/// Returns the name of the quantity with this dimension, with its article, such as `a mass`; `None`
/// if there is no name.
pub(super) fn name_of(dimension: Dimension) -> Option<&'static str> {
    fn of<K: Kind>() -> (Dimension, &'static str) {
        (K::DIMENSION, K::NAME)
    }
    let named = [
        of::<Length>(),
        of::<ImpactMass>(),
        of::<Density>(),
        of::<Time>(),
        of::<Frequency>(),
        of::<Velocity>(),
        of::<Force>(),
        of::<Pressure>(),
        of::<SpecificImpedance>(),
        of::<Stiffness>(),
        of::<Viscosity>(),
        of::<Temperature>(),
        of::<PerKelvin>(),
        of::<Ratio>(),
        (Quantity::Acceleration.dimension(), "an acceleration"),
        (Quantity::Charge.dimension(), "a charge"),
        (Quantity::Voltage.dimension(), "a voltage"),
    ];
    let found = named.into_iter().find(|(known, _)| *known == dimension);
    found.map(|(_, name)| name)
}
