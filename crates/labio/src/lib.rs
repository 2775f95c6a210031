//! Records of impact tests and the averaged spectra made of them.
//!
//! # The problem
//!
//! A body is struck a few times with an instrumented hammer; the force $`f(t)`$ and the responses $`x_j(t)`$ are sampled.
//! Wanted is the frequency response $`H(\omega) = \hat x/\hat f`$ with the figures that say how far it can be believed: the
//! ordinary coherence, the number of averages and the random error of every line. This is how (Ödeen 1993, paper E,
//! section 3.1) obtains the mobility of an impact face, and (paper A) the ratio of two end accelerations.
//!
//! The walk is: a file ([`mod@format`]) becomes a [`Record`], volts become quantities by the [`SensorChain`] of each
//! channel, and the [`hits`] in it are found and judged; records become [`AveragedSpectra`] through a [`SpectrumAverager`],
//! whose memory does not grow with the number of hits, or those of a long record or a stream through [`Welch`]; spectra become a
//! [`FrequencyResponse`] and a [`Coherence`]. Responses of two hammers become one ([`MergedResponse`]), change their kind
//! ([`ResponseKind`]), are completed at low frequencies ([`RigidBody`]), tested for passivity and turned into an
//! [`ImpulseResponse`]. An [`instrument`] makes records for virtual experiments.
//!
//! ```
//! use labio::{AveragedSpectra, Channel, Provenance, Quantity, Record, Window};
//! use ndarray::array;
//!
//! # fn main() -> Result<(), labio::LabioError> {
//! let channels = [
//!     Channel::new("hammer", Quantity::Force)?,
//!     Channel::new("end A", Quantity::Acceleration)?,
//! ];
//! let hit = |force: f64| {
//!     // the body answers one sample later, with twice the number
//!     let samples = array![[0.0, force, 0.0, 0.0], [0.0, 0.0, 2.0 * force, 0.0]];
//!     Record::new(samples, 8000.0, 0.0, channels.to_vec(), Provenance::computed("example"))
//! };
//! let hits = [hit(1.0)?, hit(3.0)?, hit(2.0)?];
//!
//! let spectra = AveragedSpectra::of(&hits, Window::Rectangular)?;
//! let response = spectra.h1("hammer", "end A")?;
//! let delay = -response.values[1].arg() / (2.0 * std::f64::consts::PI * response.frequency_hz[1]);
//! assert!((response.values[1].norm() - 2.0).abs() < 1e-12);
//! assert!((delay - 1.0 / 8000.0).abs() < 1e-15);
//! assert_eq!(response.n_averages, 3);
//! # Ok(())
//! # }
//! ```
//!
//! # Conventions
//!
//! - Time factor $`e^{+i\omega t}`$, forward kernel $`e^{-i\omega t}`$: a delay $`\tau`$ turns the phase by $`-\omega\tau`$.
//! - Samples are SI numbers in `f64`; the [`Quantity`] of a channel names the unit.
//! - Arrays of samples are `(n_channels, n_samples)`. Spectra are one-sided and start at 0 Hz; an even number of samples
//!   puts a line on the Nyquist frequency, an odd number does not.
//! - Spectra are *energy* spectral densities per hit. The scaling is made in [`SpectrumAverager`] and nowhere else, and it
//!   is stated there.
//! - A line that carries no information is flagged by [`LineValidity`] and holds NaN, so that neither a zero nor a large
//!   number can pass for a measurement further on.
//!
//! # What this does not do
//!
//! No repair of double hits or of clipped samples. Time must be uniform; nothing is resampled. Hits are assumed independent; of
//! overlapped segments the effective number is taken. The bias by noise on one of the channels is bounded from the
//! coherence ([`FrequencyResponse::bias`]); that by leakage and finite resolution is not estimated.
//!
//! Theory: `docs/theory/hits.md`, `docs/theory/spectra.md`.

pub mod format;
pub mod hits;
pub mod instrument;

mod calibration;
mod channel;
mod convert;
mod dft;
mod error;
mod filter;
mod frf;
mod impulse_response;
mod integrate;
mod merge;
mod multi_input;
mod passivity;
mod provenance;
mod record;
mod rigid_body;
mod series;
mod spectra;
mod stream;
mod unit;
mod window;

pub use calibration::{
    BridgeLayout, CalibratedBlocks, Date, Direction, Polarity, Position, Rating, SensorChain,
    StrainBridge, Transducer,
};
pub use channel::{Channel, Quantity};
pub use convert::ResponseKind;
pub use error::{LabioError, Place};
pub use frf::{
    Bias, Coherence, Departure, Estimator, FrequencyResponse, LineValidity, RandomError,
};
pub use impulse_response::ImpulseResponse;
pub use integrate::{LowFrequency, differentiate, integrate};
pub use merge::{Agreement, MergedResponse};
pub use multi_input::MultiInputResponse;
pub use passivity::{Passivity, PassivityReport};
pub use provenance::{ContentHash, Provenance};
pub use record::Record;
pub use rigid_body::{CompletedResponse, RigidBand, RigidBody};
pub use series::{Abscissa, Contents, Ordinate, Series, SeriesAxis, SeriesKind};
pub use spectra::{
    AveragedSpectra, ChannelAtRest, Detrend, RestNoise, ShotRatio, SpectrumAverager, Welch,
    completed_motion, damping_of_ringing, from_rest,
};
pub use stream::BlockSource;
pub use unit::{Dimension, Unit};
pub use window::{AddedDamping, DampedMode, ForceWindow, SampledWindow, Window};

// In signatures: who depends on this crate alone names their types from here, in the version that fits.
pub use {ndarray, num_complex, rand};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ExampleOfReadme;
