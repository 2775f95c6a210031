use super::*;
use crate::{Axis, Greyed, Mark, Panel, Role};

fn panel(marks: Vec<Mark>) -> Panel {
    Panel {
        x: Axis::linear("frequency", "kHz"),
        y: Axis::linear("E'", "GPa"),
        marks,
        greyed: vec![],
        equal_axes: false,
    }
}

fn figure(panels: Vec<Panel>) -> Figure {
    Figure {
        name: "modulus".into(),
        title: "Modulus of <a & b>".into(),
        caption: String::new(),
        panels,
    }
}

fn line(x: Vec<f64>, y: Vec<f64>) -> Mark {
    Mark::Line {
        name: "storage".into(),
        role: Role::First,
        x,
        y,
    }
}

/// Returns the points of the first curve in the colour of the first role, without the curve in the
/// legend.
fn drawn(svg: &str) -> Vec<Vec<(f64, f64)>> {
    svg.split("<path d=\"M")
        .skip(1)
        .filter(|path| path.contains("stroke=\"#0072b2\" stroke-width=\"1.6\""))
        .skip(1)
        .map(|path| {
            let numbers: Vec<f64> = path[..path.find('"').unwrap()]
                .split(' ')
                .map(|number| number.parse().unwrap())
                .collect();
            numbers.chunks(2).map(|pair| (pair[0], pair[1])).collect()
        })
        .collect()
}

#[test]
fn axes_have_their_label_and_unit_and_text_is_text_that_cannot_be_markup() {
    let svg = svg_of(&figure(vec![panel(vec![line(
        vec![0.0, 1.0],
        vec![2.0, 3.0],
    )])]));
    assert!(svg.contains(">frequency, kHz</text>"), "{svg}");
    assert!(svg.contains("GPa</text>"), "{svg}");
    assert!(svg.contains("Modulus of &lt;a &amp; b&gt;"), "{svg}");
    assert!(svg.starts_with("<svg viewBox=\"0 0 760 "), "{svg}");
}

#[test]
fn none_interrupts_a_curve_and_a_sample_alone_is_a_dot() {
    let nan = f64::NAN;
    let svg = svg_of(&figure(vec![panel(vec![line(
        vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        vec![1.0, 2.0, nan, 3.0, nan, 1.0, 2.0],
    )])]));
    assert_eq!(drawn(&svg).len(), 2, "{svg}");
    assert_eq!(svg.matches("<circle").count(), 1, "{svg}");
    assert!(!svg.contains("NaN"), "{svg}");
}

#[test]
fn decades_are_of_one_length_and_what_is_not_positive_is_left_out() {
    let mut panel = panel(vec![line(vec![1.0, 10.0, 100.0, -1.0], vec![1e-12; 4])]);
    panel.x.scale = crate::Scale::Logarithmic;
    panel.y.scale = crate::Scale::Logarithmic;
    let curves = drawn(&svg_of(&figure(vec![panel])));
    assert_eq!(curves.len(), 1);
    let [(a, y), (b, _), (c, _)] = curves[0][..] else {
        panic!("{curves:?}");
    };
    assert!(((b - a) - (c - b)).abs() < 0.21, "{a} {b} {c}"); // tenths of pixels
    assert!(y.is_finite());
}

#[test]
fn a_circle_on_equal_axes_is_round() {
    let angles: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.063).collect();
    let mut panel = panel(vec![line(
        angles.iter().map(|a| 5.0 + 3.0 * a.cos()).collect(),
        angles.iter().map(|a| 3.0 * a.sin()).collect(),
    )]);
    panel.equal_axes = true;
    let curves = drawn(&svg_of(&figure(vec![panel])));
    let extent = |pick: fn(&(f64, f64)) -> f64| {
        let all: Vec<f64> = curves[0].iter().map(pick).collect();
        all.iter().copied().fold(f64::MIN, f64::max) - all.iter().copied().fold(f64::MAX, f64::min)
    };
    let (width, height) = (extent(|p| p.0), extent(|p| p.1));
    assert!((width - height).abs() < 1.0, "{width} by {height} pixels");
    assert!(width > 250.0, "{width} pixels of {EDGE}");
}

#[test]
fn the_same_figure_gives_the_same_bytes_and_its_own_clip_names() {
    let figure = figure(vec![
        panel(vec![line(vec![0.0, 1.0], vec![2.0, 3.0])]),
        panel(vec![line(vec![0.0, 1.0], vec![2.0, 3.0])]),
    ]);
    let svg = svg_of(&figure);
    assert_eq!(svg, svg_of(&figure));
    assert!(
        svg.contains("id=\"modulus-1\"") && svg.contains("id=\"modulus-2\""),
        "{svg}"
    );
}

#[test]
fn names_of_lines_that_are_close_stand_in_rows_and_no_line_runs_through_one() {
    let at = |name: &str, x: f64| Mark::At {
        name: name.into(),
        x,
    };
    let svg = svg_of(&figure(vec![panel(vec![
        line(vec![0.0, 10.0], vec![0.0, 1.0]),
        at("trigger of the first hit", 5.0),
        at("end of contact", 5.2),
        at("window", 9.9),
    ])]));
    let place = |name: &str| {
        let before = &svg[..svg.find(&format!(">{name}</text>")).unwrap()];
        let text = &before[before.rfind("<text").unwrap()..];
        let number = |key: &str| -> f64 {
            let from = text.find(key).unwrap() + key.len();
            text[from..].split('"').next().unwrap().parse().unwrap()
        };
        (number(" x=\""), number(" y=\""))
    };
    let (trigger, end, window) = (
        place("trigger of the first hit"),
        place("end of contact"),
        place("window"),
    );
    assert!(trigger.1 < end.1 - 10.0, "{trigger:?} {end:?}");
    assert!((window.1 - end.1).abs() < 0.1, "{window:?} {end:?}");
    assert!(window.0 + 30.0 < WIDTH, "{window:?}");
}

#[test]
fn what_is_greyed_to_infinity_ends_at_the_axes() {
    let mut panel = panel(vec![line(vec![0.0, 10.0], vec![0.0, 1.0])]);
    panel.greyed = vec![Greyed {
        from: f64::NEG_INFINITY,
        to: 2.0,
        because: "below the first line".into(),
    }];
    let svg = svg_of(&figure(vec![panel]));
    assert!(svg.contains(">below the first line</text>"), "{svg}");
    let grey = svg
        .split("<rect ")
        .find(|rect| rect.contains("#808080") && rect.contains("230"));
    assert!(grey.is_some_and(|rect| !rect.contains("inf")), "{grey:?}");
}
