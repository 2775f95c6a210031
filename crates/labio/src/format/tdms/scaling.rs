//! Scales, which convert recorded numbers to the measured quantity.
//!
//! The properties `NI_Number_Of_Scales` and `NI_Scale[i]_..` belong to a channel, its group or the
//! file. The last scale gives the result; the input of each scale is the raw numbers or another
//! scale.

use super::malformed;
use super::numbers::Numbers;
use super::objects::Object;
use super::sensors::{Sensor, layout};
use super::thermocouples::Thermocouple;
use crate::{BridgeLayout, LabioError, Place};

/// Largest number of scales in a sequence, which bounds the work that a file can cause.
const MOST_SCALES: usize = 256;
/// Input index that stands for the raw numbers.
const RAW: u32 = u32::MAX;

/// Source of the input of a step.
#[derive(Debug, Clone, Copy)]
enum Input {
    Raw,
    /// A DAQmx scaler, by its position.
    Scaler(usize),
    /// An earlier step.
    Step(usize),
}

/// A scale: a rule with its first input and, for rules of two inputs, its second.
#[derive(Debug)]
struct Step {
    rule: Rule,
    first: Input,
    second: Input,
}

#[derive(Debug)]
enum Rule {
    Linear {
        slope: f64,
        intercept: f64,
    },
    /// Coefficients from the constant on.
    Polynomial(Vec<f64>),
    /// Points in the order of ascending abscissa.
    Table(Vec<(f64, f64)>),
    Sensor(Sensor),
    Add,
    /// The second input minus the first, as the software of the format's vendor does.
    Subtract,
}

/// The properties that define the scales of a channel.
struct Scales<'a> {
    owner: &'a Object,
    place: Place,
    path: String,
}

