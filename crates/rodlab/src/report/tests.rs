use rodfigure::{Panel, Role, svg_of};

use super::*;
use crate::outcome::{Cells, Column, Quantity, Rows, Setting, Table};

/// Returns a panel with one line; the labels of its axes contain markup.
fn line(role: Role, name: &str) -> Panel {
    let marks = vec![Mark::line(name, role, [(0.0, 0.0), (1.0, 1.0)])];
    Panel::new(("</script>", "</noscript>"), ("<g>", ""), marks)
}

fn page(outcome: &Outcome) -> String {
    let drawn: Vec<Drawn> = outcome.figures.iter().map(Drawn::of).collect();
    let sheet = SheetIdentity {
        file: "rod.ron".into(),
        sha256: "0123456789abcdef".repeat(4),
    };
    html_of(outcome, &drawn, &sheet, Some("2026-11-22 12:24:59 UTC")).unwrap()
}

#[test]
fn a_title_is_text_whatever_it_contains() {
    let mut outcome = Outcome::of(
        "modulus",
        "</title></script><script>alert(1)</script> & \"x\" 'y'",
    );
    outcome.summary = vec!["<img src=x onerror=alert(2)>".into()];
    outcome.figures = vec![Figure {
        name: "a".into(),
        title: "</script><script>alert(3)</script>".into(),
        caption: "<b>".into(),
        panels: vec![line(Role::First, "</noscript></script>")],
    }];
    let page = page(&outcome);
    // there are two script elements: the script of the page, and the data of the only figure
    assert_eq!(page.matches("<script").count(), 2, "{page}");
    assert_eq!(page.matches("</script>").count(), 2);
    assert_eq!(page.matches("</noscript>").count(), 1);
    assert_eq!(page.matches("</title>").count(), 1);
    assert!(!page.contains("<img"), "{page}");
}

#[test]
fn nothing_is_loaded_from_anywhere() {
    let page = page(&Outcome::of("frf", "title"));
    for from_elsewhere in ["http://", "https://", "src=", "@import", "url("] {
        let found = page.matches(from_elsewhere).count();
        assert_eq!(found, 0, "{from_elsewhere} in the page");
    }
}

#[test]
fn the_page_says_first_that_there_is_no_answer_and_why() {
    let mut outcome = Outcome::of("modulus", "Rod 7");
    outcome.verdict = Verdict::NotAllowed {
        reason: "Two hits of ten were accepted; three are needed.".into(),
    };
    outcome.warnings = vec!["The coherence is below 0.9.".into()];
    let page = page(&outcome);
    let at = |text: &str| page.find(text).unwrap_or(usize::MAX);
    assert!(at("<strong>not allowed:</strong>") < at("Two hits of ten"));
    assert!(at("Two hits of ten") < at("The coherence"));
    assert!(at("The coherence") < at("Software and citation"));
}

#[test]
fn r11_the_page_has_the_word_of_its_standing_and_every_failed_check() {
    let mut outcome = Outcome::of("modulus", "Rod 7");
    assert!(page(&outcome).contains("<p class=\"standing answered\">answered</p>"));
    outcome.doubt("the polarity check fails");
    outcome.doubt("the passivity check fails");
    let page = page(&outcome);
    assert!(
        page.contains("<p class=\"standing in-doubt\">in doubt</p>"),
        "{page}"
    );
    for check in ["polarity", "passivity"] {
        let said = format!("<strong>in doubt:</strong> the {check} check fails");
        assert!(page.contains(&said), "{page}");
    }
}

#[test]
fn doubts_that_may_explain_a_missing_answer_are_the_first_warnings() {
    let mut outcome = Outcome::of("modulus", "Rod 7");
    outcome.warn("No band is stated.");
    outcome.doubt("hit 6 departs from the others");
    outcome.refuse("no line is valid");
    assert_eq!(
        outcome.warnings,
        ["Hit 6 departs from the others.", "No band is stated."]
    );
}

#[test]
fn a_sentence_has_its_names_as_code_and_its_units_as_figures_have_them() {
    let mut outcome = Outcome::of("frf", "Plate");
    outcome.summary = vec![
        "`a<b` lags by (2.0 ± 0.1) us, at 3 m/s^2.".to_owned(),
        "One ` is <kept>.".to_owned(),
    ];
    let page = page(&outcome);
    assert!(page.contains("<code>a&lt;b</code> lags by (2.0 ± 0.1) µs, at 3 m&#x2f;s²."));
    assert!(page.contains("One ` is &lt;kept&gt;."));
}

/// Returns a table of 1000 lines, of which the lines above 50 kHz are not valid.
fn long_table() -> Table {
    let rows: Vec<f64> = (0..1000).map(f64::from).collect();
    let valid: Vec<bool> = rows.iter().map(|i| *i <= 400.0).collect();
    let words = valid.iter().map(|valid| match valid {
        true => "valid".to_owned(),
        false => "E' may be off by 3.1 %".to_owned(),
    });
    let kinds = valid.iter().map(|valid| match valid {
        true => Vec::new(),
        false => vec!["error of E' above its limit"],
    });
    let validity = Column::validity(valid.clone(), words.collect());
    Rows::of(&rows, "modulus", "Modulus")
        .number("frequency", "Hz", |i| 125.0 * i)
        .number("E'", "GPa", |i| 2.0 + 1e-4 * i)
        .number("standard error of E'", "GPa", |i| 0.01 + 1e-6 * i)
        .number("covariance of E' and E''", "GPa^2", |i| *i)
        .number("common error of E'", "GPa", |_| 0.0)
        .table
        .with(validity.with_kinds(kinds.collect()))
}

