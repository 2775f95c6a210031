//! Records of impact tests and their averaged spectra.
//!
//! # The problem
//!
//! A body is struck a few times with an instrumented hammer; the force $`f(t)`$ and the responses
//! $`x_j(t)`$ are sampled. The result is the frequency response $`H(\omega) = \hat x/\hat f`$ with
//! the ordinary coherence, the number of averages and the random error of every line. The mobility
//! of an impact face (Ödeen 1993, paper E, section 3.1) and the ratio of two end accelerations
//! (paper A) are obtained in this way.
//!
//! The steps are: a file ([`mod@format`]) is read as a [`Record`], the [`SensorChain`] of each
//! channel converts volts to quantities, and the [`hits`] are found and checked. A
//! [`SpectrumAverager`], whose memory does not grow with the number of hits, averages records to
//! [`AveragedSpectra`]; [`Welch`] does so for a long record or a stream. Spectra give a
//! [`FrequencyResponse`] and a [`Coherence`]. Responses of two hammers are merged
//! ([`MergedResponse`]), converted to another kind ([`ResponseKind`]), completed at low frequencies
//! ([`RigidBody`]), tested for passivity and converted to an [`ImpulseResponse`]. An [`instrument`]
//! makes records for virtual experiments.
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
//!     // the response is one sample later than the force, and twice as large
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
//! From a file of volts to a frequency response:
//!
//! ```
//! use labio::hits::{Criteria, Extent, Trigger, find_hits};
//! use labio::{AveragedSpectra, Rating, SensorChain, Window, format};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("hits.csv");
//! # // three hits of a hammer on a mass of 0.5 kg, in volts
//! # let mut table = String::from("Time [s],force [V],acceleration [V]\n");
//! # for n in 0..6000 {
//! #     let t = (n % 2000) as f64 - 500.0;
//! #     let noise = |k: usize| 1e-5 * ((n * n * k) as f64).sin();
//! #     let blow = if (0.0..20.0).contains(&t) { (std::f64::consts::PI * t / 20.0).sin() } else { 0.0 };
//! #     table += &format!("{:.4},{},{}\n", n as f64 * 1e-4, blow + noise(1), 2.0 * blow + noise(3));
//! # }
//! # std::fs::write(&path, table)?;
//! let hammer = SensorChain::of_sensitivity(Rating::new(10.0, "mV/N")?)?;
//! let accelerometer = SensorChain::of_sensitivity(Rating::new(10.0, "mV/(m/s2)")?)?;
//!
//! let record = format::read_record(&path)?.calibrate([("force", hammer), ("acceleration", accelerometer)])?;
//! let trigger = Trigger::new("force", 20.0, Extent::Seconds(0.1))?.with_pre_trigger(Extent::Seconds(0.02));
//! let hits = find_hits(&record, &trigger, &Criteria::hammer())?;
//! let frf = AveragedSpectra::of(hits.accepted(), Window::Rectangular)?.h1("force", "acceleration")?;
//! assert_eq!(frf.n_averages, 3);
//! assert!((frf.values[5].norm() * 0.5 - 1.0).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```
//!
//! # Conventions
//!
//! - Time factor $`e^{+i\omega t}`$, forward kernel $`e^{-i\omega t}`$: a delay $`\tau`$ shifts the
//!   phase by $`-\omega\tau`$.
//! - Samples are SI numbers in `f64`; the [`Quantity`] of a channel names the unit.
//! - Arrays of samples are `(n_channels, n_samples)`. Spectra are one-sided and start at 0 Hz; an
//!   even number of samples puts a line on the Nyquist frequency, an odd number does not.
//! - Spectra are *energy* spectral densities per hit. The scaling is done only in
//!   [`SpectrumAverager`] and is stated there.
//! - A line without information is flagged by [`LineValidity`] and has the value NaN, so that it
//!   cannot be mistaken for a measurement.
//!
//! # Limitations
//!
//! Double hits and clipped samples are not repaired. Time steps must be uniform; nothing is
//! resampled. Hits are assumed independent; overlapped segments count by their effective number.
//! The bias caused by noise on one of the channels is bounded from the coherence
//! ([`FrequencyResponse::bias`]); the bias caused by leakage and finite resolution is not included
//! there.
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
mod known_part;
mod level_at_rest;
mod merge;
mod multi_input;
mod passivity;
mod provenance;
mod quantization;
pub mod ratio;
mod record;
mod rigid_body;
mod section_spectra;
mod series;
mod spectra;
mod stream;
mod unit;
mod window;

pub use calibration::{
    BridgeLayout, CalibratedBlocks, Date, Direction, Polarity, Position, Rating, SensorChain,
    SensorError, StrainBridge, Transducer,
};
pub use channel::{Channel, Quantity};
pub use convert::ResponseKind;
pub use error::{LabioError, Place};
pub use frf::{
    Bias, Coherence, Departure, Estimator, FrequencyResponse, LineValidity, RandomError,
};
pub use impulse_response::ImpulseResponse;
pub use integrate::{LowFrequency, differentiate, integrate};
pub use level_at_rest::LevelAtRest;
pub use merge::{Agreement, MergedResponse};
pub use multi_input::MultiInputResponse;
pub use passivity::{Passivity, PassivityReport};
pub use provenance::{ContentHash, Provenance};
pub use quantization::smallest_step;
pub use ratio::{DegreesOfFreedom, PulseWindow, ResponseRatio, noise_of_cut_pulse};
pub use record::Record;
pub use rigid_body::{CompletedResponse, RigidBand, RigidBody};
pub use section_spectra::SectionSpectra;
pub use series::{Abscissa, Contents, Ordinate, Series, SeriesAxis, SeriesKind};
pub use spectra::{
    AveragedSpectra, Detrend, RestNoise, SpectrumAverager, Welch, completed_motion,
    damping_of_ringing, from_rest,
};
pub use stream::BlockSource;
pub use unit::{Dimension, Unit};
pub use window::{AddedDamping, DampedMode, ForceWindow, SampledWindow, Window};

// Types in signatures, re-exported so that dependents of this crate alone get the matching version.
pub use {ndarray, num_complex, rand};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ExampleOfReadme;
