//! `cargo xtask reproduce-paper-d`: Tables A1, 3, 4 and 5 of paper D, their counterparts for linear
//! rods of constant loss, and a figure for each material.

mod appendix;
mod choice;
mod figure;
mod flat_loss;
mod identify;
mod materials;
mod tables;
mod verdict;
mod virtual_test;

use rayon::prelude::*;
use serde_json::json;

use super::{Error, Reproduction};
use testbed::papers::paper_d;

use appendix::Row;
use flat_loss::FlatLoss;
use materials::Material;
use virtual_test::Rig;

pub(crate) fn reproduce() -> Result<Reproduction, Error> {
    let paper = paper_d::load()?;
    let rig = Rig::of(&paper);
    let Computed {
        rows,
        choices,
        materials,
        flat_losses,
    } = compute(&paper, &rig)?;
    let table_3 = tables::table_3(&choices);
    let of_flat_loss = tables::flat_loss(&flat_losses);
    let table_a1 = tables::table_a1(&rows);
    let table_4 = tables::table_4(&materials);
    let table_5 = tables::table_5(&materials);
    Ok(Reproduction {
        title: "Paper D: tables recomputed".into(),
        introduction: tables::introduction(&paper),
        body: tables::body(&[
            (tables::TABLE_A1, &table_a1),
            (tables::TABLE_3, &table_3),
            (tables::TABLE_4, &table_4),
            (tables::TABLE_5, &table_5),
            (tables::FLAT_LOSS, &of_flat_loss),
        ]),
        conclusion: tables::conclusion(&rows, &choices, &materials, &flat_losses),
        summary: json!({
            "command": "cargo xtask reproduce-paper-d",
            "source": "Ödeen 1993, paper D",
            "tests": "virtual: the measured histories were not published",
            "table_a1": rows,
            "table_3": choices,
            "tables_4_and_5": materials,
            "tables_4_and_5_constant_loss": flat_losses,
        }),
        files: [
            ("table-a1", &table_a1),
            ("table-3", &table_3),
            ("table-4", &table_4),
            ("table-5", &table_5),
            ("constant-loss", &of_flat_loss),
        ]
        .into_iter()
        .map(|(name, table)| (format!("{name}.csv"), table.csv()))
        .chain(
            materials
                .iter()
                .filter(|m| m.reading == paper_d::UnitReading::Realistic)
                .map(|material| figure::of(material, rig.striker.velocity)),
        )
        .collect(),
    })
}

/// Computed results, in the order of the tables for any number of threads.
#[derive(Debug, Default)]
struct Computed {
    rows: Vec<Row>,
    choices: Vec<choice::Row>,
    materials: Vec<Material>,
    flat_losses: Vec<FlatLoss>,
}

fn compute(paper: &paper_d::PaperD, rig: &Rig) -> Result<Computed, Error> {
    enum Job {
        FlatLoss(flat_loss::Job),
        Choice(choice::Job),
        Material(materials::Job),
        Appendix(appendix::Job),
    }
    // the longest jobs start first, so that no long job runs alone at the end
    let jobs: Vec<Job> = (flat_loss::jobs(paper).into_iter().map(Job::FlatLoss))
        .chain(choice::jobs(paper).into_iter().map(Job::Choice))
        .chain(materials::jobs(paper).into_iter().map(Job::Material))
        .chain(appendix::jobs(paper).into_iter().map(Job::Appendix))
        .collect();
    let done: Vec<Computed> = jobs
        .par_iter()
        // jobs are distributed one by one, because their durations differ by a factor of ten
        .with_max_len(1)
        .map(|job| {
            let mut done = Computed::default();
            match job {
                Job::FlatLoss(job) => done.flat_losses.push(flat_loss::run(job, rig)?),
                Job::Choice(job) => done.choices.push(choice::run(job, rig)?),
                Job::Material(job) => done.materials.push(materials::run(job, rig)?),
                Job::Appendix(job) => done.rows.push(appendix::run(job, rig)?),
            }
            Ok(done)
        })
        .collect::<Result<_, Error>>()?;
    let mut computed = Computed::default();
    for one in done {
        computed.flat_losses.extend(one.flat_losses);
        computed.choices.extend(one.choices);
        computed.materials.extend(one.materials);
        computed.rows.extend(one.rows);
    }
    Ok(computed)
}