impl Scales<'_> {
    fn refused(&self, name: &str, found: impl Into<String>, expected: &str) -> LabioError {
        let place = self
            .owner
            .property(name)
            .map_or(self.place, |property| property.place);
        malformed(
            place,
            format!("property `{name}` for {}", self.path),
            found,
            expected,
        )
    }

    /// Returns the error for the value of a property, or for its absence.
    fn wrong(&self, name: &str, expected: &str) -> LabioError {
        let property = self.owner.property(name);
        let found =
            property.map_or_else(|| "missing".to_owned(), |property| property.value.to_text());
        self.refused(name, found, expected)
    }

    fn real(&self, name: &str) -> Result<f64, LabioError> {
        let property = self.owner.property(name);
        property
            .and_then(|property| property.value.as_real())
            .ok_or_else(|| self.wrong(name, "a number"))
    }

    /// Reads the index of an input; without the property, the input is the raw numbers.
    fn source(&self, scale: u32, name: &str) -> Result<u32, LabioError> {
        let name = &format!("NI_Scale[{scale}]_{name}");
        match self.owner.property(name) {
            None => Ok(RAW),
            Some(property) => property
                .value
                .as_index()
                .filter(|&source| source == RAW || source < scale)
                .ok_or_else(|| {
                    self.wrong(name, "an earlier scale, or 0xffffffff for the raw numbers")
                }),
        }
    }

    /// Reads the numbers `name[0]`, `name[1]`, ...: as many as `name_Size` states or, without it,
    /// as many as exist.
    fn list(&self, scale: u32, name: &str) -> Result<Vec<f64>, LabioError> {
        let size = format!("NI_Scale[{scale}]_{name}_Size");
        let element = |index: u32| format!("NI_Scale[{scale}]_{name}[{index}]");
        let mut numbers = Vec::new();
        match self.owner.property(&size) {
            Some(property) => {
                let n = property
                    .value
                    .as_index()
                    .ok_or_else(|| self.wrong(&size, "a count"))?;
                for index in 0..n {
                    numbers.push(self.real(&element(index))?);
                }
            }
            None => {
                for index in 0.. {
                    if self.owner.property(&element(index)).is_none() {
                        break;
                    }
                    numbers.push(self.real(&element(index))?);
                }
            }
        }
        Ok(numbers)
    }

    /// Kind of a scale; `None` if no scale has that index, as with the indices of DAQmx scalers.
    fn kind(&self, scale: u32) -> Option<&str> {
        let property = self
            .owner
            .property(&format!("NI_Scale[{scale}]_Scale_Type"))?;
        Some(property.value.as_text().unwrap_or("no text"))
    }

    fn sources(&self, scale: u32) -> Result<Vec<u32>, LabioError> {
        let names: &[&str] = match self.kind(scale) {
            Some("Linear") => &["Linear_Input_Source"],
            Some("Polynomial") => &["Polynomial_Input_Source"],
            Some("Table") => &["Table_Input_Source"],
            Some("Strain") => &["Strain_Input_Source"],
            Some("RTD") => &["RTD_Input_Source"],
            Some("Thermocouple") => &["Thermocouple_Input_Source"],
            Some("Add") => &[
                "Add_Left_Operand_Input_Source",
                "Add_Right_Operand_Input_Source",
            ],
            Some("Subtract") => &[
                "Subtract_Left_Operand_Input_Source",
                "Subtract_Right_Operand_Input_Source",
            ],
            Some(other) => {
                let expected = "Linear, Polynomial, Table, Add, Subtract, Strain, RTD or Thermocouple, the scales that are known";
                return Err(self.refused(
                    &format!("NI_Scale[{scale}]_Scale_Type"),
                    other,
                    expected,
                ));
            }
            None => &[],
        };
        names.iter().map(|name| self.source(scale, name)).collect()
    }

    fn step(&self, scale: u32, inputs: &[Input]) -> Result<Step, LabioError> {
        let rule = match self.kind(scale) {
            Some("Linear") => Rule::Linear {
                slope: self.real(&format!("NI_Scale[{scale}]_Linear_Slope"))?,
                intercept: self.real(&format!("NI_Scale[{scale}]_Linear_Y_Intercept"))?,
            },
            Some("Polynomial") => Rule::Polynomial(self.list(scale, "Polynomial_Coefficients")?),
            Some("Add") => Rule::Add,
            Some("Subtract") => Rule::Subtract,
            Some("Strain") => Rule::Sensor(self.bridge(scale)?),
            Some("RTD") => Rule::Sensor(self.resistance(scale)?),
            Some("Thermocouple") => Rule::Sensor(self.thermocouple(scale)?),
            _ => Rule::Table(self.points(scale)?),
        };
        Ok(Step {
            rule,
            first: inputs.first().copied().unwrap_or(Input::Raw),
            second: inputs.get(1).copied().unwrap_or(Input::Raw),
        })
    }

    /// Reads a number above 0.
    fn positive(&self, name: &str) -> Result<f64, LabioError> {
        let value = self.real(name)?;
        if value > 0.0 && value.is_finite() {
            Ok(value)
        } else {
            Err(self.refused(name, value.to_string(), "a number above 0"))
        }
    }

    /// Reads a number that selects one of several options.
    fn choice<T>(
        &self,
        name: &str,
        of: impl Fn(u32) -> Option<T>,
        expected: &str,
    ) -> Result<T, LabioError> {
        let property = self.owner.property(name);
        let number = property.and_then(|property| property.value.as_index());
        number
            .and_then(of)
            .ok_or_else(|| self.wrong(name, expected))
    }

    fn bridge(&self, scale: u32) -> Result<Sensor, LabioError> {
        let name = |name: &str| format!("NI_Scale[{scale}]_Strain_{name}");
        let poisson_ratio = self.real(&name("Poisson_Ratio"))?;
        let layout = self.choice(
            &name("Configuration"),
            |number| layout(number, poisson_ratio),
            "the number of a full, half or quarter bridge",
        )?;
        let leads = self.real(&name("Lead_Wire_Resistance"))?;
        let gauge = self.positive(&name("Gage_Resistance"))?;
        let has_leads = matches!(
            layout,
            BridgeLayout::Quarter | BridgeLayout::HalfBending | BridgeLayout::HalfPoisson { .. }
        );
        let of_leads = if has_leads { 1.0 + leads / gauge } else { 1.0 };
        Ok(Sensor::Bridge {
            layout,
            gauge_factor: self.positive(&name("Gage_Factor"))?,
            excitation: self.positive(&name("Voltage_Excitation"))?,
            at_rest: self.real(&name("Initial_Bridge_Voltage"))?,
            factor: of_leads * self.real(&name("Bridge_Shunt_Calibration_Gain_Adjustment"))?,
        })
    }

    fn resistance(&self, scale: u32) -> Result<Sensor, LabioError> {
        let name = |name: &str| format!("NI_Scale[{scale}]_RTD_{name}");
        // number of leads within the measured voltage: two of 2 wires, one of 3 wires (the third
        // compensates the other lead), none of 4 wires
        let n_leads = self.choice(
            &name("Resistance_Configuration"),
            |wires| match wires {
                2 => Some(2.0),
                3 => Some(1.0),
                4 => Some(0.0),
                _ => None,
            },
            "2, 3 or 4 wires",
        )?;
        Ok(Sensor::Resistance {
            current: self.positive(&name("Current_Excitation"))?,
            at_zero: self.positive(&name("R0_Nominal_Resistance"))?,
            coefficients: [
                self.positive(&name("A"))?,
                self.real(&name("B"))?,
                self.real(&name("C"))?,
            ],
            leads: n_leads * self.real(&name("Lead_Wire_Resistance"))?,
        })
    }

    fn thermocouple(&self, scale: u32) -> Result<Sensor, LabioError> {
        let name = |name: &str| format!("NI_Scale[{scale}]_Thermocouple_{name}");
        let kind = self.choice(
            &name("Thermocouple_Type"),
            Thermocouple::of_code,
            "the number of type B, E, J, K, N, R, S or T",
        )?;
        let direction = name("Scaling_Direction");
        if self.owner.property(&direction).is_none() {
            return Ok(Sensor::Thermocouple(kind));
        }
        let is_cold = |direction: u32| match direction {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        };
        let expected = "0 for a temperature or 1 for a voltage";
        Ok(if self.choice(&direction, is_cold, expected)? {
            Sensor::ColdJunction(kind)
        } else {
            Sensor::Thermocouple(kind)
        })
    }

    /// Returns the points of a table: the values called scaled are the inputs, and those called
    /// pre-scaled the outputs. The names suggest the opposite, but the vendor's software works in
    /// this way.
    fn points(&self, scale: u32) -> Result<Vec<(f64, f64)>, LabioError> {
        let from = self.list(scale, "Table_Scaled_Values")?;
        let to = self.list(scale, "Table_Pre_Scaled_Values")?;
        let name = format!("NI_Scale[{scale}]_Table_Scaled_Values_Size");
        if from.len() != to.len() || from.is_empty() {
            let found = format!("{} and {} values", from.len(), to.len());
            return Err(self.refused(
                &name,
                found,
                "as many scaled as pre-scaled values, at least one",
            ));
        }
        let mut points: Vec<(f64, f64)> = from.into_iter().zip(to).collect();
        if points.first() > points.last() {
            points.reverse();
        }
        if points
            .windows(2)
            .all(|pair| matches!(pair, [a, b] if a.0 < b.0))
        {
            Ok(points)
        } else {
            Err(self.refused(
                &name,
                "values that are not strictly monotonic",
                "strictly rising or falling values",
            ))
        }
    }
}

