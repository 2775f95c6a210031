//! `cargo xtask reproduce-paper-a`: Table 1, Tests 1 to 10 (Figures 3 and 4), temperatures (Figures
//! 5 and 6), roots, series, linearity.
//!
//! The figures follow (Ödeen 1993, paper A, Figures 4 and 6): the rod of polyamide 6, and the values
//! at 1 kHz over temperature.

mod branches;
mod figure;
mod rig;
mod room_temperature;
mod roots;
mod swing;
mod temperature;
mod wave_method;

use rodwave::digits::significant;
use serde_json::json;

use super::{Error, Reproduction};
use room_temperature::Evaluated;
use testbed::papers::paper_a::{PaperA, Test, load};
use testbed::papers::paper_e;

pub(crate) fn reproduce() -> Result<Reproduction, Error> {
    let paper = load()?;
    let branches = branches::all(&paper);
    let tests = room_temperature::all(&paper)?;
    let pulses = wave_method::all(&paper, &tests)?;
    let heated = temperature::all(&paper)?;
    let wrong = roots::wrong_roots(&paper, &paper_e::load()?)?;
    let series = roots::series(&paper)?;
    let swings = swing::all(&paper)?;
    let tables = [
        (
            "table-1",
            "Table 1: the branch of eq. 3 in each quarter turn of kL",
            "",
            branches::table(&branches),
        ),
        (
            "tests",
            "Figures 3 and 4: Tests 1 to 10",
            "Conditions (i) to (iii) are those of the paper; at a valid line, in addition, five standard errors are below 1 % of E' and 5 % of the loss factor. The \
         figures show lines that fulfil the conditions and whose loss factor has a standard error below 5 %. Other roots \
         by eq. 5 are counted on lines that fulfil the conditions; they are unnoticed if the other root fulfils them too.\n\n",
            room_temperature::table(&tests),
        ),
        (
            "two-methods",
            "Figures 3a and 4: two methods on one rod",
            "The other method uses a pulse that passes two sections of the rod before a reflection returns.\n\n",
            wave_method::table(&pulses),
        ),
        (
            "figure-6",
            "Figures 5 and 6: Test 6 from 20 to 140 °C",
            "Means over the lines within 50 Hz of 1 kHz that fulfil conditions (i) to (iii).\n\n",
            temperature::table(&heated),
        ),
        (
            "roots",
            "Roots by eq. 5 from γ_0 L and by continuation in μ, at low loss",
            "A rod with a fifth of the damping of paper E, eq. 7, μ = 0.036, 1572 lines from 362 Hz to 20 kHz.\n\n",
            roots::wrong_table(&wrong),
        ),
        (
            "series",
            "Eqs. 6 and 7 compared with the numerical solution",
            "Computed from exact ratios. The criterion accepts a line if E' and E'' of two terms are within one third of those of four terms.\n\n",
            roots::series_table(&series),
        ),
        ("swing-angles", "Swing angles", "", swing::table(&swings)),
    ];
    let body = tables
        .iter()
        .map(|(_, heading, note, table)| format!("## {heading}\n\n{note}{}\n", table.markdown()))
        .collect();
    let of = |names: &[&str]| -> Vec<&Evaluated> {
        tests
            .iter()
            .filter(|test| names.contains(&test.row.test.as_str()))
            .collect()
    };
    let mut files: Vec<_> = tables
        .iter()
        .map(|(name, .., table)| (format!("{name}.csv"), table.csv()))
        .collect();
    let curves = room_temperature::curves(&tests).csv();
    files.push(("figures-3-4.csv".into(), curves));
    for (number, rods, names, pulses) in [
        (
            "3a",
            "polypropylene, D = 11 mm",
            &["1", "2", "3"][..],
            pulses.first(),
        ),
        ("3b", "polypropylene, D = 16 mm", &["4", "5", "6"], None),
        ("3c", "polypropylene, D = 19 mm", &["7", "8", "9"], None),
        ("4", "polyamide 6, D = 11 mm", &["10"], pulses.get(1)),
    ] {
        let name = format!("figure-{number}");
        let title = format!("Paper A, Figure {number}, virtual: {rods}");
        files.push(figure::room_temperature(&name, &title, &of(names), pulses));
    }
    files.extend([
        figure::temperatures(&heated),
        figure::at_one_kilohertz(&heated),
    ]);
    Ok(Reproduction {
        title: "Paper A: tables and figures recomputed".into(),
        introduction: introduction(&paper),
        body,
        conclusion: conclusion(
            &paper, &branches, &tests, &pulses, &heated, &wrong, &series, &swings,
        ),
        summary: json!({
            "command": "cargo xtask reproduce-paper-a",
            "source": "Ödeen 1993, paper A",
            "tests": "virtual: the measured accelerations and moduli were not published as numbers",
            "table_1": branches,
            "figures_3_and_4": tests.iter().map(|test| &test.row).collect::<Vec<_>>(),
            "two_methods": pulses.iter().map(|one| &one.row).collect::<Vec<_>>(),
            "figure_6": heated.iter().map(|one| &one.row).collect::<Vec<_>>(),
            "roots": wrong,
            "series": series,
            "swing_angles": swings,
        }),
        files,
    })
}

