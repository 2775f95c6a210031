//! Units compared with a table of their definitions, and random compounds compared with the product
//! of their factors.

use labio::{Dimension, Quantity, Unit};
use proptest::prelude::*;

/// Text, exponents of m, kg, s, A, K, and the SI value of one, from the definitions: 1 in = 0.0254
/// m and 1 ft = 0.3048 m (1959), 1 lb = 0.45359237 kg, standard gravity 9.80665 m/s² (1901), 1 bar
/// = 1e5 Pa.
#[rustfmt::skip]
pub(crate) const TABLE: &[(&str, [i8; 5], f64)] = &[
    // psi: 4.4482216152605 / 0.00064516, to twenty digits
    ("V", [2, 1, -3, -1, 0], 1.0), ("mV", [2, 1, -3, -1, 0], 0.001), ("uV", [2, 1, -3, -1, 0], 0.000001),
    ("\u{b5}V", [2, 1, -3, -1, 0], 0.000001), ("\u{3bc}V", [2, 1, -3, -1, 0], 0.000001), ("A", [0, 0, 0, 1, 0], 1.0),
    ("mA", [0, 0, 0, 1, 0], 0.001), ("C", [0, 0, 1, 1, 0], 1.0), ("pC", [0, 0, 1, 1, 0], 0.000000000001), ("N", [1, 1, -2, 0, 0], 1.0),
    ("kN", [1, 1, -2, 0, 0], 1000.0), ("lbf", [1, 1, -2, 0, 0], 4.4482216152605), ("kgf", [1, 1, -2, 0, 0], 9.80665),
    ("g", [1, 0, -2, 0, 0], 9.80665), ("gn", [1, 0, -2, 0, 0], 9.80665), ("mg", [1, 0, -2, 0, 0], 0.00980665),
    ("gram", [0, 1, 0, 0, 0], 0.001), ("kg", [0, 1, 0, 0, 0], 1.0), ("lbm", [0, 1, 0, 0, 0], 0.45359237),
    ("m/s^2", [1, 0, -2, 0, 0], 1.0), ("m/s²", [1, 0, -2, 0, 0], 1.0), ("m/s**2", [1, 0, -2, 0, 0], 1.0), ("m/s2", [1, 0, -2, 0, 0], 1.0),
    ("m s^-2", [1, 0, -2, 0, 0], 1.0), ("m·s⁻²", [1, 0, -2, 0, 0], 1.0), ("m.s-2", [1, 0, -2, 0, 0], 1.0),
    ("[m/s^2]", [1, 0, -2, 0, 0], 1.0), (" m / s ^2 ", [1, 0, -2, 0, 0], 1.0), ("m/s/s", [1, 0, -2, 0, 0], 1.0),
    ("m/s", [1, 0, -1, 0, 0], 1.0), ("mm/s", [1, 0, -1, 0, 0], 0.001), ("in/s", [1, 0, -1, 0, 0], 0.0254), ("m", [1, 0, 0, 0, 0], 1.0),
    ("mm", [1, 0, 0, 0, 0], 0.001), ("um", [1, 0, 0, 0, 0], 0.000001), ("\u{b5}m", [1, 0, 0, 0, 0], 0.000001),
    ("\u{3bc}m", [1, 0, 0, 0, 0], 0.000001), ("cm", [1, 0, 0, 0, 0], 0.01), ("in", [1, 0, 0, 0, 0], 0.0254),
    ("ft", [1, 0, 0, 0, 0], 0.3048), ("Pa", [-1, 1, -2, 0, 0], 1.0), ("kPa", [-1, 1, -2, 0, 0], 1000.0),
    ("MPa", [-1, 1, -2, 0, 0], 1000000.0), ("GPa", [-1, 1, -2, 0, 0], 1000000000.0), ("bar", [-1, 1, -2, 0, 0], 100000.0),
    ("mbar", [-1, 1, -2, 0, 0], 100.0), ("psi", [-1, 1, -2, 0, 0], 6894.7572931683613367),
    ("lbf/in^2", [-1, 1, -2, 0, 0], 6894.7572931683613367), ("N/mm²", [-1, 1, -2, 0, 0], 1000000.0), ("strain", [0; 5], 1.0),
    ("m/m", [0; 5], 1.0), ("microstrain", [0; 5], 0.000001), ("ue", [0; 5], 0.000001), ("\u{b5}ε", [0; 5], 0.000001),
    ("\u{3bc}ε", [0; 5], 0.000001), ("um/m", [0; 5], 0.000001), ("\u{b5}m/m", [0; 5], 0.000001), ("%", [0; 5], 0.01), ("1", [0; 5], 1.0),
    ("-", [0; 5], 1.0), ("dimensionless", [0; 5], 1.0), ("s", [0, 0, 1, 0, 0], 1.0), ("ms", [0, 0, 1, 0, 0], 0.001),
    ("us", [0, 0, 1, 0, 0], 0.000001), ("min", [0, 0, 1, 0, 0], 60.0), ("Hz", [0, 0, -1, 0, 0], 1.0), ("kHz", [0, 0, -1, 0, 0], 1000.0),
    ("1/s", [0, 0, -1, 0, 0], 1.0), ("rad", [0; 5], 1.0), ("rad/s", [0, 0, -1, 0, 0], 1.0), ("deg", [0; 5], 0.017453292519943295769),
    ("K", [0, 0, 0, 0, 1], 1.0), ("mV/g", [1, 1, -1, -1, 0], 0.00010197162129779283), ("mV/(m/s^2)", [1, 1, -1, -1, 0], 0.001),
    ("V/(m/s²)", [1, 1, -1, -1, 0], 1.0), ("pC/N", [-1, -1, 3, 1, 0], 0.000000000001), ("pC/g", [-1, 0, 3, 1, 0], 1.0197162129779283e-13),
    ("mV/N", [1, 0, -1, -1, 0], 0.001), ("mV/lbf", [1, 0, -1, -1, 0], 0.00022480894309971048), ("mV/V", [0; 5], 0.001),
    ("mV/pC", [2, 1, -4, -2, 0], 1000000000.0), ("N/V", [-1, 0, 1, 1, 0], 1.0), ("g^2/Hz", [2, 0, -3, 0, 0], 96.1703842225),
    ("g²/Hz", [2, 0, -3, 0, 0], 96.1703842225), ("(m/s^2)/N", [0, -1, 0, 0, 0], 1.0), ("m/s^2/N", [0, -1, 0, 0, 0], 1.0),
    ("m/(N s)", [0, -1, 1, 0, 0], 1.0), ("m/(N*s)", [0, -1, 1, 0, 0], 1.0), ("(m/s)^2", [2, 0, -2, 0, 0], 1.0),
    ("(1/N)*(m/s²)", [0, -1, 0, 0, 0], 1.0), ("1/MPa", [1, -1, 2, 0, 0], 0.000001), ("Volts", [2, 1, -3, -1, 0], 1.0),
    ("daN", [1, 1, -2, 0, 0], 10.0), ("hPa", [-1, 1, -2, 0, 0], 100.0), ("dm", [1, 0, 0, 0, 0], 0.1), ("Newton", [1, 1, -2, 0, 0], 1.0),
    ("kNewton", [1, 1, -2, 0, 0], 1000.0), ("Pascal", [-1, 1, -2, 0, 0], 1.0), ("daN/mm2", [-1, 1, -2, 0, 0], 10000000.0),
    ("Newtons", [1, 1, -2, 0, 0], 1.0), ("N.m", [2, 1, -2, 0, 0], 1.0),
];

