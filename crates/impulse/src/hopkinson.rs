//! Evaluation of split Hopkinson bars: from the strains of two bars to the stress-strain curve of
//! the specimen, with bands.
//!
//! # Problem
//!
//! A specimen lies between two bars. Strain gauges on the bars record waves that travel with
//! $`\gamma(\omega)`$. With $`x`$ from the incident to the transmitted bar, strain $`\varepsilon`$
//! positive in tension, and $`P`$, $`N`$ the waves along and against $`x`$ at a face,
//!
//! ```math
//! F = A E^*(P + N) ,\qquad v = -\frac{i\omega}{\gamma}\,(P - N) ,\qquad E^* = -\frac{\rho\omega^2}{\gamma^2} .
//! ```
//!
//! The forces $`F_1, F_2`$ and velocities $`v_1, v_2`$ of both faces give stress, strain rate and
//! strain of the specimen (Kolsky 1949; Gray 2000). Each viscoelastic bar has a complex
//! $`\gamma(\omega)`$ of its own (Zhao and Gary 1996; Bacon 1998); round metal bars have that of
//! Pochhammer and Chree.
//!
//! # Method
//!
//! | file | step |
//! |---|---|
//! | `bar.rs`, `specimen.rs` | properties of bars, gauges and specimen |
//! | `noise.rs` | noise before the pulse |
//! | `plan.rs` | band, windows and times of the result |
//! | `separation.rs` | waves at the faces from the records |
//! | `coarse.rs` | the record at the sampling rate that its band needs, for the errors |
//! | `curves.rs` | forces, velocities, stress and strain from the waves |
//! | `source.rs` | named sources of common errors |
//! | `shot.rs`, `result.rs` | evaluation of a shot, with bands and error budget |
//! | `pair.rs` | lag and ratio of two gauges before a wave returns |
//! | `finding.rs` | objections to the result |
//! | `average.rs` | stress against strain, of one shot or as the mean of several |
//!
//! Theory: `docs/theory/hopkinson-bars.md`.

mod arrival;
mod average;
mod bar;
mod coarse;
mod curves;
mod finding;
mod noise;
mod pair;
mod plan;
mod record;
mod result;
mod separation;
mod shot;
mod source;
mod specimen;
mod student;

pub use arrival::Arrival;
pub use average::MeanCurve;
pub use bar::{BarGauge, BarMaterial, HopkinsonBar, Known};
pub use curves::{Curve, Curves};
pub use finding::Finding;
pub use noise::QuietNoise;
pub use plan::{StressFrom, WaveSeparation};
pub use record::HopkinsonRecord;
pub use result::{Energies, Equilibrium, HopkinsonResult, SourceEffect};
pub use shot::HopkinsonTest;
pub use source::{MaterialVariation, Side, Source};
pub use specimen::{Loading, TestSpecimen};
