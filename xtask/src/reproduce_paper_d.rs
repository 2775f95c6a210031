//! `cargo xtask reproduce-paper-d`: Tables A1, 4 and 5 of paper D, and a figure a material.

mod appendix;
mod figure;
mod identify;
mod materials;
mod tables;
mod virtual_test;

use rayon::prelude::*;
use serde_json::json;

use crate::Outcome;
use crate::fixtures::paper_d;
use crate::generated::{workspace_root, write_whole};
use crate::snapshot;

use appendix::Row;
use materials::Material;
use virtual_test::Rig;

const SNAPSHOT: &str = "xtask/snapshots/reproduce-paper-d.json";
const ACCEPT: &str = "cargo xtask reproduce-paper-d --accept";
/// The figure of the README.
const FIGURE: &str = "docs/figures/reproduce-paper-d.svg";

type Error = Box<dyn std::error::Error + Send + Sync>;

pub(crate) fn run(check: bool, accept: bool) -> Outcome {
    let paper = paper_d::load()?;
    let rig = Rig::of(&paper);
    let (rows, materials) =
        compute(&paper, &rig).map_err(|error| -> Box<dyn std::error::Error> { error })?;
    let tables = tables::markdown(&paper, &rows, &materials);
    let summary = json!({
        "command": "cargo xtask reproduce-paper-d",
        "source": "Ödeen 1993, paper D",
        "tests": "virtual: the measured histories were not published",
        "table_a1": rows,
        "tables_4_and_5": materials,
    });
    println!("{tables}");

    let folder = workspace_root().join("target/reproduce/paper-d");
    write_whole(&folder.join("tables.md"), &tables)?;
    write_whole(
        &folder.join("summary.json"),
        &(serde_json::to_string_pretty(&summary)? + "\n"),
    )?;
    for material in materials
        .iter()
        .filter(|m| m.reading == paper_d::UnitReading::Realistic)
    {
        let svg = figure::svg(material, rig.striker.velocity);
        let name = material.material.to_lowercase().replace(' ', "-");
        write_whole(&folder.join(format!("{name}.svg")), &svg)?;
        if accept && name == "polypropylene" {
            write_whole(&workspace_root().join(FIGURE), &svg)?;
        }
    }
    println!("Written to {}", folder.display());
    if check || accept {
        snapshot::compare(&workspace_root().join(SNAPSHOT), &summary, accept, ACCEPT)?;
        println!(
            "{} {SNAPSHOT}",
            if accept { "Accepted as" } else { "Agrees with" }
        );
    }
    Ok(())
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