#[test]
fn a_long_table_shows_valid_rows_with_errors_beside_values_and_the_rest_to_unfold() {
    let mut outcome = Outcome::of("modulus", "Rod 7");
    outcome.tables = vec![long_table()];
    let page = page(&outcome);
    let has = |text: &str| assert!(page.contains(text), "{text} in {page}");
    has("1000 rows, 12 are shown, spread over the valid ones");
    has("<td class=\"n\">2.000 ± 0.010</td>");
    // the last row of the brief table is the last valid line
    has(
        "<td class=\"n\">50000</td><td class=\"n\">2.040 ± 0.010</td><td class=\"short\">✓</td></tr>\n</tbody>",
    );
    has("The same in all rows: common error of E&#x27; 0 GPa.");
    has("<summary>All 6 columns, 400 of 1000 rows</summary>");
    has("E&#x27; may be off by 3.1 %");
    has("<a href=\"modulus.csv\">");
    // the legend is empty, because no row of the brief table has a letter
    assert!(!page.contains("error of E&#x27; above its limit"), "{page}");
}

#[test]
fn verdicts_have_letters_and_a_legend() {
    let mut outcome = Outcome::of("modulus", "Rod 7");
    let mut table = long_table();
    table.columns.rotate_left(1); // rows in no order: the first are shown
    let Some(Cells::Validity { valid, kinds, .. }) = table
        .columns
        .iter_mut()
        .map(|column| &mut column.cells)
        .find(|cells| matches!(cells, Cells::Validity { .. }))
    else {
        panic!("no verdicts")
    };
    valid[2] = false;
    kinds[2] = vec![
        "wavelength above five lengths",
        "error of E' above its limit",
    ];
    table
        .columns
        .push(Column::words("place", vec!["here".to_owned(); 1000]));
    table.columns.rotate_right(1);
    outcome.tables = vec![table];
    let page = page(&outcome);
    assert!(page.contains("<td class=\"short\">✗ a b</td>"), "{page}");
    let legend =
        "<b>a</b> wavelength above five lengths; <b>b</b> error of E&#x27; above its limit.";
    assert!(page.contains(legend), "{page}");
    assert!(page.contains("12 are shown, the first"), "{page}");
}

#[test]
fn the_first_figure_and_what_the_test_is_about_stand_before_the_quantities() {
    let mut outcome = Outcome::of("modulus", "Rod 7");
    let figure = |title: &str| Figure::new("a", title, vec![line(Role::First, "curve")]);
    outcome.figures = vec![figure("The answer"), figure("The records")];
    let quantity = Quantity::of("modulus", "Pa", 2.6123e9, "identified");
    outcome.quantities = vec![quantity.with_error(1.4e6)];
    outcome.settings = vec![Setting {
        name: "about.operator".into(),
        value: "S. Germain".into(),
        by_default: false,
    }];
    let page = page(&outcome);
    let at = |text: &str| {
        page.find(text)
            .unwrap_or_else(|| panic!("{text} in {page}"))
    };
    assert!(at("<dt>operator</dt><dd>S. Germain</dd>") < at("<h3>The answer</h3>"));
    assert!(at("<h3>The answer</h3>") < at("2.6123 ± 0.0014</td><td>GPa"));
    assert!(at("2.6123 ± 0.0014") < at("<h3>The records</h3>"));
    assert!(!page.contains("id=\"settings\""), "{page}");
}

#[test]
fn only_the_script_of_the_page_may_run() {
    let mut outcome = Outcome::of("modulus", "Rod 7");
    outcome.figures = vec![Figure::new("a", "", vec![line(Role::First, "curve")])];
    let page = page(&outcome);
    let nonce = "0123456789abcdef".repeat(4);
    assert!(
        page.contains(&format!("script-src 'nonce-{nonce}'")),
        "{page}"
    );
    assert_eq!(
        page.matches(&format!("<script nonce=\"{nonce}\">")).count(),
        1
    );
    assert!(page.contains("default-src 'none'"), "{page}");
}

#[test]
fn r19_the_page_names_its_sheet_with_the_hash_and_the_date_of_its_inputs() {
    let page = page(&Outcome::of("force", "no files but the sheet"));
    let hash = "0123456789abcdef".repeat(4);
    assert!(page.contains(&format!(
        "<code>rod.ron</code>, SHA-256 <code class=\"hash\">{hash}</code>"
    )));
    assert!(page.contains("inputs last changed 2026-11-22 12:24:59 UTC"));
}

#[test]
fn the_page_has_the_colours_and_dashes_of_the_files() {
    let style = include_str!("style.css");
    let roles = (0..5).map(Role::of_series).chain([Role::Reference]);
    for (index, role) in roles.enumerate() {
        let svg = svg_of(&Figure::new("a", "", vec![line(role, "curve")]));
        // the first match is the curve in the legend
        let attribute = |name: &str| svg.split_once(name)?.1.split('"').next();
        let color = attribute("stroke=\"").unwrap();
        let color = format!("--s{index}: {color};");
        // the colour is defined once for screens and once for paper
        assert_eq!(style.matches(&color).count(), 2, "{color}");
        if let Some(dash) = attribute("stroke-dasharray=\"") {
            let dash = format!(".l.s{index} {{ stroke-dasharray: {dash};");
            assert!(style.contains(&dash), "{dash}");
        }
    }
}
