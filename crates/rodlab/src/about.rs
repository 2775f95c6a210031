//! Free texts of a sheet, copied to the report.

use serde::Deserialize;

use crate::Outcome;
use crate::outcome::Setting;

/// Persons, place and date of a test; all fields are optional.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct About {
    /// The laboratory.
    pub laboratory: Option<String>,
    /// The operator of the test.
    pub operator: Option<String>,
    /// The date of the test.
    pub date: Option<String>,
    /// The specimen, by its name in the laboratory.
    pub specimen: Option<String>,
    /// Other remarks.
    pub note: Option<String>,
}

impl About {
    /// Adds the stated texts to the settings of `outcome`.
    pub(crate) fn tell(&self, outcome: &mut Outcome) {
        outcome.settings.append(&mut self.settings());
    }

    /// The stated texts.
    pub(crate) fn settings(&self) -> Vec<Setting> {
        let texts = [
            ("about.laboratory", &self.laboratory),
            ("about.operator", &self.operator),
            ("about.date", &self.date),
            ("about.specimen", &self.specimen),
            ("about.note", &self.note),
        ];
        texts
            .into_iter()
            .filter_map(|(name, text)| {
                Some(Setting {
                    name: name.to_owned(),
                    value: text.clone()?,
                    by_default: false,
                })
            })
            .collect()
    }
}
