use num_complex::Complex64;

use super::*;
use crate::Abscissa;
use crate::format::mat5::RATE_SOURCE;
use crate::format::{read_bytes, recognise};

const HEADER: &str = "# Created by Octave 8.4.0, Sat Nov 28 12:00:00 2026 UTC <user@host>\n";

fn read(text: &str) -> Contents {
    read_bytes(format!("{HEADER}{text}").as_bytes()).unwrap()
}

fn refused(text: &str) -> String {
    read_bytes(format!("{HEADER}{text}").as_bytes())
        .unwrap_err()
        .to_string()
}

fn reals(contents: &Contents) -> Vec<(&str, &[f64])> {
    let series = contents.series.iter();
    series
        .map(|series| match &series.ordinate {
            Ordinate::Real(values) => (series.name.as_str(), values.as_slice()),
            Ordinate::Complex(_) => panic!("{} is complex", series.name),
        })
        .collect()
}

fn properties(contents: &Contents) -> Vec<(&str, &str)> {
    let pairs = contents.properties.iter();
    pairs.map(|(key, value)| (&**key, &**value)).collect()
}

#[test]
fn a_workspace_is_read() {
    let contents = read(
        "# name: fs\n# type: scalar\n51200\n\n\n\
         # name: a\n# type: matrix\n# rows: 3\n# columns: 2\n 1 2\n 3 4.5\n 5 -6e-3\n\n\n\
         # name: row\n# type: global matrix\n# rows: 1\n# columns: 3\n 1 NA Inf\n\n\n\
         # name: who\n# type: sq_string\n# elements: 2\n# length: 2\nab\n# length: 2\ncd\n\n\n\
         # name: none\n# type: matrix\n# rows: 0\n# columns: 0\n\n\n\
         # name: on\n# type: bool\n1\n\n\n",
    );
    let [(_, first), (_, second), (name, row)] = reals(&contents)[..] else {
        panic!("{:?}", contents.series);
    };
    assert_eq!(
        (first, second),
        (&[1.0, 3.0, 5.0][..], &[2.0, 4.5, -6e-3][..])
    );
    assert_eq!((name, row[0], row[2]), ("row", 1.0, f64::INFINITY));
    assert!(row[1].is_nan());
    assert_eq!(contents.series[1].name, "a(:,2)");
    assert_eq!(
        properties(&contents)[1..],
        [
            ("fs", "51200"),
            ("who(1,:)", "ab"),
            ("who(2,:)", "cd"),
            ("none", "empty, 0x0 double"),
            ("on", "1"),
            (RATE_SOURCE, "variable `fs`, in Hz")
        ]
    );
    let column = &contents.series[1];
    let times = Abscissa::Even {
        start: 0.0,
        step: 1.0 / 51200.0,
    };
    assert_eq!(
        (&column.abscissa, &*column.abscissa_axis.unit_text),
        (&times, "s")
    );
    assert!(
        contents.properties[0]
            .1
            .starts_with("Created by Octave 8.4.0")
    );
}

#[test]
fn complex_numbers_arrays_of_more_axes_and_integers_are_read() {
    let contents = read(
        "# name: z\n# type: complex matrix\n# rows: 1\n# columns: 2\n (1,-2) (0.5, 3e2)\n\n\n\
         # name: n\n# type: int32 matrix\n# ndims: 3\n 2 1 2\n  1\n  2\n  3\n  4\n\n\n",
    );
    let complex = vec![Complex64::new(1.0, -2.0), Complex64::new(0.5, 300.0)];
    assert_eq!(contents.series[0].ordinate, Ordinate::Complex(complex));
    let [_, first, second] = &contents.series[..] else {
        panic!("{:?}", contents.series);
    };
    assert_eq!((&*first.name, &*second.name), ("n(:,1,1)", "n(:,1,2)"));
    assert_eq!(first.ordinate, Ordinate::Real(vec![1.0, 2.0]));
    assert_eq!(second.ordinate, Ordinate::Real(vec![3.0, 4.0]));
    assert_eq!(first.properties, [("class".to_owned(), "int32".to_owned())]);
    let text = "# name: n\n# type: int64 scalar\n9007199254740993\n";
    assert!(
        refused(text).contains("9007199254740993"),
        "{}",
        refused(text)
    );
}

#[test]
fn a_range_has_its_values_up_to_the_limit() {
    let contents = read(
        "# name: t\n# type: range\n# base, limit, increment\n0 0.3 0.1\n\n\n\
         # name: c\n# type: double_range\n# base, length, increment, reverse\n2 3 0 0\n\n\n",
    );
    let [(_, t), (_, c)] = reals(&contents)[..] else {
        panic!("{:?}", contents.series);
    };
    // 0.3 is 2.9999999999999996 steps of 0.1
    assert_eq!(t.len(), 4);
    assert_eq!(c, [2.0, 2.0, 2.0]);
    let long = "# name: t\n# type: range\n# base, limit, increment\n0 1e12 1\n";
    assert!(
        refused(long).contains("bytes of memory"),
        "{}",
        refused(long)
    );
    let reversed = "# name: t\n# type: double_range\n# base, limit, increment, reverse\n0 3 1 1\n";
    assert!(refused(reversed).contains("not reversed"));
}

