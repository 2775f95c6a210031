//! Delay and length of a test about which its response is linearised.

use crate::model::DrivenRod;

/// Delay and length of a test about which its response is linearised.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Deviation {
    /// Delay of the response \[s\].
    pub(crate) delay: f64,
    /// Length relative to the stated length, minus 1.
    pub(crate) length: f64,
}

impl Deviation {
    /// The rod with its most likely length, on as many cells as the rod of the stated length:
    /// another number of cells would change the response of a nonlinear law by the error of the
    /// grid.
    pub(crate) fn of_rod<'a>(&self, rod: DrivenRod<'a>) -> DrivenRod<'a> {
        let factor = 1.0 + self.length;
        DrivenRod {
            length: factor * rod.length,
            cell: factor * rod.cell,
            ..rod
        }
    }
}

#[cfg(test)]
mod tests {
    use rodwave::band_limited::SampledHistory;

    use super::*;
    use crate::model::cells_of;

    #[test]
    fn a_rod_keeps_its_cells_with_another_length() {
        let samples = [0.0; 4];
        let excitation = SampledHistory::new(&samples, 50e3).unwrap();
        for length in [0.2, 0.299_81, 0.3, 0.394] {
            for cell in [2e-3, std::f64::consts::SQRT_2 * 1e-3, 0.5e-3] {
                let rod = DrivenRod {
                    length,
                    cell,
                    density: 1140.0,
                    samples: &samples,
                    excitation: &excitation,
                    sampling_rate_hz: 50e3,
                    times: &[],
                    temperature: None,
                    lateral_inertia: 0.0,
                };
                let expected = cells_of(&rod).unwrap();
                for deviation in [-2e-3, -1.37e-3, -3e-4, 1e-15, 6.2e-4, 2e-3] {
                    let moved = Deviation {
                        delay: 0.0,
                        length: deviation,
                    };
                    let rod = moved.of_rod(rod);
                    assert_eq!(cells_of(&rod).unwrap(), expected, "{length} {deviation}");
                }
            }
        }
    }
}
