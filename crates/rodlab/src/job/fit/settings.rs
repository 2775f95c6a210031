//! Settings of a sheet, stated or taken by default.

use super::columns::{ModulusColumns, TemperatureSheet};
use super::errors::ErrorsSheet;
use super::{FitSheet, VerticalSheet};
use crate::chosen::Chosen;
use crate::records::Selector;

pub(super) fn of(sheet: &FitSheet) -> Chosen {
    let mut chosen = Chosen::default();
    chosen.about(&sheet.about);
    for (index, table) in sheet.tables.iter().enumerate() {
        let name = |field: &str| format!("tables[{index}].{field}");
        chosen.stated(name("files"), table.files.join(", "));
        if let Some(column) = &table.frequency {
            chosen.stated(name("frequency"), column_in_words(column));
        }
        if let Some(column) = &table.angular_frequency {
            chosen.stated(name("angular_frequency"), column_in_words(column));
        }
        chosen.stated(name("modulus"), columns_in_words(&table.modulus));
        let units = &table.units;
        for (field, unit) in [
            ("units.frequency", &units.frequency),
            ("units.modulus", &units.modulus),
            ("units.phase", &units.phase),
            ("units.temperature", &units.temperature),
        ] {
            if let Some(unit) = unit {
                chosen.stated(name(field), unit);
            }
        }
        let temperature = match &table.temperature {
            TemperatureSheet::Column(column) => column_in_words(column),
            TemperatureSheet::Stated(temperature) => temperature.to_string(),
        };
        chosen.stated(name("temperature"), temperature);
        chosen.either(
            name("errors"),
            table.errors.as_ref().map(errors_in_words).as_ref(),
            "not stated: by the scatter about the fit, equal at all rows as a part of |E|",
        );
    }
    let kind = sheet.kind.map(super::LoadingSheet::modulus);
    chosen.either(
        "kind",
        kind.as_ref(),
        super::LoadingSheet::Tension.modulus(),
    );
    chosen.either(
        "steps",
        sheet
            .steps
            .as_ref()
            .map(super::StepsSheet::in_words)
            .as_ref(),
        "temperatures that follow each other within 1 K",
    );
    if let Some(reference) = &sheet.reference_temperature {
        chosen.stated("reference_temperature", reference);
    }
    let shifts = sheet.stated_shifts.as_ref();
    chosen.either(
        "stated_shifts",
        shifts.map(super::StatedShiftsSheet::in_words).as_ref(),
        "none: temperatures are connected by their overlap alone",
    );
    let vertical = |vertical: VerticalSheet| match vertical {
        VerticalSheet::AsNeeded => "estimated where the curves contradict 1".to_owned(),
        VerticalSheet::Unity => "1".to_owned(),
        VerticalSheet::RubberElasticity {
            volume_expansion_per_kelvin: expansion,
        } => format!("rubber elasticity, with an expansion of the volume of {expansion} per K"),
    };
    chosen.either(
        "vertical_shifts",
        sheet.vertical_shifts.map(vertical).as_ref(),
        vertical(VerticalSheet::AsNeeded),
    );
    match &sheet.band {
        Some(band) => chosen.stated("band", format!("{} to {}", band.from, band.to)),
        None => chosen.by_default("band", "all frequencies"),
    }
    chosen.either(
        "scale_uncertainty",
        sheet.scale_uncertainty.as_ref(),
        "not stated",
    );
    if let Some(density) = &sheet.density {
        chosen.stated("density", density);
    }
    if let Some(laws) = &sheet.laws {
        laws.list(&mut chosen);
    }
    chosen
}

fn column_in_words(column: &Selector) -> String {
    match column {
        Selector::Number(number) => format!("column {number}"),
        Selector::Name(name) => format!("column `{name}`"),
    }
}

fn columns_in_words(columns: &ModulusColumns) -> String {
    let (first, second, names) = match columns {
        ModulusColumns::Parts { storage, loss } => (storage, loss, ("storage", "loss")),
        ModulusColumns::StorageAndLossFactor {
            storage,
            loss_factor,
        } => (storage, loss_factor, ("storage", "loss factor")),
        ModulusColumns::MagnitudeAndPhase { magnitude, phase } => {
            (magnitude, phase, ("magnitude", "phase"))
        }
    };
    format!(
        "{} in {}, {} in {}",
        names.0,
        column_in_words(first),
        names.1,
        column_in_words(second)
    )
}

fn errors_in_words(errors: &ErrorsSheet) -> String {
    match errors {
        ErrorsSheet::Columns(columns) => columns_in_words(columns),
        ErrorsSheet::Parts { storage, loss } => {
            format!("{storage} of the storage and {loss} of the loss modulus")
        }
        ErrorsSheet::StorageAndLossFactor {
            storage,
            loss_factor,
        } => format!("{storage} of the storage modulus, {loss_factor} of the loss factor"),
        ErrorsSheet::MagnitudeAndPhase { magnitude, phase } => {
            format!("{magnitude} of the magnitude, {phase} of the phase")
        }
    }
}
