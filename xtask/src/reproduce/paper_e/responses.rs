//! Impulse responses of the faces.

use impulse::{Kernel, Quadrature, TimeGrid};
use num_complex::Complex64;

use super::super::{Error, Table};
use super::measurement::{self, Measurement};
use testbed::papers::paper_e::PaperE;
use testbed::papers::paper_e::bodies::Face;

/// Number of time steps of the impulse responses.
const STEPS: u32 = 256;

/// Responses of the faces to a unit impulse, without the jump at time 0: measured, and predicted
/// with the same band limit.
pub(crate) struct Responses {
    /// Times in ms.
    pub(crate) time: Vec<f64>,
    /// Measured and predicted response of each face, in m/(N s²).
    pub(crate) of_faces: Vec<[Vec<f64>; 2]>,
}

impl Responses {
    pub(crate) fn of(paper: &PaperE, measurements: &[Measurement]) -> Result<Self, Error> {
        // finer than necessary: the lines reach half of the Nyquist frequency only, for which twice
        // the sample period would suffice
        let grid = TimeGrid {
            time_step: 0.5 * paper.sample_period,
            n_steps: STEPS as usize,
        };
        let mut responses = Self {
            // the first two steps contain the jump
            time: (2..STEPS)
                .map(|n| 1e3 * grid.time_step * f64::from(n))
                .collect(),
            of_faces: Vec::new(),
        };
        for (face, measurement) in Face::ALL.into_iter().zip(measurements) {
            let predicted = impulse::lines_of(
                &paper.causal(face)?,
                measurement.frequency_step_hz,
                paper.n_lines(),
            )?;
            let response = |mobility: &[Complex64]| -> Result<Vec<f64>, Error> {
                let body = measurement::on_lines(paper, face, mobility, None)?;
                let kernel = Kernel::of(&body, grid, Quadrature::CellAverages)?;
                let weights = kernel.weights().iter().skip(2);
                Ok(weights.map(|weight| weight / grid.time_step).collect())
            };
            responses.of_faces.push([
                response(&measurement.larger_force.mobility)?,
                response(&predicted)?,
            ]);
        }
        Ok(responses)
    }

    pub(crate) fn table(&self) -> Table {
        let mut headings = vec!["time, ms".to_owned()];
        for face in Face::ALL {
            headings.push(format!("{} measured, m/(N s^2)", face.name()));
            headings.push(format!("{} predicted, m/(N s^2)", face.name()));
        }
        let mut table = Table::new(&headings);
        for (n, time) in self.time.iter().enumerate() {
            let mut cells = vec![format!("{time:.3}")];
            for pair in &self.of_faces {
                cells.extend(pair.iter().map(|values| format!("{:.4e}", values[n])));
            }
            table.row(cells);
        }
        table
    }
}