pub(crate) fn dimension([length, mass, time, current, temperature]: [i8; 5]) -> Dimension {
    Dimension {
        length,
        mass,
        time,
        current,
        temperature,
    }
}

#[test]
fn g_is_the_gram_where_a_mass_is_asked_for() {
    let of = |text: &str, like: &str| {
        let expected = Unit::parse(like).unwrap().dimension();
        let unit = Unit::parse_as(text, expected).unwrap();
        (unit.to_si(1.0), unit.dimension() == expected)
    };
    // tolerance: one rounding error for each ratio
    for (text, like, value) in [
        ("g", "kg", 1e-3),
        ("mg", "kg", 1e-6),
        ("g/cm3", "kg/m3", 1000.0),
        ("g/cm^3", "kg/m3", 1000.0),
        ("g/cc", "kg/m3", 1000.0),
        ("g/ml", "kg/m3", 1000.0),
        ("kg/L", "kg/m3", 1000.0),
        // 0.45359237/0.0254^3
        ("lbm/in3", "kg/m3", 27_679.904_710_203_12),
        ("g/s", "kg/s", 1e-3),
        ("g", "m/s2", 9.80665),
        ("mV/g", "V s2/m", 1e-3 / 9.80665),
        ("gn", "m/s2", 9.80665),
        ("kg", "kg", 1.0),
    ] {
        let (found, fits) = of(text, like);
        assert!(
            fits && (found / value - 1.0).abs() < 1e-15,
            "{text} as {like}: {found}"
        );
    }
    // where neither meaning of `g` has the expected dimension, it is standard gravity
    assert!(!of("g", "m").1 && !of("gn", "kg").1);
    assert_eq!(of("g", "m").0, 9.80665);
}

