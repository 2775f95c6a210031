//! Bodies of a sheet that are joined at points.

use impulse::{Assembly, Joint, MeasuredPoints, Point, Reciprocity, SharedSubstructure};
use serde::Deserialize;

use super::BodySheet;
use crate::bodies::material_sheet::Materials;
use crate::bodies::measured::MeasuredBodySheet;
use crate::outcome::Quantity;
use crate::responses::{CompletionSheet, ResponseFile, SupportSheet};
use crate::sheet::{Duration, Exact, Frequency, Ratio, SpecificImpedance, Stated, Stiffness};
use crate::{InStep, Outcome, RodlabError};

/// Bodies joined at points, struck at one of them. All points move along one axis.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AssemblySheet {
    /// The struck point. The name of a member alone, such as `"rod"`, means its impact face;
    /// another point is stated by the names of the member and the point, such as `"rod, end"`.
    pub face: String,
    /// The members.
    pub members: Vec<MemberSheet>,
    /// The joints between points of members.
    pub joints: Vec<JointSheet>,
}

/// A member of an assembly: a body, or the measured mobilities of its points.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemberSheet {
    /// Name of the member, without a comma.
    pub name: String,
    /// The body. A `Chain` has two points, `face` and `end`; other bodies have only a `face`.
    pub body: Option<BodySheet>,
    /// Measured mobilities of several points.
    pub measured: Option<MeasuredPointsSheet>,
}

/// Measured mobilities at several points of a body and between these points.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredPointsSheet {
    /// Names of the points.
    pub points: Vec<String>,
    /// The mobility at each point, and between each pair of points in one or both directions. If
    /// both directions are measured, they are compared and their mean is used.
    pub mobilities: Vec<PairSheet>,
    /// Upper frequency of the lines used; by default all lines.
    pub up_to: Option<Exact<Frequency>>,
    /// Support of the body, stated like that of a measured body.
    #[serde(default)]
    pub support: SupportSheet,
    /// Replacement of low-frequency lines of a free body by its weighed mass; by default the lines
    /// stay as measured.
    pub complete: Option<CompletionSheet>,
    /// Standard uncertainty of the scale, common to all mobilities, such as `"1 %"`.
    pub scale_uncertainty: Option<Exact<Ratio>>,
    /// Standard uncertainty of the delay of the response relative to the force, common to all
    /// mobilities.
    pub delay_uncertainty: Option<Exact<Duration>>,
}

/// A measured mobility at one point, or between two points.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSheet {
    /// The two points, the point of the response first, such as `("shank", "edge")`; for a mobility
    /// at one point, that point twice.
    pub between: (String, String),
    /// The file.
    pub response: ResponseFile,
    /// Characteristic impedance of the material at the point, for a mobility at one point, such as
    /// `"2250 kg/s ± 2 %"`.
    pub front_impedance: Option<Stated<SpecificImpedance>>,
}

/// The comparison of a pair of points that was measured in both directions.
pub(crate) struct BothDirections {
    points: [String; 2],
    reciprocity: Reciprocity,
    frequency_step_hz: f64,
    n_lines: usize,
}

impl BothDirections {
    /// Fraction of the lines on which the directions may contradict each other, because of faults
    /// on single lines such as mains hum.
    const FEW: f64 = 0.01;

    /// Enters the comparison in the outcome; contradictions on more than 1 % of the lines put the
    /// answer in doubt.
    pub(crate) fn tell(&self, field: &str, outcome: &mut Outcome) {
        let [one, other] = &self.points;
        let found = &self.reciprocity;
        let count = found.contradicting_lines;
        let holds = count as f64 <= Self::FEW * self.n_lines as f64;
        let verdict = match found.worst {
            None => {
                "the lines have no standard errors, so the difference cannot be tested".to_owned()
            }
            Some((line, errors)) => format!(
                "{count} of {} lines differ by more than four standard errors; the largest difference, at {} Hz, is {errors:.1} standard errors",
                self.n_lines,
                line as f64 * self.frequency_step_hz
            ),
        };
        let name = format!("difference of the directions between \"{one}\" and \"{other}\"");
        if !holds {
            outcome.doubt(format!(
                "{field}: the responses between \"{one}\" and \"{other}\" differ with the direction: {verdict}; check points, directions and gains"
            ));
        }
        let size = found.relative_difference.sqrt();
        let quantity = Quantity::of(format!("{field}: {name}"), "", size, verdict);
        outcome.quantities.push(quantity.valid_if(holds));
    }
}

