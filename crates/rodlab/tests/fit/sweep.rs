//! A virtual sweep of a fractional Zener model that shifts with temperature, with noise of
//! magnitude and phase; its formulas are independent of the program.

use std::f64::consts::{LN_10, PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::runs::Folder;

pub(super) const RELAXED: f64 = 40e6;
pub(super) const UNRELAXED: f64 = 2.6e9;
pub(super) const RELAXATION_TIME: f64 = 2e-3;
pub(super) const EXPONENT: f64 = 0.45;
pub(super) const C1: f64 = 12.0;
/// Second constant of WLF \[K\].
pub(super) const C2: f64 = 90.0;
/// Reference temperature \[°C\].
pub(super) const REFERENCE: f64 = 60.0;
/// Relative error of |E|.
const NOISE: f64 = 0.01;
const GAS_CONSTANT: f64 = 8.314_462_618;

/// Temperatures in °C.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Temperatures(Vec<i32>);

impl Temperatures {
    pub(super) fn of(from: i32, to: i32, step: usize) -> Self {
        Self((from..=to).step_by(step).collect())
    }

    pub(super) fn all(&self) -> Vec<i32> {
        self.0.clone()
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}

/// Layout of the columns of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// `E'` and `tan δ` with their errors.
    LossFactor,
    /// `|E|` and `δ`, columns 3 and 4.
    Phase,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sweep {
    pub(super) temperatures: Temperatures,
    /// Number of frequencies per decade, from 0.1 to 100 Hz.
    pub(super) per_decade: i32,
    /// Activation energy of Arrhenius shifts [J/mol]; `None` for WLF.
    pub(super) activation_energy: Option<f64>,
    pub(super) exponent_per_kelvin: f64,
    /// True if all moduli are proportional to T/T_r.
    pub(super) is_entropic: bool,
    /// Standard deviation of the phase \[rad\].
    pub(super) phase_noise: f64,
}

impl Default for Sweep {
    fn default() -> Self {
        Self {
            temperatures: Temperatures::of(30, 90, 5),
            per_decade: 4,
            activation_energy: None,
            exponent_per_kelvin: 0.0,
            is_entropic: false,
            phase_noise: NOISE,
        }
    }
}

impl Sweep {
    pub(super) fn log10_shift(&self, celsius: f64) -> f64 {
        let d = celsius - REFERENCE;
        match self.activation_energy {
            Some(energy) => {
                let inverse = |celsius: f64| (celsius + 273.15).recip();
                energy / GAS_CONSTANT * (inverse(celsius) - inverse(REFERENCE)) / LN_10
            }
            None => -C1 * d / (C2 + d),
        }
    }

    /// The law at the reference temperature.
    pub(super) fn at_reference(&self, frequency_hz: f64) -> Complex64 {
        law(TAU * frequency_hz, EXPONENT)
    }

    /// Names and values of the parameters at the reference temperature.
    pub(super) fn parameters(&self) -> [(&'static str, f64); 4] {
        [
            ("relaxed modulus", RELAXED),
            ("modulus increment", UNRELAXED - RELAXED),
            ("relaxation time", RELAXATION_TIME),
            ("exponent", EXPONENT),
        ]
    }

    /// Temperature, frequency and modulus of all rows.
    fn rows(&self, seed: u64) -> Vec<(i32, f64, Complex64)> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut rows = Vec::new();
        for t in &self.temperatures.0 {
            let celsius = f64::from(*t);
            let shift = 10_f64.powf(self.log10_shift(celsius));
            let exponent = EXPONENT + self.exponent_per_kelvin * (celsius - REFERENCE);
            let factor = if self.is_entropic {
                (celsius + 273.15) / (REFERENCE + 273.15)
            } else {
                1.0
            };
            for line in 0..=3 * self.per_decade {
                let f = 10_f64.powf(f64::from(line) / f64::from(self.per_decade) - 1.0);
                let exact = factor * law(TAU * f * shift, exponent);
                let noise =
                    Complex64::from_polar(1.0 + NOISE * normal(), self.phase_noise * normal());
                rows.push((*t, f, exact * noise));
            }
        }
        rows
    }

    /// Writes a table in MPa, sorted by falling frequency, then by temperature.
    pub(super) fn write(&self, path: &Path, seed: u64) {
        fs::write(path, self.table(seed)).unwrap();
    }

    /// A folder with `sweep.csv`.
    pub(super) fn written(&self, seed: u64) -> Folder {
        let folder = Folder::new();
        self.write(&folder.file("sweep.csv"), seed);
        folder
    }

    /// The text of [`Sweep::write`], rounded because the last digits differ between processors.
    pub(super) fn table(&self, seed: u64) -> String {
        let mut rows = self.rows(seed);
        rows.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut text = "f,E',E'',T\nHz,MPa,MPa,C\n".to_owned();
        for (t, f, modulus) in rows {
            let (storage, loss) = (1e-6 * modulus.re, 1e-6 * modulus.im);
            writeln!(text, "{f:.6},{storage:.4},{loss:.4},{t}").unwrap();
        }
        text
    }

    /// Writes the same data with other columns and units and with decimal commas.
    pub(super) fn write_as(&self, path: &Path, seed: u64, layout: Layout) {
        let mut text = match layout {
            Layout::LossFactor => "T;omega;E';tan delta;u E';u tan\n;rad/s;GPa;-;kPa;-\n",
            Layout::Phase => "T;omega;|E|;delta\n;rad/s;Pa;deg\n",
        }
        .to_owned();
        for (t, f, modulus) in self.rows(seed) {
            let kelvin = f64::from(t) + 273.15;
            let omega = TAU * f;
            let row = match layout {
                Layout::LossFactor => {
                    let tan = modulus.im / modulus.re;
                    // to first order in the errors of |E| and δ
                    let of_storage = 1e-3 * NOISE * modulus.norm();
                    let of_tan = NOISE * (1.0 + tan * tan);
                    format!(
                        "{kelvin};{omega};{};{tan};{of_storage};{of_tan}",
                        1e-9 * modulus.re
                    )
                }
                Layout::Phase => {
                    format!(
                        "{kelvin};{omega};{};{}",
                        modulus.norm(),
                        modulus.arg().to_degrees()
                    )
                }
            };
            text += &row.replace('.', ",");
            text += "\n";
        }
        fs::write(path, text).unwrap();
    }

    /// A sheet of `sweep.csv` with the errors of its noise.
    pub(super) fn sheet(&self, rest: &str) -> String {
        format!(
            r#"Fit(
    title: "virtual sweep",
    tables: [(files: ["sweep.csv"], frequency: "f", modulus: Parts(storage: "E'", loss: "E''"), temperature: Column("T"),
        errors: MagnitudeAndPhase(magnitude: "1 %", phase: "{phase}"),
    )],
    reference_temperature: "60 degC",
    {rest}
)"#,
            phase = self.phase_noise
        )
    }
}

/// Complex modulus E₀ + ΔE (iωτ)^α/(1 + (iωτ)^α).
fn law(omega: f64, exponent: f64) -> Complex64 {
    let power = Complex64::from_polar(
        (omega * RELAXATION_TIME).powf(exponent),
        0.5 * PI * exponent,
    );
    RELAXED + (UNRELAXED - RELAXED) * power / (1.0 + power)
}
