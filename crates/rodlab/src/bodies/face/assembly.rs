//! Bodies of a sheet that are joined at points.

use impulse::{Assembly, Joint, MeasuredPoints, Point, SharedSubstructure};
use serde::Deserialize;

use super::BodySheet;
use crate::RodlabError;
use crate::bodies::material_sheet::Materials;
use crate::bodies::measured::MeasuredBodySheet;
use crate::responses::{CompletionSheet, ResponseFile, SupportSheet};
use crate::sheet::{Duration, Exact, Frequency, Ratio, SpecificImpedance, Stated, Stiffness};

/// Bodies joined at points, struck at one of them. All points move along one axis.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AssemblySheet {
    /// The struck point: the name of a member, such as `"rod"`, for its impact face, or of a member
    /// and its point, such as `"rod, end"`.
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
    /// The body. A `Chain` has two points, `face` and `end`; other bodies have their `face` alone.
    #[serde(default)]
    pub body: Option<BodySheet>,
    /// Measured mobilities of several points.
    #[serde(default)]
    pub measured: Option<MeasuredPointsSheet>,
}

/// Measured mobilities of several points of a body and between them.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredPointsSheet {
    /// Names of the points.
    pub points: Vec<String>,
    /// The mobility of each point, and once of each pair of points.
    pub mobilities: Vec<PairSheet>,
    /// Upper frequency of the lines used; by default all lines.
    #[serde(default)]
    pub up_to: Option<Exact<Frequency>>,
    /// Support of the body, as of a measured body.
    #[serde(default)]
    pub support: SupportSheet,
    /// Replacement of low-frequency lines of a free body by its weighed mass; by default they stay
    /// as measured.
    #[serde(default)]
    pub complete: Option<CompletionSheet>,
    /// Standard uncertainty of the scale, common to all mobilities, such as `"1 %"`.
    #[serde(default)]
    pub scale_uncertainty: Option<Exact<Ratio>>,
    /// Standard uncertainty of the delay of the response behind the force, common to all mobilities.
    #[serde(default)]
    pub delay_uncertainty: Option<Exact<Duration>>,
}

/// A measured mobility between two points, or of one.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSheet {
    /// The two points, such as `("shank", "edge")`; twice the same for the mobility of one.
    pub between: (String, String),
    /// The file.
    pub response: ResponseFile,
    /// Characteristic impedance of the material at the point, of the mobility of one, such as
    /// `"2250 kg/s ± 2 %"`.
    #[serde(default)]
    pub front_impedance: Option<Stated<SpecificImpedance>>,
}

/// A joint between two points: rigid, unless stiffness or resistance are stated.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointSheet {
    /// The two points, such as `("rod, end", "bit")`; `"ground"` does not move.
    pub between: (String, String),
    /// Stiffness of a spring.
    #[serde(default)]
    pub stiffness: Option<Stated<Stiffness>>,
    /// Resistance of a dashpot beside the spring.
    #[serde(default)]
    pub resistance: Option<Stated<SpecificImpedance>>,
}

/// Name of what does not move.
const GROUND: &str = "ground";

/// Names of the points of a computed body.
const FACES: [&str; 2] = ["face", "end"];

impl MeasuredPointsSheet {
    /// The measurement of the pair of points with these indices, as that of a body at its face.
    fn of_pair(
        &self,
        row: usize,
        column: usize,
        field: &str,
    ) -> Result<MeasuredBodySheet, RodlabError> {
        let name = |index: usize| self.points.get(index).map_or("", String::as_str);
        let wanted = [name(row), name(column)];
        let mut found = self.mobilities.iter().filter(|pair| {
            let between = [pair.between.0.as_str(), pair.between.1.as_str()];
            between == wanted || [between[1], between[0]] == wanted
        });
        let (pair, again) = (found.next(), found.next());
        let (Some(pair), None) = (pair, again) else {
            let times = if pair.is_none() {
                "no mobility"
            } else {
                "several mobilities"
            };
            return Err(RodlabError::request(
                format!("{field}.mobilities"),
                format!("{times} between \"{}\" and \"{}\"", wanted[0], wanted[1]),
                "one for each point and each pair of points, in either order",
            ));
        };
        let response = pair.response.clone();
        Ok(MeasuredBodySheet {
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
        })
    }

    /// The measured mobilities, read one after the other by `read`, which is told whether a pair is
    /// one point.
    pub(crate) fn read(
        &self,
        field: &str,
        mut read: impl FnMut(&MeasuredBodySheet, bool) -> Result<impulse::MeasuredBody, RodlabError>,
    ) -> Result<MeasuredPoints, RodlabError> {
        let count = self.points.len();
        let known = |name: &String| self.points.contains(name);
        for pair in &self.mobilities {
            for name in [&pair.between.0, &pair.between.1] {
                if !known(name) {
                    return Err(unknown(&format!("{field}.mobilities"), name, &self.points));
                }
            }
        }
        let mut entries = Vec::new();
        for row in 0..count {
            for column in row..count {
                entries.push(read(&self.of_pair(row, column, field)?, row == column)?);
            }
        }
        MeasuredPoints::of(count, entries).map_err(|error| RodlabError::step(field, error))
    }
}

impl MemberSheet {
    /// Names of the points.
    fn points(&self) -> Vec<String> {
        match (&self.measured, &self.body) {
            (Some(measured), _) => measured.points.clone(),
            (None, Some(BodySheet::Chain { .. })) => FACES.map(str::to_owned).to_vec(),
            (None, _) => vec![FACES[0].to_owned()],
        }
    }
}

impl AssemblySheet {
    /// Joins the members that `member` makes by their index.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Request`] for names that are not known or used twice;
    /// [`RodlabError::Step`] for members that are not joined.
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
                let found = format!("the name \"{}\" again", sheet.name);
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
                .map_err(|error| RodlabError::step(place, error))?,
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
                    "every member joined to the struck one, over others or at once",
                )
            }
            error => RodlabError::step(field, error),
        })
    }

    /// The member of this index, which must be computed.
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
                "one that is computed",
            )),
        }
    }

    /// The point of a text such as `"rod"` or `"rod, end"`; the ground follows the members.
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