/// A joint between two points: rigid, unless a stiffness or a resistance is stated.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointSheet {
    /// The two points, such as `("rod, end", "bit")`; the point `"ground"` does not move.
    pub between: (String, String),
    /// Stiffness of a spring.
    pub stiffness: Option<Stated<Stiffness>>,
    /// Resistance of a dashpot in parallel with the spring.
    pub resistance: Option<Stated<SpecificImpedance>>,
}

/// Name of the point that does not move.
const GROUND: &str = "ground";

/// Names of the points of a computed body.
const FACES: [&str; 2] = ["face", "end"];

impl MeasuredPointsSheet {
    /// Returns the measurements between the points with these indices, each in the form of a
    /// measured body: one measurement, or one for each direction.
    fn of_pair(
        &self,
        row: usize,
        column: usize,
        field: &str,
    ) -> Result<Vec<MeasuredBodySheet>, RodlabError> {
        let name = |index: usize| self.points.get(index).map_or("", String::as_str);
        let wanted = [name(row), name(column)];
        let of_direction = |[to, from]: [&str; 2]| -> Vec<&PairSheet> {
            let pairs = self.mobilities.iter();
            pairs
                .filter(|pair| (pair.between.0.as_str(), pair.between.1.as_str()) == (to, from))
                .collect()
        };
        let mut found = of_direction(wanted);
        let mut is_once = found.len() <= 1;
        if row != column {
            let backward = of_direction([wanted[1], wanted[0]]);
            is_once &= backward.len() <= 1;
            found.extend(backward);
        }
        if found.is_empty() || !is_once {
            let times = if found.is_empty() {
                "no mobility"
            } else {
                "several mobilities"
            };
            return Err(RodlabError::request(
                format!("{field}.mobilities"),
                format!("{times} between \"{}\" and \"{}\"", wanted[0], wanted[1]),
                "one for each point, and one for each pair of points or one in each direction",
            ));
        }
        Ok(found.into_iter().map(|pair| self.at_face(pair)).collect())
    }

    fn at_face(&self, pair: &PairSheet) -> MeasuredBodySheet {
        let response = pair.response.clone();
        MeasuredBodySheet {
            file: response.file,
            data_set: response.data_set,
            imaginary: response.imaginary,
            kind: response.kind,
            standard_error: response.standard_error,
            coherence: response.coherence,
            averages: response.averages,
            up_to: self.up_to.clone(),
            support: self.support.clone(),
            complete: self.complete.clone(),
            front_impedance: pair.front_impedance.clone(),
            scale_uncertainty: self.scale_uncertainty.clone(),
            delay_uncertainty: self.delay_uncertainty.clone(),
            causal: false,
            passive: false,
        }
    }

    /// Returns the measured mobilities, and the comparisons of pairs measured in both directions.
    /// `read` reads one mobility; its second argument is true for a mobility at one point.
    pub(crate) fn read(
        &self,
        field: &str,
        mut read: impl FnMut(&MeasuredBodySheet, bool) -> Result<impulse::MeasuredBody, RodlabError>,
    ) -> Result<(MeasuredPoints, Vec<BothDirections>), RodlabError> {
        let count = self.points.len();
        let known = |name: &String| self.points.contains(name);
        for pair in &self.mobilities {
            for name in [&pair.between.0, &pair.between.1] {
                if !known(name) {
                    return Err(unknown(&format!("{field}.mobilities"), name, &self.points));
                }
            }
        }
        let (mut entries, mut compared) = (Vec::new(), Vec::new());
        for row in 0..count {
            for column in row..count {
                let sheets = self.of_pair(row, column, field)?;
                let mut directions = sheets.iter().map(|sheet| read(sheet, row == column));
                let mut entry = directions.next().transpose()?;
                if let (Some(forward), Some(backward)) = (&entry, directions.next()) {
                    let (mean, reciprocity) = forward
                        .mean_of_directions(&backward?)
                        .in_step(format!("{field}.mobilities"))?;
                    compared.push(BothDirections {
                        points: [row, column]
                            .map(|at| self.points.get(at).cloned().unwrap_or_default()),
                        reciprocity,
                        frequency_step_hz: mean.frequency_step_hz(),
                        n_lines: mean.mobility().len(),
                    });
                    entry = Some(mean);
                }
                entries.extend(entry);
            }
        }
        let points = MeasuredPoints::of(count, entries);
        Ok((points.in_step(field)?, compared))
    }
}

impl MemberSheet {
    fn points(&self) -> Vec<String> {
        match (&self.measured, &self.body) {
            (Some(measured), _) => measured.points.clone(),
            (None, Some(BodySheet::Chain { .. })) => FACES.map(str::to_owned).to_vec(),
            (None, _) => vec![FACES[0].to_owned()],
        }
    }
}

