//! Claims on paper D, Table A1, where the output of the direct problem is the input of the
//! identification. As in the paper, the inverting solver generates the data, so that only the
//! search is tested.

use maxwellid::{Fit, IdentifiableLaw, Noise, Provenance, RodTest, RodTestData};
use rodwave::band_limited::{Recorder, SampledHistory};
use rodwave::experiment::Acquisition;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::{DirectProblem, InelasticRod, characteristics};

use crate::virtual_rod::{RATE, V0, times};
use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::hold;
use testbed::papers::paper_d::{self, AppendixRow, LawParameters, UnitReading};

const CELLS: usize = 100;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims.by("paper D, Table A1, units as printed; a round trip: data by the solver that inverts");
    let paper = match paper_d::load() {
        Ok(paper) => paper,
        Err(error) => {
            let yes = Within(0.5, "yes or no");
            claims.claim("Table A1 can be read", "1", 1.0, yes, Err(error.into()));
            return;
        }
    };
    for row in paper.appendix(UnitReading::Literal) {
        let found = recovered(row);
        for parameter in &row.parameters {
            let (symbol, unit) = (parameter.parameter, unit(parameter.parameter));
            let expected = value(row.input, symbol);
            claims.claim(
                format!(
                    "{}: {symbol} from its own data, printed {}",
                    row.model.symbol(),
                    parameter.input.printed
                ),
                unit,
                expected,
                Within(
                    parameter.relative_error.value * expected,
                    "the error that the paper prints for its own result",
                ),
                of(&found, |found| {
                    let same = found.iter().find(|(name, _)| *name == symbol);
                    same.map_or(f64::NAN, |(_, value)| *value)
                }),
            );
        }
    }
    hold!(claims);
}

fn unit(symbol: &str) -> &'static str {
    match symbol {
        "E" | "m" => "Pa",
        "eta" => "Pa s",
        "B" => "Pa^kappa s",
        _ => "1",
    }
}

fn value(law: LawParameters, symbol: &str) -> f64 {
    match (law, symbol) {
        (
            LawParameters::Maxwell { modulus, .. }
            | LawParameters::MaxwellNorton { modulus, .. }
            | LawParameters::MaxwellGurevichRabinovich { modulus, .. },
            "E",
        ) => modulus,
        (
            LawParameters::Maxwell { viscosity, .. }
            | LawParameters::MaxwellGurevichRabinovich { viscosity, .. },
            "eta",
        ) => viscosity,
        (LawParameters::MaxwellNorton { exponent, .. }, "kappa") => exponent,
        (LawParameters::MaxwellNorton { coefficient, .. }, "B") => coefficient,
        (
            LawParameters::MaxwellGurevichRabinovich {
                activation_stress, ..
            },
            "m",
        ) => activation_stress,
        _ => f64::NAN,
    }
}

type Parameters = Vec<(&'static str, f64)>;

fn recovered(row: &AppendixRow) -> Ours<Parameters> {
    match row.input {
        LawParameters::Maxwell { modulus, viscosity } => {
            round_trip(row, modulus, &Maxwell::new(viscosity)?, Maxwell::new(1e6)?)
        }
        LawParameters::MaxwellNorton {
            modulus,
            exponent,
            coefficient,
        } => round_trip(
            row,
            modulus,
            &MaxwellNorton::new(exponent, coefficient)?,
            MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6)?,
        ),
        LawParameters::MaxwellGurevichRabinovich {
            modulus,
            viscosity,
            activation_stress,
        } => round_trip(
            row,
            modulus,
            &MaxwellGurevichRabinovich::new(viscosity, activation_stress)?,
            MaxwellGurevichRabinovich::from_reference_rate(0.2, 1.0, 10e6)?,
        ),
    }
}

fn round_trip<L: IdentifiableLaw>(
    row: &AppendixRow,
    modulus: f64,
    truth: &L,
    start: L,
) -> Ours<Parameters> {
    let length = row.section_distance;
    // the rubber of test M_3 needs a record twice as long as the plastics
    let samples_after = if modulus < 1e9 { 256 } else { 128 };
    let record = ImpactTest {
        striker: Striker::PAPER_D,
        rod: InelasticRod::new(length + 0.008, row.density, modulus, truth.clone())?,
        diameter: row.diameter,
        section_distance: length,
    }
    .record(
        &Acquisition {
            recorder: Recorder {
                rate_hz: RATE,
                cutoff_hz: 16_000.0,
            },
            samples_before: 32,
            samples_after,
            transducer_range: 0.02,
        },
        // a ninetieth of the shortest wavelength in the record
        (modulus / row.density).sqrt() / 16_000.0 / 90.0,
    )?;
    let excitation = SampledHistory::new(&record.excitation, RATE)?;
    let rod = InelasticRod::new(length, row.density, modulus, truth.clone())?;
    let response = DirectProblem::new(rod, CELLS)?
        .free_end_velocity(&excitation, &times(record.excitation.len()))?;
    let test = RodTest::new(RodTestData {
        name: "virtual rod".into(),
        length,
        density: row.density,
        impact_velocity: V0,
        sampling_rate_hz: RATE,
        excitation: record.excitation,
        response,
        provenance: Provenance::Virtual {
            generator: characteristics::GENERATOR.into(),
        },
    })?;
    let fit = Fit::of(start)
        .with_cell(length / CELLS as f64)
        .round_trip()
        .to(&[test])?;
    let judged = fit
        .identifiability(Noise::FromResidual)
        .ok_or_else(|| missing("the covariance"))?;
    let estimates = judged.estimates.iter();
    Ok(estimates
        .map(|estimate| (estimate.symbol, estimate.value))
        .collect())
}