/// Returns a test of Table 2.
fn named<'a>(paper: &'a PaperA, name: &str) -> Result<&'a Test, Error> {
    let test = paper.tests.iter().find(|test| test.name == name);
    test.ok_or_else(|| format!("Table 2 of paper A has no Test {name}").into())
}

fn introduction(paper: &PaperA) -> String {
    let law = |(modulus, loss_factor, omega): (f64, f64, f64)| {
        format!(
            "{} GPa at {:.1} kHz with loss factor {loss_factor}",
            significant(1e-9 * modulus, 3),
            1e-3 * omega / std::f64::consts::TAU
        )
    };
    format!(
        "S. Ödeen and B. Lundberg, Determination of complex modulus from measured end-point accelerations of an impacted rod specimen \
         (Ödeen 1993, paper A).\n\n\
         **All tests are virtual**: specimens, accelerometers, number of tests and swing angles are those of the paper. Assumed here are the materials, \
         with loss factors that do not depend on frequency and the corresponding causal moduli (polypropylene {}, polyamide 6 {}, the level of \
         paper E, eq. 7), the force of a hit (a raised cosine of {} N and {:.0} µs), the analyser ({:.1} kHz, {} bits, filter) and its noise ({} of \
         the greatest acceleration on a sample). The dependence on temperature is assumed, not measured: from 20 °C on, E' decreases by a factor of e (2.718) \
         every {:.0} K, and the loss factor grows by {} per K. As in the paper, changes of dimensions and density with temperature are neglected.\n\n\
         Errata applied: the layout of Table 1 is lost in print and is restored from eq. 3; eq. 5 started from γ_0 L converges to wrong roots, \
         so the root is continued from μ = 0; the largest diameter is 18.8 mm (Table 2), not 21 mm. Ψ is estimated by H_1 from ten tests, as in \
         section 3; the limit of {} Hz is that of the paper.\n",
        law(testbed::papers::paper_a::POLYPROPYLENE),
        law(testbed::papers::paper_a::POLYAMIDE),
        rig::BLOW.0,
        1e6 * rig::BLOW.1,
        1e-3 * rig::RATE_HZ,
        rig::BITS,
        rig::NOISE,
        temperature::FALL,
        temperature::GROWTH,
        paper.highest_hz,
    )
}