/// Returns the scaled numbers of a channel. Scales are looked up in the object itself, its group
/// and the file, in this order. Without scales, or if the status is `scaled`, the numbers are
/// returned unchanged.
///
/// # Errors
///
/// [`LabioError::Malformed`] for an unknown scale, with its name, for an incomplete one, and for
/// DAQmx data whose scalers do not lead to one result.
pub(super) fn scaled(owners: &[&Object], numbers: &Numbers) -> Result<Vec<f64>, LabioError> {
    let Some(&channel) = owners.first() else {
        return Ok(Vec::new());
    };
    let mut with_scales = owners.iter().filter_map(|&owner| {
        let property = owner.property("NI_Number_Of_Scales")?;
        let done = owner
            .property("NI_Scaling_Status")
            .is_some_and(|status| status.value.as_text() == Some("scaled"));
        Some((owner, property, done))
            .filter(|(_, property, _)| property.value.as_index() != Some(0))
    });
    let path = channel.path.join("/");
    let (scales, n_scales) = match with_scales.next() {
        Some((owner, property, false)) => {
            let scales = Scales {
                owner,
                place: property.place,
                path,
            };
            let n = property
                .value
                .as_index()
                .ok_or_else(|| scales.wrong("NI_Number_Of_Scales", "a number of scales"))?;
            (scales, n)
        }
        _ => return unscaled(channel, numbers),
    };
    let (result, steps) = steps(&scales, n_scales - 1, numbers)?;
    let lengths = numbers.scalers.iter().map(|(_, values)| values.len());
    let n = lengths.clone().min().unwrap_or(numbers.values.len());
    if lengths.clone().any(|length| length != n) {
        let found = format!("{:?} values", lengths.collect::<Vec<_>>());
        return Err(malformed(
            channel.index_place,
            "DAQmx scalers",
            found,
            "as many values for each",
        ));
    }
    // results of the steps for one sample, in the order of the steps
    let mut outcomes = Vec::with_capacity(steps.len());
    let mut output = Vec::with_capacity(n);
    for sample in 0..n {
        let at = |input: Input, outcomes: &[f64]| {
            let raw = |slot: usize| {
                numbers
                    .scalers
                    .get(slot)
                    .and_then(|(_, values)| values.get(sample))
            };
            let value = match input {
                Input::Raw => numbers.values.get(sample).or_else(|| raw(0)).copied(),
                Input::Scaler(slot) => raw(slot).copied(),
                Input::Step(slot) => outcomes.get(slot).copied(),
            };
            value.ok_or_else(|| {
                malformed(
                    channel.index_place,
                    "input of a scale",
                    format!("{input:?} without a number for sample {sample}"),
                    "numbers of the channel or the result of an earlier scale",
                )
            })
        };
        outcomes.clear();
        for step in &steps {
            let x = at(step.first, &outcomes)?;
            let value = match &step.rule {
                Rule::Linear { slope, intercept } => x * slope + intercept,
                Rule::Polynomial(coefficients) => coefficients
                    .iter()
                    .rev()
                    .fold(0.0, |sum, coefficient| sum * x + coefficient),
                Rule::Table(points) => interpolated(points, x),
                Rule::Sensor(sensor) => sensor.value(x),
                Rule::Add => x + at(step.second, &outcomes)?,
                Rule::Subtract => at(step.second, &outcomes)? - x,
            };
            outcomes.push(value);
        }
        output.push(at(result, &outcomes)?);
    }
    Ok(output)
}

