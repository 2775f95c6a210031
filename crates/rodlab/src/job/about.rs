//! Free texts of a sheet that go into the report as they are.

use serde::Deserialize;

use crate::Outcome;
use crate::outcome::Setting;

/// Who, where, when; every field may be left out.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct About {
    /// The laboratory.
    pub laboratory: Option<String>,
    /// Who made the test.
    pub operator: Option<String>,
    /// When it was made.
    pub date: Option<String>,
    /// The specimen, as it is called in the laboratory.
    pub specimen: Option<String>,
    /// Anything else.
    pub note: Option<String>,
}

impl About {
    /// Puts what is stated into the settings of `outcome`.
    pub(crate) fn tell(&self, outcome: &mut Outcome) {
        outcome.settings.append(&mut self.settings());
    }

    /// What is stated.
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