#[test]
fn what_is_no_unit_is_refused_with_the_part_that_is_not_understood() {
    let refusals = [
        "",
        "Volt/parsec",
        "lb",
        "dB",
        "m/s^",
        "m/s^x",
        "m^2.5",
        "m^22",
        "(m/s",
        "m/s)",
        "m//s",
        "m/N s",
        "10 mV",
        "1.5",
        "mV/degC",
        "degF^2",
        "N,m",
        "m s°C",
        "((((((((((m))))))))))",
        "(fs^9)^9",
        "(m^9)^9 m^9 (m^9)^9",
        "measured at the end of the rod with the small hammer and the white tip",
    ]
    .map(|text| Unit::parse(text).unwrap_err().to_string())
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    `` is not a known unit: `` ends where a symbol is expected
    `Volt/parsec` is not a known unit: `parsec` is not among the known symbols
    `lb` is not a known unit: `lb` may be a mass or a force, expected lbm or lbf
    `dB` is not a known unit: `dB` is a logarithm, not a unit
    `m/s^` is not a known unit: `` occurs where an exponent is expected
    `m/s^x` is not a known unit: `x` occurs where an exponent is expected
    `m^2.5` is not a known unit: `.` makes an exponent that is not a whole number of one digit
    `m^22` is not a known unit: `2` makes an exponent that is not a whole number of one digit
    `(m/s` is not a known unit: `(` is not closed
    `m/s)` is not a known unit: `)` does not belong there
    `m//s` is not a known unit: `/` occurs where a symbol is expected
    `m/N s` is not a known unit: `/` needs brackets around the product after it
    `10 mV` is not a known unit: `0` makes a factor other than 1, which a unit cannot have
    `1.5` is not a known unit: `.` makes a factor other than 1, which a unit cannot have
    `mV/degC` is not a known unit: `degC` has a shifted zero and cannot be part of a compound unit
    `degF^2` is not a known unit: `degF` has a shifted zero and cannot be part of a compound unit
    `N,m` is not a known unit: `,` does not belong there
    `m s°C` is not a known unit: `s°C` is not among the known symbols
    `((((((((((m))))))))))` is not a known unit: `(` is nested too deeply
    `(fs^9)^9` is not a known unit: `(fs^9)^9` has a scale beyond the range of numbers
    `(m^9)^9 m^9 (m^9)^9` is not a known unit: `(...)` takes the exponents out of range
    `measured at the end of the rod with the small hammer and the whi` is not a known unit: `measured at the ` begins a text that is longer than any unit
    ");
}

#[test]
fn a_unit_knows_its_channel() {
    let quantity = |text| Unit::parse(text).unwrap().quantity();
    assert_eq!(quantity("g"), Some(Quantity::Acceleration));
    assert_eq!(quantity("lbf"), Some(Quantity::Force));
    assert_eq!(quantity("ue"), Some(Quantity::Strain));
    assert_eq!(quantity("pC"), Some(Quantity::Charge));
    assert_eq!(quantity("mV/g"), None);
}

/// A compound as text, with its dimension and with its value multiplied from its factors.
fn compounds() -> impl Strategy<Value = (String, Dimension, f64)> {
    let leaves: Vec<(&str, [i8; 5], f64)> = TABLE
        .iter()
        .copied()
        .filter(|(text, ..)| text.chars().all(|c| c.is_alphabetic() || c == '\u{b5}'))
        .filter(|(text, ..)| *text != "dimensionless")
        .collect();
    let leaf = proptest::sample::select(leaves)
        .prop_map(|(text, exponents, si)| (text.to_owned(), dimension(exponents), si));
    leaf.prop_recursive(3, 8, 2, |inner| {
        let power = (inner.clone(), -2_i8..=3).prop_map(|((text, d, si), n)| {
            (
                format!("({text})^{n}"),
                d.power(n).unwrap(),
                si.powi(n.into()),
            )
        });
        let pair = (inner.clone(), inner, 0..4).prop_map(|((a, da, sa), (b, db, sb), form)| {
            let quotient = form > 1;
            let text = match form {
                0 => format!("({a}) ({b})"),
                1 => format!("{a}*({b})").replace(&format!("{a}*"), &format!("({a})*")),
                2 => format!("({a})/({b})"),
                _ => format!("({a}) / ({b})"),
            };
            if quotient {
                (text, da.quotient(db).unwrap(), sa / sb)
            } else {
                (text, da.product(db).unwrap(), sa * sb)
            }
        });
        prop_oneof![power, pair]
    })
}

proptest! {
    #[test]
    fn compounds_multiply_out_print_and_convert_back((text, dimension, si) in compounds(), value in -1e6..1e6) {
        prop_assume!(text.chars().count() <= 64);
        let unit = Unit::parse(&text).unwrap();
        prop_assert_eq!(unit.dimension(), dimension);
        // tolerance: at most 64 rounding errors on each side
        prop_assert!((unit.to_si(1.0) / si - 1.0).abs() < 128.0 * f64::EPSILON, "{} against {}", unit.to_si(1.0), si);
        // tolerance: four rounding errors
        prop_assert!((unit.of_si(unit.to_si(value)) - value).abs() <= 4.0 * f64::EPSILON * value.abs());
        prop_assert_eq!(Unit::parse(&unit.to_string()).unwrap(), unit);
    }
}
