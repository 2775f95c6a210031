//! `cargo xtask reproduce-paper-d`: Tables A1, 4 and 5 of paper D, and a figure a material.

mod appendix;
mod figure;
mod identify;
mod materials;
mod tables;
mod virtual_test;

use rayon::prelude::*;
use serde_json::json;

use super::{Error, Reproduction, Shown};
use crate::fixtures::paper_d;

use appendix::Row;
use materials::Material;
use virtual_test::Rig;

/// The figure of the README.
const FIGURE: Shown = Shown {
    file: "polypropylene.svg",
    path: "docs/figures/reproduce-paper-d.svg",
};

pub(crate) fn reproduce() -> Result<Reproduction, Error> {
    let paper = paper_d::load()?;
    let rig = Rig::of(&paper);
    let (rows, materials) = compute(&paper, &rig)?;
    Ok(Reproduction {
        title: "Paper D: tables recomputed".into(),
        introduction: tables::introduction(&paper),
        body: tables::body(&rows, &materials),
        conclusion: tables::conclusion(&rows, &materials),
        summary: json!({
            "command": "cargo xtask reproduce-paper-d",
            "source": "Ödeen 1993, paper D",
            "tests": "virtual: the measured histories were not published",
            "table_a1": rows,
            "tables_4_and_5": materials,
        }),
        files: materials
            .iter()
            .filter(|m| m.reading == paper_d::UnitReading::Realistic)
            .map(|material| {
                let name = material.material.to_lowercase().replace(' ', "-");
                let svg = figure::svg(material, rig.striker.velocity);
                (format!("{name}.svg"), svg)
            })
            .collect(),
        shown: Some(FIGURE),
    })
}

/// All rows, in the order of the tables whatever the number of threads.
fn compute(paper: &paper_d::PaperD, rig: &Rig) -> Result<(Vec<Row>, Vec<Material>), Error> {
    enum Job {
        Appendix(appendix::Job),
        Material(materials::Job),
    }
    enum Done {
        Appendix(Row),
        Material(Material),
    }
    let jobs: Vec<Job> = materials::jobs(paper)
        .into_iter()
        .map(Job::Material)
        .chain(appendix::jobs(paper).into_iter().map(Job::Appendix))
        .collect();
    let done: Vec<Done> = jobs
        .par_iter()
        // one job a piece of work: they differ in length by a factor of ten
        .with_max_len(1)
        .map(|job| {
            Ok(match job {
                Job::Appendix(job) => Done::Appendix(appendix::run(job, rig)?),
                Job::Material(job) => Done::Material(materials::run(job, rig)?),
            })
        })
        .collect::<Result<_, Error>>()?;
    let (mut rows, mut materials) = (Vec::new(), Vec::new());
    for result in done {
        match result {
            Done::Appendix(row) => rows.push(row),
            Done::Material(material) => materials.push(material),
        }
    }
    Ok((rows, materials))
}