#[expect(clippy::too_many_arguments, reason = "one for each part of the paper")]
fn conclusion(
    paper: &PaperA,
    branches: &[branches::Row],
    tests: &[Evaluated],
    pulses: &[wave_method::Comparison],
    heated: &[temperature::Heated],
    wrong: &[roots::Wrong],
    series: &[roots::Series],
    swings: &[swing::Row],
) -> Vec<String> {
    let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let agreeing = branches.iter().filter(|row| row.agrees).count();
    let mut sentences = vec![format!(
        "Table 1: in {agreeing} of {} quarter turns s, n and the signs of φ are those of the restored table, and eqs. 3 and 4 reproduce γL to \
         {:.0e}.",
        branches.len(),
        greatest(&mut branches.iter().map(|row| row.at_rounding)),
    )];
    let slender: Vec<String> = tests
        .iter()
        .filter(|test| ["3", "6", "10"].contains(&test.row.test.as_str()))
        .map(|test| {
            let [first, last] = test.row.admissible_hz;
            format!(
                "{first:.0} Hz to {:.1} kHz in Test {}",
                1e-3 * last,
                test.row.test
            )
        })
        .collect();
    sentences.push(format!(
        "Conditions (i) to (iii) are met from {}; the paper states 400 Hz to 20 kHz. The errors increase towards low frequencies.",
        slender.join(", ")
    ));
    let polypropylene = || tests.iter().filter(|test| test.row.test != "10");
    sentences.push(format!(
        "Figure 3: on the valid lines of Tests 1 to 9, the error of E' is at most {} % and that of E''/E' {} %; {:.0} % to {:.0} % of the values are \
         within two standard errors of the material, {:.0} % to {:.0} % within one.",
        significant(100.0 * greatest(&mut polypropylene().map(|test| test.row.worst[0])), 2),
        significant(100.0 * greatest(&mut polypropylene().map(|test| test.row.worst[1])), 2),
        100.0 * polypropylene().map(|test| test.row.within[1]).fold(1.0, f64::min),
        100.0 * greatest(&mut polypropylene().map(|test| test.row.within[1])),
        100.0 * polypropylene().map(|test| test.row.within[0]).fold(1.0, f64::min),
        100.0 * greatest(&mut polypropylene().map(|test| test.row.within[0])),
    ));
    let other_roots: Vec<String> = tests
        .iter()
        .filter(|test| test.row.wrong_by_newton > 0)
        .map(|test| {
            format!(
                "Test {} on {} lines ({} unnoticed)",
                test.row.test, test.row.wrong_by_newton, test.row.unnoticed
            )
        })
        .collect();
    sentences.push(format!(
        "Eq. 5 started from γ_0 L gives another root than continuation in {}; the paper reports inadmissible solutions in Tests 1 and 10.",
        if other_roots.is_empty() {
            "no test".to_owned()
        } else {
            other_roots.join(", ")
        }
    ));
    for row in wrong {
        sentences.push(format!(
            "Low loss, {} % noise: eq. 5 started from γ_0 L gives a wrong root on {} lines, {} of them unnoticed by conditions (i) to (iii); \
             continuation gives a wrong root on {}.",
            100.0 * row.noise,
            row.wrong[0],
            row.unnoticed[0],
            row.wrong[1],
        ));
    }
    let small: Vec<&roots::Series> = series
        .iter()
        .filter(|row| row.mass_ratio < paper.mass_ratio_highest && row.test != "10")
        .collect();
    let names: Vec<&str> = small.iter().map(|row| row.test.as_str()).collect();
    sentences.push(format!(
        "Series: for polypropylene with μ < {} (Tests {}), four terms are within {} % of E' and {} % of E'' on all lines, and the criterion of \
         one third accepts {} of {}. On the lines that it accepts in all ten tests, four terms are within {} % of E' and {} % of E''.",
        paper.mass_ratio_highest,
        names.join(", "),
        significant(100.0 * greatest(&mut small.iter().map(|row| row.of_all[0])), 2),
        significant(100.0 * greatest(&mut small.iter().map(|row| row.of_all[1])), 2),
        small.iter().map(|row| row.accepted).sum::<usize>(),
        small.iter().map(|row| row.lines).sum::<usize>(),
        significant(100.0 * greatest(&mut series.iter().map(|row| row.of_accepted[0])), 2),
        significant(100.0 * greatest(&mut series.iter().map(|row| row.of_accepted[1])), 2),
    ));
    for one in pulses {
        sentences.push(format!(
            "Separate pulses on the rod of Test {}: E' differs from the two-point method by {:.2} standard errors (root mean square), E'' by \
             {:.2}; noise alone gives 1.",
            one.row.test, one.row.over_error[0], one.row.over_error[1],
        ));
    }
    sentences.push(
        "The paper found that the two methods disagree on E'' of polyamide 6; the equations of the methods are not the cause.".into(),
    );
    let at = |one: &temperature::Heated| {
        let row = &one.row;
        (0..3)
            .map(|part| (row.values[part] - row.exact[part]).abs() / row.errors[part])
            .fold(0.0, f64::max)
    };
    let known = |one: Option<&temperature::Heated>| {
        one.map_or(f64::NAN, |one| {
            100.0 * one.row.errors[2] / one.row.values[2]
        })
    };
    sentences.push(format!(
        "Figures 5 and 6: around 1 kHz, E', E'' and the loss factor differ by at most {:.1} standard errors from the assumed law at any of {} \
         temperatures; the standard error of the loss factor is {} % at 20 °C and {} % at 140 °C. The number of valid lines changes from {} to {} as \
         the losses grow.",
        greatest(&mut heated.iter().map(at)),
        heated.len(),
        significant(known(heated.first()), 2),
        significant(known(heated.last()), 2),
        heated.first().map_or(0, |one| one.row.valid),
        heated.last().map_or(0, |one| one.row.valid),
    ));
    sentences.push(format!(
        "Swing angles: Ψ of a linear specimen does not depend on the strength of the hits (to {:.0e} without noise), and E' at 5°, 10° and 20° differs from \
         that of ten further hits at 10° by {:.2} to {:.2} standard errors (root mean square). The larger modulus that the paper found at 20° is not that of a linear \
         specimen, as the paper concludes.",
        greatest(&mut swings.iter().map(|row| row.at_rounding)),
        swings.iter().map(|row| row.over_error).fold(f64::INFINITY, f64::min),
        greatest(&mut swings.iter().map(|row| row.over_error)),
    ));
    sentences.push(
        "Not reproduced: the measured curves of Figures 3 to 6, which were not published as numbers.".into(),
    );
    sentences
}