impl AssemblySheet {
    /// Joins the members; `member` creates a member from its index.
    pub(crate) fn assembled(
        &self,
        field: &str,
        member: impl FnMut(usize) -> Result<SharedSubstructure, RodlabError>,
    ) -> Result<Assembly, RodlabError> {
        for (at, sheet) in self.members.iter().enumerate() {
            let place = format!("{field}.members[{at}]");
            let earlier = self.members.iter().take(at);
            if sheet.name == GROUND || sheet.name.contains(',') {
                let expected = "a name without a comma, other than \"ground\"";
                return Err(RodlabError::request(place, sheet.name.clone(), expected));
            }
            if earlier.into_iter().any(|other| other.name == sheet.name) {
                let found = format!("the name \"{}\" a second time", sheet.name);
                return Err(RodlabError::request(place, found, "another name"));
            }
            if sheet.body.is_some() == sheet.measured.is_some() {
                let found = "both or neither of `body` and `measured`";
                return Err(RodlabError::request(place, found, "one of them"));
            }
        }
        let mut members: Vec<SharedSubstructure> = (0..self.members.len())
            .map(member)
            .collect::<Result<_, _>>()?;
        let mut joints = Vec::with_capacity(self.joints.len());
        for (at, sheet) in self.joints.iter().enumerate() {
            let place = format!("{field}.joints[{at}]");
            let one = self.point(&sheet.between.0, &format!("{place}.between"))?;
            let other = self.point(&sheet.between.1, &format!("{place}.between"))?;
            joints.push(match (&sheet.stiffness, &sheet.resistance) {
                (None, None) => Joint::rigid(one, other),
                (stiffness, resistance) => Joint::compliant(
                    one,
                    other,
                    stiffness.as_ref().map_or(0.0, Stated::nominal),
                    resistance.as_ref().map_or(0.0, Stated::nominal),
                )
                .in_step(place)?,
            });
        }
        if self.joints.iter().any(JointSheet::is_to_ground) {
            members.push(std::sync::Arc::new(impulse::AtFace::ground()));
        }
        let face = self.point(&self.face, &format!("{field}.face"))?;
        Assembly::of(members, &joints, face).map_err(|error| match error {
            impulse::ImpulseError::NotJoined { member } => {
                let name = self.members.get(member).map_or(GROUND, |sheet| &sheet.name);
                RodlabError::request(
                    format!("{field}.joints"),
                    format!("no joint that leads from \"{}\" to \"{name}\"", self.face),
                    "every member joined to the struck member, directly or through other members",
                )
            }
            error => RodlabError::step(field, error),
        })
    }

    /// Returns the member with this index, which must be a computed body.
    pub(crate) fn computed_member(
        &self,
        at: usize,
        materials: &Materials,
        field: &str,
    ) -> Result<SharedSubstructure, RodlabError> {
        let place = format!("{field}.members[{at}]");
        match self.members.get(at).and_then(|member| member.body.as_ref()) {
            Some(body) => body.body(materials, &place)?.substructure(),
            None => Err(RodlabError::request(
                place,
                "a measured member",
                "a computed member",
            )),
        }
    }

    /// Returns the point named by a text such as `"rod"` or `"rod, end"`; the member index of the
    /// ground is one more than that of the last member.
    fn point(&self, text: &str, place: &str) -> Result<Point, RodlabError> {
        if text.trim() == GROUND {
            return Ok(Point::of(self.members.len(), 0));
        }
        let (name, point) = match text.split_once(',') {
            Some((name, point)) => (name.trim(), Some(point.trim())),
            None => (text.trim(), None),
        };
        let Some(at) = self.members.iter().position(|member| member.name == name) else {
            let names = self.members.iter().map(|member| member.name.clone());
            return Err(unknown(place, name, &names.collect::<Vec<_>>()));
        };
        let points = self
            .members
            .get(at)
            .map_or_else(Vec::new, MemberSheet::points);
        let index = match point {
            None => Some(0),
            Some(point) => points.iter().position(|known| known == point),
        };
        match index {
            Some(index) => Ok(Point::of(at, index)),
            None => Err(unknown(place, point.unwrap_or_default(), &points)),
        }
    }
}

impl JointSheet {
    fn is_to_ground(&self) -> bool {
        let (one, other) = &self.between;
        [one, other].iter().any(|text| text.trim() == GROUND)
    }
}

fn unknown(place: &str, name: &str, known: &[String]) -> RodlabError {
    RodlabError::request(
        place,
        format!("\"{name}\""),
        format!("one of \"{}\"", known.join("\", \"")),
    )
}
