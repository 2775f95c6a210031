//! `cargo xtask reproduce-paper-x` and `cargo xtask reproduce-all`: the tables and figures of the
//! papers, computed again.
//!
//! The module of each paper provides a [`Reproduction`]. This module contains the common part: the
//! paths of files, the comparison with the snapshot, the printed output.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of tests, lines and cells, from the transcribed tables of the papers"
)]

mod coverage;
mod number;
mod paper_a;
mod paper_b;
mod paper_c;
mod paper_d;
mod paper_e;
pub(crate) mod table;

use std::time::Instant;

use rodfigure::{Figure, Panel};
use serde_json::Value;

use crate::{Comparison, Error, Outcome, snapshot};
use testbed::generated::{workspace_root, write_whole};

pub(crate) use table::{Table, table_of};

/// Figure of paper D that the README shows.
const SHOWN: &str = "polypropylene.svg";

/// Paper of the thesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Paper {
    A,
    B,
    C,
    D,
    E,
}

impl Paper {
    /// Papers, in the order of the thesis.
    pub(crate) const ALL: [Self; 5] = [Self::A, Self::B, Self::C, Self::D, Self::E];

    fn letter(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::B => "b",
            Self::C => "c",
            Self::D => "d",
            Self::E => "e",
        }
    }

    fn compute(self) -> Result<Reproduction, Error> {
        match self {
            Self::A => paper_a::reproduce(),
            Self::B => paper_b::reproduce(),
            Self::C => paper_c::reproduce(),
            Self::D => paper_d::reproduce(),
            Self::E => paper_e::reproduce(),
        }
    }
}

/// Reproduction of a paper.
#[derive(Debug)]
pub(crate) struct Reproduction {
    /// Heading of the page.
    pub(crate) title: String,
    /// Introduction: the virtual parts and the errata applied.
    pub(crate) introduction: String,
    /// Tables and the text between them, as Markdown.
    pub(crate) body: String,
    /// Conclusions: agreements and their limits, in sentences written from the numbers.
    pub(crate) conclusion: Vec<String>,
    /// All numbers of the tables.
    pub(crate) summary: Value,
    /// Other files by name: figures, and tables for further computation.
    pub(crate) files: Vec<(String, String)>,
}

impl Reproduction {
    fn page(&self) -> String {
        let mut page = format!(
            "# {}\n\n{}\n{}\n## What this shows\n\n",
            self.title, self.introduction, self.body
        );
        for sentence in &self.conclusion {
            page.push_str(&format!("- {sentence}\n"));
        }
        page
    }
}

/// Returns the name and the contents of the file of a figure.
fn drawn(name: &str, title: &str, panels: Vec<Panel>) -> (String, String) {
    let svg = rodfigure::svg_of(&Figure::new(name, title, panels));
    (format!("{name}.svg"), svg)
}

/// Reproduces `papers`. A single paper is printed as a whole page; of several papers, only titles
/// and conclusions.
pub(crate) fn run(papers: &[Paper], keep: &Comparison) -> Outcome {
    for paper in papers {
        let began = Instant::now();
        let result = paper.compute()?;
        let page = result.page();
        match papers {
            [_] => println!("{page}"),
            _ => {
                println!("# {}\n", result.title);
                for sentence in &result.conclusion {
                    println!("- {sentence}");
                }
            }
        }
        write(*paper, &result, &page, keep.accept)?;
        if keep.check || keep.accept {
            let letter = paper.letter();
            let name = format!("xtask/snapshots/reproduce-paper-{letter}.json");
            snapshot::compare(
                &workspace_root().join(&name),
                &result.summary,
                keep.accept,
                &format!("cargo xtask reproduce-paper-{letter} --accept"),
            )?;
            println!(
                "{} {name}",
                if keep.accept {
                    "Accepted as"
                } else {
                    "Agrees with"
                }
            );
        }
        // the duration is printed and not written to a file: the files are the same on every
        // machine
        println!("({:.1} s)\n", began.elapsed().as_secs_f64());
    }
    Ok(())
}

fn write(paper: Paper, result: &Reproduction, page: &str, accept: bool) -> Outcome {
    let folder = workspace_root().join(format!("target/reproduce/paper-{}", paper.letter()));
    write_whole(&folder.join("tables.md"), page)?;
    write_whole(
        &folder.join("summary.json"),
        &(serde_json::to_string_pretty(&result.summary)? + "\n"),
    )?;
    for (name, contents) in &result.files {
        write_whole(&folder.join(name), contents)?;
        if accept && name == SHOWN {
            write_whole(
                &workspace_root().join("docs/figures/reproduce-paper-d.svg"),
                contents,
            )?;
        }
    }
    println!("Written to {}", folder.display());
    Ok(())
}
