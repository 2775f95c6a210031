//! The list of all settings, stated in the sheet or taken by default.

use std::fmt::Display;

use crate::about::About;
use crate::outcome::Setting;

/// Collects the [`Setting`]s of a job.
#[derive(Debug, Default)]
pub(crate) struct Chosen(Vec<Setting>);

impl Chosen {
    /// Adds a setting stated in the sheet.
    pub(crate) fn stated(&mut self, name: impl Into<String>, value: impl Display) {
        self.push(name.into(), value.to_string(), false);
    }

    /// Adds a default setting.
    pub(crate) fn by_default(&mut self, name: impl Into<String>, value: impl Display) {
        self.push(name.into(), value.to_string(), true);
    }

    /// Adds a setting stated in the sheet, or else its default.
    pub(crate) fn either<T: Display>(
        &mut self,
        name: impl Into<String>,
        stated: Option<&T>,
        default: impl Display,
    ) {
        match stated {
            Some(value) => self.stated(name, value),
            None => self.by_default(name, default),
        }
    }

    /// Free texts about a test.
    pub(crate) fn about(&mut self, about: &About) {
        self.extend(about.settings());
    }

    /// Adds settings listed elsewhere.
    pub(crate) fn extend(&mut self, settings: impl IntoIterator<Item = Setting>) {
        self.0.extend(settings);
    }

    pub(crate) fn into_settings(self) -> Vec<Setting> {
        self.0
    }

    fn push(&mut self, name: String, value: String, by_default: bool) {
        self.0.push(Setting {
            name,
            value,
            by_default,
        });
    }
}
