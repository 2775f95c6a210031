//! Settings of a sheet, stated or taken by default.

use cmod::validity::AcceptanceLimits;

use super::method::{MethodSheet, SectionSheet, SolverSheet};
use super::{LimitsSheet, ModulusSheet, TheorySheet};
use crate::chosen::Chosen;
use crate::digits::significant;

pub(super) fn of(sheet: &ModulusSheet) -> Chosen {
    let mut chosen = Chosen::default();
    chosen.about(&sheet.about);
    let specimen = &sheet.specimen;
    if let Some(length) = &specimen.length {
        chosen.stated("specimen.length", length);
    }
    chosen.stated("specimen.diameter", &specimen.diameter);
    chosen.stated("specimen.density", &specimen.density);
    chosen.either(
        "specimen.accelerometer_mass",
        specimen.accelerometer_mass.as_ref(),
        "0 kg",
    );
    method(&sheet.method, &mut chosen);
    match &sheet.band {
        Some(band) => chosen.stated("band", format!("{} to {}", band.from, band.to)),
        None => chosen.by_default("band", "all lines above 0 Hz"),
    }
    limits(&sheet.limits, &mut chosen);
    match &sheet.lateral_inertia {
        None => chosen.by_default(
            "lateral_inertia",
            "not taken out: an error by Poisson's ratio up to 0.5",
        ),
        Some(inertia) => {
            chosen.stated("lateral_inertia.poisson_ratio", &inertia.poisson_ratio);
            match inertia.theory {
                None => chosen.by_default(
                    "lateral_inertia.theory",
                    "Pochhammer and Chree at all wavelengths",
                ),
                Some(TheorySheet::LoveRayleigh) => {
                    chosen.stated("lateral_inertia.theory", "Love and Rayleigh");
                }
                Some(TheorySheet::PochhammerChree) => {
                    chosen.stated("lateral_inertia.theory", "Pochhammer and Chree");
                }
            }
        }
    }
    sheet.checks.list(&mut chosen);
    if let Some(laws) = &sheet.laws {
        laws.list(&mut chosen);
    }
    match &sheet.report_at {
        None => chosen.by_default("report_at", "1, 2 and 5 of each decade with valid lines"),
        Some(frequencies) => {
            let texts: Vec<String> = frequencies.iter().map(ToString::to_string).collect();
            chosen.stated("report_at", texts.join(", "));
        }
    }
    chosen
}

fn method(method: &MethodSheet, chosen: &mut Chosen) {
    chosen.stated("method", method.name());
    let mut section = |name: &str, section: &SectionSheet| {
        let SectionSheet {
            channel,
            from_free_end,
            ..
        } = section;
        let words = format!("{channel}, {from_free_end} from the free end");
        chosen.stated(format!("method.{name}"), words);
    };
    match method {
        MethodSheet::TwoPoint {
            impacted_end,
            free_end,
            solver,
        } => {
            chosen.stated("method.impacted_end", impacted_end);
            chosen.stated("method.free_end", free_end);
            let name = |solver: SolverSheet| match solver {
                SolverSheet::Continuation => "continuation in the mass ratio",
                SolverSheet::Newton => "Newton's iteration, as printed",
                SolverSheet::Series => "series in the mass ratio",
            };
            chosen.either(
                "method.solver",
                solver.map(name).as_ref(),
                name(SolverSheet::Continuation),
            );
        }
        MethodSheet::Resonances {
            impacted_end,
            free_end,
        } => {
            chosen.stated("method.impacted_end", impacted_end);
            chosen.stated("method.free_end", free_end);
        }
        MethodSheet::FreeVibration {
            channel,
            from,
            wave_speed,
        } => {
            chosen.stated("method.channel", channel);
            chosen.stated("method.from", from);
            chosen.stated("method.wave_speed", wave_speed);
        }
        MethodSheet::FreeEnd {
            first,
            second,
            wave_speed,
        } => {
            section("first", first);
            section("second", second);
            chosen.either("method.wave_speed", wave_speed.as_ref(), "searched");
        }
        MethodSheet::SeparatePulses {
            first,
            second,
            distance,
            wave_speed,
        } => {
            for (name, window) in [("first", first), ("second", second)] {
                let words = format!("{}, {} to {}", window.channel, window.from, window.to);
                chosen.stated(format!("method.{name}"), words);
            }
            chosen.stated("method.distance", distance);
            chosen.either("method.wave_speed", wave_speed.as_ref(), "searched");
        }
        MethodSheet::OneGauge {
            section: at,
            incident,
            reflected,
            wave_speed,
        } => {
            section("section", at);
            for (name, (from, to)) in [("incident", incident), ("reflected", reflected)] {
                chosen.stated(format!("method.{name}"), format!("{from} to {to}"));
            }
            chosen.either("method.wave_speed", wave_speed.as_ref(), "searched");
        }
        MethodSheet::ThreePoint { gauges } => {
            for gauge in gauges {
                chosen.stated(format!("method.gauges: {}", gauge.channel), &gauge.at);
            }
        }
        MethodSheet::MultiPoint {
            gauges,
            wave_speed,
            free_end_at,
        } => {
            for gauge in gauges {
                chosen.stated(format!("method.gauges: {}", gauge.channel), &gauge.at);
            }
            chosen.either("method.wave_speed", wave_speed.as_ref(), "searched");
            if let Some(free_end) = free_end_at {
                chosen.stated("method.free_end_at", free_end);
            }
        }
    }
}

fn limits(limits: &LimitsSheet, chosen: &mut Chosen) {
    let default = AcceptanceLimits::default();
    let percent =
        |value: f64| format!("{} %", significant(100.0 * value, 2).trim_end_matches(".0"));
    for (name, stated, default) in [
        (
            "storage_modulus",
            &limits.storage_modulus,
            percent(default.storage_modulus),
        ),
        (
            "loss_factor",
            &limits.loss_factor,
            percent(default.loss_factor),
        ),
        (
            "common_storage_modulus",
            &limits.common_storage_modulus,
            "not asked".to_owned(),
        ),
        (
            "error_amplification",
            &limits.error_amplification,
            default.error_amplification.to_string(),
        ),
        ("coherence", &limits.coherence, "not asked".to_owned()),
    ] {
        chosen.either(format!("limits.{name}"), stated.as_ref(), default);
    }
}