#[test]
fn structures_and_cells_have_the_names_of_their_parts() {
    let contents = read(
        "# name: s\n# type: scalar struct\n# ndims: 2\n 1 1\n# length: 2\n\
         # name: length\n# type: scalar\n0.8\n\n\n\
         # name: hits\n# type: cell\n# rows: 1\n# columns: 2\n\
         # name: <cell-element>\n# type: matrix\n# rows: 1\n# columns: 2\n 1 2\n\n\n\
         # name: <cell-element>\n# type: matrix\n# rows: 1\n# columns: 2\n 3 4\n\n\n\n\n\n\n\
         # name: p\n# type: struct\n# ndims: 2\n 1 2\n# length: 1\n\
         # name: mass\n# type: cell\n# rows: 1\n# columns: 2\n\
         # name: <cell-element>\n# type: scalar\n1\n\n\n\
         # name: <cell-element>\n# type: scalar\n2\n\n\n\n\n\n\n",
    );
    assert_eq!(
        reals(&contents),
        [("s.hits{1}", &[1.0, 2.0][..]), ("s.hits{2}", &[3.0, 4.0])]
    );
    assert_eq!(
        properties(&contents)[1..],
        [("s.length", "0.8"), ("p(1).mass", "1"), ("p(2).mass", "2")]
    );
}

#[test]
fn a_text_of_several_lines_ends_by_its_length() {
    let blank = read("# name: note\n# type: string\n# elements: 1\n# length: 2\n\nx\n");
    assert_eq!(properties(&blank)[1..], [("note", "\nx")]);
    let contents = read(
        "# name: note\n# type: string\n# elements: 1\n# length: 13\nfirst\n\n# last\n\n\n# name: b\n# type: scalar\n1\n",
    );
    assert_eq!(
        properties(&contents)[1..],
        [("note", "first\n\n# last"), ("b", "1")]
    );
}

#[test]
fn damage_is_named_and_passed_over_by_a_tolerant_reading() {
    let whole = "# name: a\n# type: matrix\n# rows: 2\n# columns: 2\n 1 2\n 3 4\n\n\n";
    for (text, said) in [
        (
            whole.replace(" 3 4", " 3 x"),
            "line 7: values of `a` is `x`, expected 4 numbers, of which 2 were read",
        ),
        (
            whole.replace(" 3 4", " 3 4 5"),
            "line 7: values of `a` is `3 4 5`",
        ),
        (
            whole.replace("\n 3 4", ""),
            "expected 4 numbers, of which 2 were read",
        ),
        (
            whole.replace("columns: 2", "columns: two"),
            "line 5: columns is `two`, expected a count",
        ),
        (
            whole.replace("matrix", "sparse matrix"),
            "type of `a` is `sparse matrix`",
        ),
        (
            whole.replace("# rows: 2", "# rows: 18446744073709551615"),
            "lengths whose product does not overflow",
        ),
    ] {
        let found = refused(&text);
        assert!(found.contains(said), "{found}");
        let bytes = format!("{HEADER}{text}# name: b\n# type: scalar\n1\n");
        let contents = OctaveText
            .read(bytes.as_bytes(), Strictness::Tolerant)
            .unwrap();
        assert_eq!(contents.defects.len(), 1, "{said}: {:?}", contents.defects);
        assert_eq!(properties(&contents)[1..], [("b", "1")], "{said}");
    }
    // fields that are announced but missing must also end a tolerant reading
    let text = "# name: s\n# type: scalar struct\n# length: 18446744073709551615\n# name: b\n# type: scalar\n1\n";
    let contents = OctaveText
        .read(format!("{HEADER}{text}").as_bytes(), Strictness::Tolerant)
        .unwrap();
    assert_eq!(properties(&contents)[1..], [("s.b", "1")]);
    assert_eq!(contents.defects.len(), 1);
    // more rows than announced
    let found = refused(&whole.replace(" 3 4\n", " 3 4\n 5 6\n"));
    assert!(
        found.contains("line 8: line is ` 5 6`, expected `# name: ...`"),
        "{found}"
    );
    // fields of a structure keep their names
    let text = "# name: s\n# type: scalar struct\n# length: 2\n# name: a\n# type: object\n\n# name: b\n# type: scalar\n1\n";
    let contents = OctaveText
        .read(format!("{HEADER}{text}").as_bytes(), Strictness::Tolerant)
        .unwrap();
    assert_eq!(properties(&contents)[1..], [("s.b", "1")]);
}

#[test]
fn files_of_other_programs_are_recognised_and_tables_are_not() {
    let is_octave = |text: &str| recognise(text.as_bytes()).is_some_and(|r| r.name() == FORMAT);
    assert!(is_octave(
        "# name: x\n# type: matrix\n# rows: 1\n# columns: 1\n 1\n"
    ));
    assert!(is_octave(
        "\n% made by a logger\r\n% name: x\r\n% type: scalar\r\n1\r\n"
    ));
    assert!(!is_octave("# name: pendulum\n# rate: 5\n1,2\n3,4\n"));
    assert!(!is_octave("1,2\n# name: x\n# type: scalar\n"));
}
