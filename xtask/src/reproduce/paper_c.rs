//! `cargo xtask reproduce-paper-c`: Table 1 with the results of eq. 4, Figures 2 and 3, and the fit
//! of the model.

mod curves;
mod figure;
mod fits;
mod readings;

use cmod::recovery::ThreeElement;
use serde_json::json;

use super::{Error, Reproduction};
use testbed::papers::paper_c::load;

pub(crate) fn reproduce() -> Result<Reproduction, Error> {
    let paper = load()?;
    let model = ThreeElement::new(paper.parameters())?;
    let curves = curves::all(&paper, &model)?;
    let readings = readings::of_creep_tests(&paper)?;
    let fits = fits::all(&paper, &readings)?;
    let conclusion = curves::conclusion(&paper, &curves)
        .into_iter()
        .chain(fits::conclusion(&fits))
        .chain([
            "Not reproduced: the symbols of Figures 2 and 3, which were not published as numbers."
                .into(),
        ])
        .collect();
    let recovery = curves::table(&curves);
    let fitted = fits::table(&fits);
    Ok(Reproduction {
        title: "Paper C: tables and figures recomputed".into(),
        introduction: "S. Ödeen et al., Loss factor during creep recovery of polyoximethylene (Ödeen 1993, paper C).\n\n\
             Errata applied: in eq. 5 the outer exponent belongs to the bracket alone, t_r = (t_1/m)[..]^(-m), and E_2 ω_m t_r \
             reads E_2 ω m t_r; B has the unit Pa^-2.8 s^-1. The curves are those of the model with the printed parameters.\n"
            .into(),
        body: format!(
            "## Table 1, and the recovery that eqs. 4 and 5 predict\n\n{}\n\
             Changes of the loss factor at 10 kHz in per cent of the virgin one. t_r as printed contains the erratum and is shown for comparison.\n\n\
             ## Parameters identified from tests\n\n\
             Virtual measurements at {} recovery times per test, computed by integrating the differential equation of the dashpot (not by eq. 4), with \
             independent errors of {} of the loss factor (seed {}).\n\n{}",
            recovery.markdown(),
            readings::TIMES.len(),
            readings::STANDARD_ERROR,
            readings::SEED,
            fitted.markdown(),
        ),
        conclusion,
        summary: json!({
            "command": "cargo xtask reproduce-paper-c",
            "source": "Ödeen 1993, paper C",
            "tests": "virtual: the measured loss factors were not published as numbers",
            "table_1": curves,
            "fits": fits,
        }),
        files: vec![
            ("table-1.csv".into(), recovery.csv()),
            ("parameters.csv".into(), fitted.csv()),
            ("figure-2.csv".into(), curves::csv(&paper, &model, curves::Quantity::LossFactor)?),
            ("figure-3.csv".into(), curves::csv(&paper, &model, curves::Quantity::Modulus)?),
            figure::loss_factor(&paper, &model, &readings)?,
            figure::modulus(&paper, &model)?,
        ],
    })
}
