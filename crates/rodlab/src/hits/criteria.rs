//! Criteria for hits, as stated in a sheet.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use labio::Channel;
use labio::hits::Criteria;
use serde::de::{self, IntoDeserializer, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use super::Reading;
use crate::outcome::Setting;
use crate::records::channel_called;
use crate::{InStep, RodlabError};

/// Limits of the checks of a hit. A limit that is not stated has its default; `None` disables its
/// check.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CriteriaSheet {
    /// Kind of hit: `Hammer`, `Bar`, `RingingBar` or `BarPulses`; by default the kind for the
    /// method of the job.
    pub kind: Option<HitKind>,
    /// Channel that is searched for double hits; by default the channel that marks the beginning of
    /// a hit, if it is a force.
    pub force_channel: Option<String>,
    /// Ranges of the recorder, such as `{"hammer": "10 V"}`, in a unit of the recorded signal; from
    /// 99 % of the range on, a sample counts as an overload.
    pub full_scales: BTreeMap<String, Reading>,
    /// Smallest ratio of the peak to the standard deviation of the noise; by default 10.
    pub peak_over_noise: Limit<f64>,
    /// Smallest ratio of the second contact to the first that counts as a double hit; by default
    /// 0.05, not checked in bars.
    pub double_hit: Limit<f64>,
    /// Number of equal extreme samples that counts as clipping; by default 3.
    pub clipped_run: Limit<usize>,
    /// Number of equal samples in the middle of a movement that counts as a drop-out; by default
    /// 8.
    pub drop_out_run: Limit<usize>,
    /// Largest ratio of the rest level to the peak; by default 0.25.
    pub static_offset: Limit<f64>,
    /// Largest difference between the rest levels before and after the hit, relative to the peak;
    /// by default 0.02, not checked for pulses of bars.
    pub level_shift: Limit<f64>,
    /// Largest remaining signal at the end, relative to the peak; by default 0.01, not checked for
    /// pulses of bars.
    pub remainder: Limit<f64>,
}

/// The kind of hit in a record, which sets the defaults of the limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum HitKind {
    /// One short contact, followed by a motion that decays to rest.
    Hammer,
    /// Waves that pass the sensors of a bar several times, in a record that is transformed as a
    /// whole.
    Bar,
    /// Waves like those of `Bar`, in a record that may end while the bar rings.
    RingingBar,
    /// Waves in a bar from which pulses are cut out; the bar may still ring at the end.
    BarPulses,
}

impl HitKind {
    fn criteria(self) -> Criteria {
        match self {
            Self::Hammer => Criteria::hammer(),
            Self::Bar => Criteria::bar(),
            Self::RingingBar | Self::BarPulses => Criteria::bar_pulses(),
        }
    }

    fn in_words(self) -> &'static str {
        match self {
            Self::Hammer => "one short contact",
            Self::Bar => "waves in a bar",
            Self::RingingBar => "waves in a bar that may ring at the end of the record",
            Self::BarPulses => "pulses cut out of waves in a bar",
        }
    }
}

/// A limit of a check.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Limit<T> {
    /// Not stated in the sheet.
    #[default]
    ByDefault,
    /// Check disabled: `None`.
    Off,
    /// Stated in the sheet.
    At(T),
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Limit<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Written<T>(PhantomData<T>);

        impl<'de, T: Deserialize<'de>> Visitor<'de> for Written<T> {
            type Value = Limit<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or none to disable the check")
            }

            fn visit_none<E: de::Error>(self) -> Result<Limit<T>, E> {
                Ok(Limit::Off)
            }

            fn visit_unit<E: de::Error>(self) -> Result<Limit<T>, E> {
                Ok(Limit::Off)
            }

            // TOML has no null value and uses the word "none"
            fn visit_str<E: de::Error>(self, word: &str) -> Result<Limit<T>, E> {
                if word == "none" {
                    Ok(Limit::Off)
                } else {
                    Err(E::invalid_value(Unexpected::Str(word), &self))
                }
            }

            fn visit_some<D: Deserializer<'de>>(self, limit: D) -> Result<Limit<T>, D::Error> {
                limit.deserialize_any(self)
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Limit<T>, E> {
                T::deserialize(number.into_deserializer()).map(Limit::At)
            }

            fn visit_u64<E: de::Error>(self, number: u64) -> Result<Limit<T>, E> {
                T::deserialize(number.into_deserializer()).map(Limit::At)
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<Limit<T>, E> {
                T::deserialize(number.into_deserializer()).map(Limit::At)
            }
        }

        deserializer.deserialize_option(Written(PhantomData))
    }
}

impl<T: Copy> Limit<T> {
    /// Returns `criteria` after `put` has entered this limit.
    fn put<E>(
        self,
        criteria: Criteria,
        put: impl FnOnce(Criteria, Option<T>) -> Result<Criteria, E>,
    ) -> Result<Criteria, E> {
        match self {
            Self::ByDefault => Ok(criteria),
            Self::Off => put(criteria, None),
            Self::At(limit) => put(criteria, Some(limit)),
        }
    }
}

impl CriteriaSheet {
    /// Returns the criteria for records of `channels`, with the defaults of the kind `usual` if the
    /// sheet states no kind.
    pub(super) fn limits(
        &self,
        usual: HitKind,
        channels: &[Channel],
        field: &str,
    ) -> Result<Criteria, RodlabError> {
        let usual = self.kind.unwrap_or(usual).criteria();
        let limited = self
            .peak_over_noise
            .put(usual, Criteria::with_peak_over_noise);
        let mut criteria = limited
            .and_then(|limited| self.double_hit.put(limited, Criteria::with_double_hit))
            .and_then(|limited| self.clipped_run.put(limited, Criteria::with_clipped_run))
            .and_then(|limited| self.drop_out_run.put(limited, Criteria::with_drop_out_run))
            .and_then(|limited| {
                self.static_offset
                    .put(limited, Criteria::with_static_offset)
            })
            .and_then(|limited| self.level_shift.put(limited, Criteria::with_level_shift))
            .and_then(|limited| self.remainder.put(limited, Criteria::with_remainder))
            .in_step(field)?;
        if let Some(name) = &self.force_channel {
            channel_called(channels, name, &format!("{field}.force_channel"))?;
            criteria = criteria.with_force_channel(name);
        }
        for (name, full_scale) in &self.full_scales {
            let place = format!("{field}.full_scales.{name}");
            let full_scale = full_scale.of(channel_called(channels, name, &place)?, &place)?;
            criteria = criteria.with_full_scale(name, full_scale).in_step(place)?;
        }
        Ok(criteria)
    }

    /// Returns settings for the kind of hit and the limits that the sheet does not state. The
    /// limits are taken from `criteria`, which were made from the sheet.
    pub(super) fn defaults(
        criteria: &Criteria,
        usual: HitKind,
        field: &str,
    ) -> Result<Vec<Setting>, RodlabError> {
        // only `Criteria` contains the default limits
        let limits =
            serde_json::to_value(criteria).in_step(format!("{field}, listing the limits"))?;
        let of_limit = |name: &str| {
            let value = match limits.get(name) {
                None | Some(serde_json::Value::Null) => "not checked".to_owned(),
                Some(limit) => limit.to_string(),
            };
            Setting::by_default(format!("{field}.{name}"), value)
        };
        let names = [
            "peak_over_noise",
            "double_hit",
            "clipped_run",
            "drop_out_run",
            "static_offset",
            "level_shift",
            "remainder",
        ];
        let kind = Setting::by_default(format!("{field}.kind"), usual.in_words());
        Ok(std::iter::once(kind).chain(names.map(of_limit)).collect())
    }
}
