//! Error type of this crate.

use rodwave::digits::significant;
use thiserror::Error;

/// Reason for refusing a specimen or a set of measured lines as a whole.
///
/// A single bad line is not an error: it is listed in
/// [`ModulusEstimate::refused`](crate::ModulusEstimate::refused), or its violations are listed in
/// [`ModulusLine::validity`](crate::ModulusLine).
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the message of an error names its fields")]
#[non_exhaustive]
pub enum CmodError {
    /// A physical quantity has an impossible value, or is not a number.
    #[error("{quantity} is {value}, expected {expected}")]
    NonPhysical {
        /// Name and unit of the quantity, such as `length [m]`.
        quantity: &'static str,
        value: f64,
        /// Condition that the value violates, such as `a finite value above 0`.
        expected: &'static str,
    },
    /// Arrays that belong together differ in length.
    #[error("{array} has {found} lines, expected {expected}, one per frequency")]
    LengthMismatch {
        /// Name of the wrong array.
        array: &'static str,
        /// Length of the wrong array.
        found: usize,
        expected: usize,
    },
    /// The public fields of a result were changed and are no longer consistent.
    #[error("the changed result has {found} {what}, expected at least {expected}")]
    ChangedResult {
        /// Name of the items that were counted.
        what: &'static str,
        found: usize,
        /// Number of items that the other fields require.
        expected: usize,
    },
    /// There are no lines to evaluate.
    #[error("no line to evaluate")]
    NoLines,
    /// A frequency is NaN, infinite or negative.
    #[error("frequency of line {index} is {frequency_hz} Hz, expected a finite value, 0 or above")]
    Frequency {
        /// Position of the line, from 0.
        index: usize,
        /// Value found \[Hz\].
        frequency_hz: f64,
    },
    /// The frequencies do not increase, as required to follow the branch of the wave number from
    /// line to line.
    #[error(
        "frequency of line {index} is {frequency_hz} Hz, expected more than the {previous_hz} Hz of the previous line"
    )]
    FrequencyOrder {
        /// Position of the line, from 0.
        index: usize,
        /// Value found \[Hz\].
        frequency_hz: f64,
        /// Value of the previous line \[Hz\].
        previous_hz: f64,
    },
    /// A ratio is NaN or infinite, although the sequence of lines must have no gaps.
    #[error("acceleration ratio of line {index} is {ratio}, expected a finite value")]
    NonFiniteRatio {
        /// Position of the line, from 0.
        index: usize,
        ratio: num_complex::Complex64,
    },
    /// There are not enough gauges: two waves and their propagation coefficient are three unknowns.
    #[error("{found} gauges, expected {expected}")]
    GaugeCount {
        /// Number of positions.
        found: usize,
        /// Required number, such as `3 or more`.
        expected: &'static str,
    },
    /// The positions of the gauges do not increase.
    #[error(
        "position of gauge {} is {position} m, expected more than the {previous} m of the previous gauge",
        gauge + 1
    )]
    PositionOrder {
        /// Position in the row of gauges, from 0.
        gauge: usize,
        /// Value found \[m\].
        position: f64,
        /// Value of the previous gauge \[m\].
        previous: f64,
    },
    /// Three gauges are not at equal distances, as the closed form requires.
    #[error(
        "distances of the outer gauges from the middle one are {} m and {} m, expected equal distances, or the method for gauges at any positions",
        significant(*first, 4),
        significant(*second, 4)
    )]
    NotEquidistant {
        /// Distance from the first to the middle gauge \[m\].
        first: f64,
        /// Distance from the middle to the last gauge \[m\].
        second: f64,
    },
    /// There is no test.
    #[error("no test to evaluate")]
    NoTests,
    /// A test has more or fewer gauge spectra than there are positions.
    #[error("test {test} has spectra of {found} gauges, expected {expected}, one per position")]
    SpectraOfTest {
        /// Index of the test, from 0.
        test: usize,
        found: usize,
        expected: usize,
    },
    /// A spectrum has more or fewer lines than there are frequencies.
    #[error(
        "spectrum of gauge {gauge} in test {test} has {found} lines, expected {expected}, one per frequency"
    )]
    SpectrumLength {
        /// Index of the test, from 0.
        test: usize,
        /// Index of the gauge, from 0.
        gauge: usize,
        found: usize,
        expected: usize,
    },
    /// The noise of a gauge is negative.
    #[error("noise of gauge {gauge} at line {line} is {noise}, expected 0 or above")]
    NegativeNoise {
        /// Index of the gauge, from 0.
        gauge: usize,
        /// Index of the line, from 0.
        line: usize,
        /// Value found, in the unit of the spectra.
        noise: f64,
    },
    /// A variance is negative.
    #[error("variance of line {index} is {variance}, expected 0 or above")]
    NegativeVariance {
        /// Position of the line, from 0.
        index: usize,
        variance: f64,
    },
    /// Two spectra of a ratio have different numbers of tests.
    #[error("numerator has {found} tests, expected {expected}, as many as the denominator")]
    TestCount { found: usize, expected: usize },
    /// The chosen sections have a ratio that does not depend on the material.
    #[error("{what}, expected sections whose ratio depends on the material")]
    NoInformation {
        /// Reason why the ratio does not depend on the material.
        what: &'static str,
    },
    /// The noise with which a value must be compared is 0.
    #[error("{what} {index} is 0, expected noise to compare with")]
    NoNoise {
        /// Quantity that is 0, such as `the noise of line`.
        what: &'static str,
        /// Position of the line or channel, from 0.
        index: usize,
    },
    /// A history is too short for the request.
    #[error("{what} has {found} samples, expected at least {expected}")]
    TooFewSamples {
        /// Part of the history that is too short.
        what: &'static str,
        found: usize,
        expected: usize,
    },
    /// A sample is NaN or infinite.
    #[error("sample {index} of channel {channel} is {value}, expected a finite value")]
    NonFiniteSample {
        /// Index of the channel, from 0.
        channel: usize,
        /// Index of the sample, from 0.
        index: usize,
        value: f64,
    },
    /// A coherence is not between 0 and 1.
    #[error("coherence of line {index} is {coherence}, expected a value from 0 to 1")]
    Coherence {
        /// Position of the line, from 0.
        index: usize,
        coherence: f64,
    },
    /// There are too few averages to estimate a variance.
    #[error("{found} averages, expected at least 2: the coherence of a single average is always 1")]
    TooFewAverages { found: f64 },
    /// A load history has no segments.
    #[error("no load segment")]
    NoLoad,
    /// The integration of the response to a load needed too many or too small steps.
    #[error(
        "response to load segment {segment} could not be integrated beyond {time} s after the start of the segment, expected model rates that are low enough for the duration of the segment"
    )]
    LoadNotIntegrated {
        /// Position of the segment, from 0.
        segment: usize,
        /// Time within the segment \[s\].
        time: f64,
    },
    /// Arrays of readings that belong together differ in length.
    #[error("{array} has {found} values, expected {expected}, one per {each}")]
    ReadingCount {
        /// Name of the wrong array.
        array: &'static str,
        /// Length of the wrong array.
        found: usize,
        expected: usize,
        /// Name of the items that have one value each.
        each: &'static str,
    },
    /// A reading of a recovery test is impossible.
    #[error("{quantity} of reading {index} of {test} is {value}, expected {expected}")]
    Reading {
        test: String,
        /// Name and unit of the quantity.
        quantity: &'static str,
        /// Position of the reading, from 0.
        index: usize,
        value: f64,
        /// Condition that the value violates.
        expected: &'static str,
    },
    /// There are too few data points for the request.
    #[error("{found} data points, expected at least {expected}")]
    TooFewReadings { found: usize, expected: usize },
    /// The test from which the fit starts does not exist.
    #[error("reference test {index} of {count} tests, expected an index below {count}")]
    ReferenceTest {
        /// Given index, from 0.
        index: usize,
        count: usize,
    },
    /// No starting parameters that explain the readings were found for the iteration.
    #[error("no starting parameters found, expected a loss factor that is raised after the load")]
    NoStart,
    /// No relaxing material could be fitted to the lines.
    #[error(
        "no relaxing material could be fitted, expected moduli with a positive real part and finite errors"
    )]
    NoCausalEstimate,
    /// A modulus, or its error, is impossible.
    #[error("{quantity} of point {index} is {value}, expected {expected}")]
    ModulusPoint {
        /// Position of the point, from 0.
        index: usize,
        /// Name and unit of the quantity.
        quantity: &'static str,
        value: f64,
        /// Condition that the value violates.
        expected: &'static str,
    },
    /// The moduli over time do not determine the parameters of a law, or the law has no response
    /// over time.
    #[error("{law} cannot be fitted to these moduli over time, expected moduli over frequency")]
    LawOverTime { law: String },
    /// Moduli over time were given, but moduli over frequency are needed.
    #[error("moduli over time in {what}, expected moduli over frequency alone")]
    MustOscillate {
        /// Purpose for which the moduli were given.
        what: &'static str,
    },
    /// No parameters of a law have a finite sum of squares.
    #[error("no starting parameters found for the {law} law, expected moduli within its range")]
    NoLaw { law: String },
    /// A temperature of a sweep is not above the previous one, or not above 0 K.
    #[error(
        "temperature {index} is {kelvin} K, expected a finite value above {previous} K: temperatures must increase"
    )]
    Temperature {
        /// Position in the sweep, from 0.
        index: usize,
        /// Value found \[K\].
        kelvin: f64,
        /// Previous value \[K\]; 0 for the first.
        previous: f64,
    },
    /// The shift factors of a master curve have no covariance.
    #[error(
        "the data do not determine a combination of the shift factors, expected temperatures whose curves overlap"
    )]
    ShiftsUndetermined,
    /// The programs that read cards do not accept the name of a material.
    #[error(
        "name of the material is {name:?}, expected a letter and up to 79 letters, digits, hyphens or underscores"
    )]
    CardName {
        /// Name that was given.
        name: String,
    },
    /// A card was requested for a fitted law that is not a Prony series.
    #[error(
        "the fitted law is {law}, expected a generalised Maxwell law: a card is a Prony series"
    )]
    CardLaw { law: String },
    /// A theory of lateral inertia for round rods was requested for a rod that is not round.
    #[error(
        "{theory} was requested for a rod that is not round, expected Love's theory, which applies to any section"
    )]
    TheoryOfRoundRods { theory: &'static str },
    /// The data do not determine a card of a relaxing solid.
    #[error("{what} is not determined by the data (nearest value {value}), expected {expected}")]
    CardUndetermined {
        /// Part of the card.
        what: &'static str,
        value: f64,
        /// Condition that the data of a card must fulfil.
        expected: &'static str,
    },
    /// A Prony series is too long for a program.
    #[error("{found} terms, expected at most {most}, the limit of {program}")]
    CardTerms {
        program: &'static str,
        found: usize,
        /// Maximum number of terms.
        most: usize,
    },
    /// The crate `rodwave` rejects the parameters of a law.
    #[error(transparent)]
    Rodwave(#[from] rodwave::RodwaveError),
}

/// Accepts a value if `is_right` is true.
pub(crate) fn check_that(
    is_right: bool,
    quantity: &'static str,
    value: f64,
    expected: &'static str,
) -> Result<f64, CmodError> {
    is_right.then_some(value).ok_or(CmodError::NonPhysical {
        quantity,
        value,
        expected,
    })
}

/// Accepts a finite value above zero.
pub(crate) fn check_positive(quantity: &'static str, value: f64) -> Result<f64, CmodError> {
    let is_right = value.is_finite() && value > 0.0;
    check_that(is_right, quantity, value, "a finite value above 0")
}

/// Accepts a finite value.
pub(crate) fn check_finite(quantity: &'static str, value: f64) -> Result<f64, CmodError> {
    check_that(value.is_finite(), quantity, value, "a finite value")
}

/// Accepts a finite value of zero or above.
pub(crate) fn check_not_negative(quantity: &'static str, value: f64) -> Result<f64, CmodError> {
    let is_right = value.is_finite() && value >= 0.0;
    check_that(is_right, quantity, value, "a finite value, 0 or above")
}

/// Accepts at least one line, and frequencies that are finite, not negative and increasing.
pub(crate) fn check_frequencies(frequency_hz: &[f64]) -> Result<(), CmodError> {
    if frequency_hz.is_empty() {
        return Err(CmodError::NoLines);
    }
    let mut previous = None;
    for (index, &frequency_hz) in frequency_hz.iter().enumerate() {
        if !(frequency_hz.is_finite() && frequency_hz >= 0.0) {
            return Err(CmodError::Frequency {
                index,
                frequency_hz,
            });
        }
        if let Some(previous_hz) = previous
            && frequency_hz <= previous_hz
        {
            return Err(CmodError::FrequencyOrder {
                index,
                frequency_hz,
                previous_hz,
            });
        }
        previous = Some(frequency_hz);
    }
    Ok(())
}

/// Accepts a number of data points `found` that is at least `expected`.
pub(crate) fn check_enough_readings(found: usize, expected: usize) -> Result<(), CmodError> {
    if found >= expected {
        Ok(())
    } else {
        Err(CmodError::TooFewReadings { found, expected })
    }
}

/// Accepts an array with one value for `each` of the `expected` things.
pub(crate) fn check_values(
    array: &'static str,
    found: usize,
    expected: usize,
    each: &'static str,
) -> Result<(), CmodError> {
    if found == expected {
        Ok(())
    } else {
        Err(CmodError::ReadingCount {
            array,
            found,
            expected,
            each,
        })
    }
}

/// Accepts an array of one value per line.
pub(crate) fn check_length(
    array: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), CmodError> {
    if found == expected {
        Ok(())
    } else {
        Err(CmodError::LengthMismatch {
            array,
            found,
            expected,
        })
    }
}
