//! Kinds of quantities in the fields of a sheet.

use labio::Dimension;

/// The kind of quantity of a field.
pub trait Kind {
    /// Name with article, such as `a length`.
    const NAME: &'static str;
    /// Example of its text, without an uncertainty.
    const EXAMPLE: &'static str;
    /// Dimension of the quantity.
    const DIMENSION: Dimension;
    /// True if zero and negative values are refused.
    const POSITIVE: bool;
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident: $words:literal, $example:literal, $unit:expr, $positive:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub enum $name {}

        impl Kind for $name {
            const NAME: &'static str = $words;
            const EXAMPLE: &'static str = $example;
            const DIMENSION: Dimension = $unit;
            const POSITIVE: bool = $positive;
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
    /// A length above 0 \[m\].
    Length: "a length", "\"800 mm\"", dimension(1, 0, 0, 0), true;
    /// A coordinate \[m\], of any sign.
    Coordinate: "a coordinate", "\"0 mm\" or \"-12 mm\"", dimension(1, 0, 0, 0), false;
    /// A mass above 0 \[kg\].
    ImpactMass: "a mass", "\"1.5 kg\" or \"2.9 gram\"", dimension(0, 1, 0, 0), true;
    /// A mass of 0 or more \[kg\]; 0 stands for an absent accelerometer.
    AddedMass: "a mass", "\"2.9 gram\" or \"0 kg\"", dimension(0, 1, 0, 0), false;
    /// A density above 0 [kg/m³].
    Density: "a density", "\"1150 kg/m3\"", dimension(-3, 1, 0, 0), true;
    /// A duration above 0 \[s\].
    Duration: "a duration", "\"4 ms\"", dimension(0, 0, 1, 0), true;
    /// A time of any sign \[s\].
    Time: "a time", "\"0.5 s\" or \"120 us\"", dimension(0, 0, 1, 0), false;
    /// A frequency above 0 \[Hz\].
    Frequency: "a frequency", "\"51.2 kHz\"", dimension(0, 0, -1, 0), true;
    /// A velocity above 0 [m/s].
    Velocity: "a velocity", "\"0.93 m/s\"", dimension(1, 0, -1, 0), true;
    /// A force above 0 \[N\].
    Force: "a force", "\"5 N\" or \"2 kN\"", dimension(1, 1, -2, 0), true;
    /// A modulus or a stress above 0 \[Pa\].
    Pressure: "a modulus or stress", "\"2.6 GPa\"", dimension(-1, 1, -2, 0), true;
    /// A stress of any sign \[Pa\].
    Stress: "a stress", "\"45 MPa\" or \"0 MPa\"", dimension(-1, 1, -2, 0), false;
    /// A characteristic impedance above 0 [kg/s].
    SpecificImpedance: "a characteristic impedance", "\"1000 kg/s\" or \"1000 N s/m\"", dimension(0, 1, -1, 0), true;
    /// A stiffness above 0 [N/m].
    Stiffness: "a stiffness", "\"20 MN/m\"", dimension(0, 1, -2, 0), true;
    /// A viscosity above 0 [Pa s].
    Viscosity: "a viscosity", "\"20 kPa s\"", dimension(-1, 1, -1, 0), true;
    /// A temperature \[K\].
    Temperature: "a temperature", "\"23 degC\" or \"296 K\"", dimension(0, 0, 0, 1), true;
    /// A relative change per degree of temperature [1/K].
    PerKelvin: "a change per degree", "\"-0.004 1/K\" or \"-0.004 1/K ± 0.001 1/K\"", dimension(0, 0, 0, -1), false;
    /// A pure number above 0.
    Ratio: "a pure number", "\"0.094\" or \"9.4 %\"", Dimension::NONE, true;
    /// A Poisson's ratio, 0 or above.
    PoissonRatio: "Poisson's ratio", "\"0.40\" or \"0.40 ± 0.02\"", Dimension::NONE, false;
}
