//! A member with measured mobilities of several points.

use num_complex::Complex64;
use rand::Rng;

use super::Substructure;
use crate::error::{check_length, check_spacing};
use crate::{Domain, ImpactBody, ImpulseError, MeasuredBody};

/// A member of an [`Assembly`](super::Assembly) described by the measured mobilities at and between
/// its points, all along one direction.
#[derive(Debug, Clone)]
pub struct MeasuredPoints {
    n_points: usize,
    /// Upper triangle, by rows.
    entries: Vec<MeasuredBody>,
}

impl MeasuredPoints {
    /// Creates a member of `n_points` points from the upper triangle of its mobilities, by rows:
    /// for two points, the mobility of the first point, the mobility between the two points, and
    /// the mobility of the second point. The behaviour at low frequency is taken from the first
    /// entry.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::LengthMismatch`] for a wrong number of entries or of lines;
    /// [`ImpulseError::GridMismatch`].
    pub fn of(n_points: usize, entries: Vec<MeasuredBody>) -> Result<Self, ImpulseError> {
        let expected = n_points * (n_points + 1) / 2;
        let Some(first) = entries.first().filter(|_| entries.len() == expected) else {
            return Err(ImpulseError::LengthMismatch {
                what: "list of measured mobilities of a member",
                found: entries.len(),
                expected: expected.max(1),
            });
        };
        for entry in &entries {
            let [found_hz, expected_hz] = [entry, first].map(MeasuredBody::frequency_step_hz);
            check_spacing("measured mobility of a member", found_hz, expected_hz)?;
            check_length(
                "measured mobility of a member",
                entry.mobility().len(),
                first.mobility().len(),
            )?;
        }
        Ok(Self { n_points, entries })
    }

    /// The measured mobilities: the upper triangle, by rows.
    #[must_use]
    pub fn entries(&self) -> &[MeasuredBody] {
        &self.entries
    }

    /// Draws a member with random errors as [`MeasuredBody::drawn`] does. The noise of each entry
    /// is drawn independently; `scale` and `delay` \[s\] are the same for all entries, as with one
    /// hammer.
    ///
    /// # Errors
    ///
    /// The errors of [`MeasuredBody::drawn`].
    pub fn drawn(
        &self,
        scale: f64,
        delay: f64,
        random: &mut impl Rng,
    ) -> Result<Self, ImpulseError> {
        let (mut common, mut entries) = (None, Vec::with_capacity(self.entries.len()));
        for entry in &self.entries {
            let common = match common {
                Some(common) => common,
                None => *common.insert(entry.common_errors(scale, delay, random)?),
            };
            entries.push(entry.with_errors(common, random)?);
        }
        Ok(Self {
            entries,
            ..self.clone()
        })
    }

    /// Returns the entry at a row and a column of the symmetric matrix.
    fn entry(&self, row: usize, column: usize) -> Option<&MeasuredBody> {
        let (row, column) = (row.min(column), row.max(column));
        let before = row * (2 * self.n_points + 1).saturating_sub(row) / 2;
        self.entries.get(before + column - row)
    }
}

impl Substructure for MeasuredPoints {
    fn domain(&self) -> Domain {
        let first = self.entries.first();
        first.map_or(Domain::RightHalfPlane, ImpactBody::domain)
    }

    fn n_points(&self) -> usize {
        self.n_points
    }

    fn write_mobilities(
        &self,
        s: Complex64,
        mobilities: &mut [Complex64],
    ) -> Result<(), ImpulseError> {
        for (row, mobilities) in mobilities.chunks_exact_mut(self.n_points).enumerate() {
            for (column, mobility) in mobilities.iter_mut().enumerate() {
                if let Some(entry) = self.entry(row, column) {
                    *mobility = entry.mobility_at(s)?;
                }
            }
        }
        Ok(())
    }

    fn free_mass(&self) -> Option<f64> {
        self.entries.first().and_then(ImpactBody::free_mass)
    }

    fn front_conductance(&self, point: usize) -> Option<f64> {
        let impedance = self.entry(point, point)?.front_impedance()?;
        Some(1.0 / impedance)
    }
}
