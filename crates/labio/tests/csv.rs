//! Text tables: dialects as instruments write them, round trips, and the measured files if they are
//! available.

mod dialects;
mod instruments;
mod other_programs;
mod writing;
mod wrong_tables;

use testbed::measured;

use labio::format::csv::Csv;
use labio::format::{Reader, Strictness};
use labio::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesKind};
use num_complex::Complex64;

use crate::series::{axis, bare, defects, even, pair, property, real, refusals, written};

fn read(bytes: impl AsRef<[u8]>) -> Result<Contents, LabioError> {
    Csv.read(bytes.as_ref(), Strictness::Strict)
}

fn names(contents: &Contents) -> Vec<String> {
    contents
        .series
        .iter()
        .map(|s| format!("{} [{}]", s.name, s.ordinate_axis.unit_text))
        .collect()
}

pub(crate) fn write(contents: &Contents) -> Result<Vec<u8>, LabioError> {
    written(&Csv, contents)
}

pub(crate) fn sample() -> Contents {
    let mut contents = Contents::of_format("csv");
    contents.properties.push(pair("Operator", "S. \u{d6}deen"));
    let series = |name: &str, kind, ordinate| Series {
        kind,
        abscissa: even(-0.1, 0.1),
        abscissa_axis: axis("Time", "s"),
        ..bare(name, ordinate)
    };
    let mut force = series(
        "F, \"left\"",
        SeriesKind::TimeResponse,
        Ordinate::Real(vec![1.0, -2.5e-300]),
    );
    force.ordinate_axis = axis("", "N");
    force.properties.push(pair("block", "2"));
    contents.series.push(force);
    contents.series.push(series(
        "",
        SeriesKind::Other(27),
        Ordinate::Complex(vec![Complex64::new(-0.0, f64::NEG_INFINITY)]),
    ));
    contents.series.push(series(
        "end A",
        SeriesKind::FrequencyResponse,
        Ordinate::Real(vec![f64::INFINITY, 0.1, 1e22]),
    ));
    contents
}

fn measured(file: &str) -> Option<Vec<u8>> {
    Some(std::fs::read(measured::folder()?.join(file)).unwrap())
}

#[test]
fn the_measured_tables_read() {
    let mut said = String::new();
    for file in [
        "shpb/impact_compression_epoxy_resin_sample_01_raw_voltage.csv",
        "shpb/impact_compression_epoxy_resin_experiment_details_en-US.txt",
        "shpb/epoxy/raw_strain.csv",
        "shpb/pmma-13/180303_171828_Ch1.csv",
        "shpb/copper/gauge_strain_records.csv",
        "dma/pyvisco_freq_user_raw.csv",
        "dma/glassy-polymer/T25.txt",
        "tapered-rod/axial_wavenumber_est_30.txt",
        "tapered-rod/beam_input_FRF.txt",
        "tapered-rod/beam_transfer_FRF.txt",
        "tapered-rod/rod_input_FRF_acc.txt",
        "tapered-rod/rod_transfer_FRF_acc.txt",
    ] {
        let Some(bytes) = measured(file) else { return };
        let recognised = Csv.recognises(&bytes);
        said += &format!(
            "{file}, {}recognised\n",
            if recognised { "" } else { "not " }
        );
        match Csv.read(&bytes, Strictness::Strict) {
            Ok(_) => said += "  strictly: reads\n",
            Err(error) => said += &format!("  strictly: {error}\n"),
        }
        let Ok(contents) = Csv.read(&bytes, Strictness::Tolerant) else {
            continue;
        };
        let names = names(&contents);
        let series = &contents.series[contents.series.len() - 1];
        let abscissa = match &series.abscissa {
            Abscissa::Even { start, step } => format!("{start} + i * {step:.6e}"),
            Abscissa::Uneven(values) => {
                format!("uneven, {} to {}", values[0], values[values.len() - 1])
            }
        };
        said += &format!(
            "  {} series of {}, over {} [{}]: {abscissa}; {:?} {} .. {}\n",
            names.len(),
            series.ordinate.len(),
            series.abscissa_axis.label,
            series.abscissa_axis.unit_text,
            series.kind,
            names[0],
            names[names.len() - 1],
        );
    }
    insta::assert_snapshot!(said, @r"
    shpb/impact_compression_epoxy_resin_sample_01_raw_voltage.csv, recognised
      strictly: csv, line 2, column 1: abscissa is repeated values; their digits give the step 7.990399519976e-8 to within 2.8e-10, expected a step known to within a relative 0.0001, or a stated step
      2 series of 20000, over Time [s]: -0.000198 + i * 7.990400e-8; TimeResponse incident_bar_signal/voltage [] .. transmission_bar_signal/voltage []
    shpb/impact_compression_epoxy_resin_experiment_details_en-US.txt, not recognised
      strictly: csv, line 1: table is not found, expected rows of numbers within the first 1000 lines
    shpb/epoxy/raw_strain.csv, recognised
      strictly: csv, line 2, column 1: abscissa is repeated values; their digits give the step 7.990399519976e-8 to within 2.8e-10, expected a step known to within a relative 0.0001, or a stated step
      2 series of 20000, over Time [s]: -0.000198 + i * 7.990400e-8; TimeResponse incident_bar_signal/¦Å [] .. transmission_bar_signal/¦Å []
    shpb/pmma-13/180303_171828_Ch1.csv, recognised
      strictly: reads
      1 series of 50000, over  [s]: -0.00008 + i * 8.000000e-9; TimeResponse  [] ..  []
    shpb/copper/gauge_strain_records.csv, recognised
      strictly: reads
      11 series of 801, over time [s]: uneven, 0 to 0.0020000000949949026; TimeResponse gauge1_incident_bar_strain [] .. specimen_mean_compressive_le33 []
    dma/pyvisco_freq_user_raw.csv, recognised
      strictly: reads
      4 series of 210, over f [Hz]: uneven, 0.1 to 100; General E_stor [MPa] .. Set [-]
    dma/glassy-polymer/T25.txt, recognised
      strictly: csv, line 63: row is `]6[JAL03-01_Freq0.1-100_`, expected a row of 20 numbers
      19 series of 60, over t [s]: uneven, 0 to 637.419; TimeResponse Index [#] .. Eta* [MPas]
    tapered-rod/axial_wavenumber_est_30.txt, recognised
      strictly: reads
      20 series of 3201, over frequency []: uneven, 0 to 5000; General at 0.15 m (1) [] .. at 1.35 m (4) []
    tapered-rod/beam_input_FRF.txt, recognised
      strictly: reads
      2 series of 6401, over frequency [Hz]: 0 + i * 7.812500e-1; General real(accelerance) [] .. imag(accelerance) []
    tapered-rod/beam_transfer_FRF.txt, recognised
      strictly: reads
      2 series of 6401, over frequency [Hz]: 0 + i * 7.812500e-1; General real(accelerance) [] .. imag(accelerance) []
    tapered-rod/rod_input_FRF_acc.txt, recognised
      strictly: reads
      2 series of 6401, over frequency [Hz]: uneven, 0 to 5000; General real(accelerance) [] .. imag(accelerance) []
    tapered-rod/rod_transfer_FRF_acc.txt, recognised
      strictly: reads
      2 series of 6401, over frequency [Hz]: uneven, 0 to 5000; General real(accelerance) [] .. imag(accelerance) []
    ");
}