/// Returns the numbers as recorded; an error for DAQmx data with several numbers per sample.
fn unscaled(channel: &Object, numbers: &Numbers) -> Result<Vec<f64>, LabioError> {
    match numbers.scalers.as_slice() {
        [] => Ok(numbers.values.clone()),
        [(_, values)] => Ok(values.clone()),
        several => {
            let found = format!("{} of them without a scale", several.len());
            let expected = "a property `NI_Number_Of_Scales` that states how they are combined";
            Err(malformed(
                channel.index_place,
                "DAQmx scalers",
                found,
                expected,
            ))
        }
    }
}

/// Returns the source of the result, and the steps that lead to the scale `last`, each after the
/// steps that it needs.
fn steps(
    scales: &Scales<'_>,
    last: u32,
    numbers: &Numbers,
) -> Result<(Input, Vec<Step>), LabioError> {
    // sources have smaller indices, so that the steps can be computed in ascending order
    let mut needed = std::collections::BTreeSet::from([last]);
    let mut open = vec![last];
    while let Some(scale) = open.pop() {
        for source in scales.sources(scale)? {
            if source != RAW && needed.insert(source) {
                open.push(source);
            }
        }
        if needed.len() > MOST_SCALES {
            let found = format!("more than {MOST_SCALES} scales that depend on each other");
            return Err(scales.refused("NI_Number_Of_Scales", found, "fewer"));
        }
    }
    let mut places: Vec<(u32, Input)> = Vec::with_capacity(needed.len());
    let mut steps = Vec::with_capacity(needed.len());
    for scale in needed {
        let input = if scales.kind(scale).is_some() {
            let inputs = scales.sources(scale)?.into_iter().map(|source| {
                let known = places.iter().find(|(known, _)| *known == source);
                known.map_or(Input::Raw, |(_, input)| *input)
            });
            steps.push(scales.step(scale, &inputs.collect::<Vec<_>>())?);
            Input::Step(steps.len() - 1)
        } else if let Some(slot) = numbers
            .scalers
            .iter()
            .position(|(known, _)| *known == scale)
        {
            Input::Scaler(slot)
        } else {
            let name = format!("NI_Scale[{scale}]_Scale_Type");
            return Err(scales.wrong(&name, "a kind of scale, or a DAQmx scaler of that number"));
        };
        places.push((scale, input));
    }
    let result = places.last().map_or(Input::Raw, |(_, input)| *input);
    Ok((result, steps))
}

/// Linear interpolation between points; constant beyond the ends of the table, as in the device's
/// driver.
fn interpolated(points: &[(f64, f64)], x: f64) -> f64 {
    if x.is_nan() {
        return x;
    }
    let after = points.partition_point(|point| point.0 <= x);
    match (
        after.checked_sub(1).and_then(|before| points.get(before)),
        points.get(after),
    ) {
        (Some(before), Some(after)) => {
            before.1 + (after.1 - before.1) * ((x - before.0) / (after.0 - before.0))
        }
        (Some(end), None) | (None, Some(end)) => end.1,
        (None, None) => f64::NAN,
    }
}
