use rodfigure::{Panel, Role, svg_of};

use super::*;

/// A panel with a line, and with markup for labels.
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
    // the script, the data of one figure, and nothing else
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
    outcome.doubt("the check of polarity fails");
    outcome.doubt("the check of passivity fails");
    let page = page(&outcome);
    assert!(
        page.contains("<p class=\"standing in-doubt\">in doubt</p>"),
        "{page}"
    );
    for check in ["polarity", "passivity"] {
        let said = format!("<strong>in doubt:</strong> the check of {check} fails");
        assert!(page.contains(&said), "{page}");
    }
}

#[test]
fn a_long_table_is_folded_and_says_what_it_leaves_to_the_file() {
    let mut outcome = Outcome::of("modulus", "Rod 7");
    let lines = 1000_u32;
    outcome.tables = vec![crate::outcome::Table {
        name: "modulus".into(),
        title: "Modulus".into(),
        columns: vec![crate::outcome::Column::numbers(
            "frequency",
            "Hz",
            (0..lines).map(|i| 125.0 * f64::from(i)).collect(),
        )],
    }];
    let page = page(&outcome);
    assert!(page.contains("<summary>Rows 13 to 400</summary>"), "{page}");
    assert!(
        page.contains("1000 rows in <a href=\"modulus.csv\">"),
        "{page}"
    );
    assert!(page.contains("600 are not shown here"), "{page}");
}

#[test]
fn r19_the_page_names_its_sheet_with_the_hash_and_the_date_of_its_inputs() {
    let page = page(&Outcome::of("force", "no files but the sheet"));
    let hash = "0123456789abcdef".repeat(4);
    assert!(page.contains(&format!(
        "<code>rod.ron</code>, SHA-256 <code class=\"hash\">{hash}</code>"
    )));
    assert!(page.contains("inputs of 2026-11-22 12:24:59 UTC"));
}

#[test]
fn the_page_has_the_colours_and_dashes_of_the_files() {
    let style = include_str!("style.css");
    let roles = (0..5).map(Role::of_series).chain([Role::Reference]);
    for (index, role) in roles.enumerate() {
        let svg = svg_of(&Figure::new("a", "", vec![line(role, "curve")]));
        // the sample of the legend comes first
        let attribute = |name: &str| svg.split_once(name)?.1.split('"').next();
        let color = attribute("stroke=\"").unwrap();
        let color = format!("--s{index}: {color};");
        // on screens and on paper
        assert_eq!(style.matches(&color).count(), 2, "{color}");
        if let Some(dash) = attribute("stroke-dasharray=\"") {
            let dash = format!(".l.s{index} {{ stroke-dasharray: {dash};");
            assert!(style.contains(&dash), "{dash}");
        }
    }
}
