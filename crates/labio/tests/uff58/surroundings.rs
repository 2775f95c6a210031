//! Data sets of units and nodes in addition to functions, in a file as pyuff 2.5.8 writes it.

use labio::Dimension;
use labio::format::uff58::{POSITION, REFERENCE_POSITION, UNITS};

use super::*;

const BY_PYUFF: &str = "    -1
   164
        10           mm/newton         1
   1.0000000000000000D+03   1.0000000000000000D+00   1.0000000000000000D+00
   2.7314999999999998D+02
    -1
    -1
    15
         1         0         0         0  0.00000E+00  0.00000E+00  0.00000E+00
         7         0         0         0  2.50500E+02 -1.22500E+01  4.00000E+00
    -1
    -1
    58
FRF
NONE
NONE
NONE
NONE
    4         0    0         0       NONE         7   1       NONE         1   1
         6         3         1  0.00000e+00  1.00000e+00  0.00000e+00
        18    0    0    0 NONE                 NONE
        12    0    0    0 NONE                 NONE
        13    0    0    0 NONE                 NONE
         0    0    0    0 NONE                 NONE
   1.00000000000e+00   2.00000000000e+00   3.00000000000e+00  -4.00000000000e+00
   0.00000000000e+00   5.50000000000e+00
    -1
";

#[test]
fn units_and_nodes_complete_a_function() {
    let contents = strict(BY_PYUFF.as_bytes()).unwrap();
    assert_eq!(property(&contents.properties, UNITS), Some("10 mm/newton"));
    assert_eq!(property(&contents.properties, SKIPPED), None);
    let series = &contents.series[0];
    // mm/s² over N
    let unit = series.ordinate_axis.unit.as_ref().unwrap();
    assert!((unit.scale() / 1e-3 - 1.0).abs() < 1e-12, "{unit:?}");
    let by_mass = Dimension {
        mass: -1,
        ..Dimension::default()
    };
    assert_eq!(unit.dimension(), by_mass);
    assert_eq!(
        property(&series.properties, POSITION),
        Some("0.2505 -0.01225 0.004 m")
    );
    assert_eq!(
        property(&series.properties, REFERENCE_POSITION),
        Some("0 0 0 m")
    );

    // the data sets of units and nodes follow the function, and the function has no denominator
    let (before, functions) = BY_PYUFF.split_at(BY_PYUFF.find("    -1\n    58").unwrap());
    let turned = format!("{functions}{before}").replace("        13 ", "         0 ");
    let contents = strict(turned.as_bytes()).unwrap();
    let unit = contents.series[0].ordinate_axis.unit.as_ref().unwrap();
    assert_eq!(unit.dimension().time, -2);
    assert_eq!(unit.dimension().mass, 0);
}

#[test]
fn units_that_contradict_or_are_stated_are_not_replaced() {
    let unit = |text: &str| {
        let contents = strict(text.as_bytes()).unwrap();
        contents.series[0].ordinate_axis.unit.clone()
    };
    // the unit is a millimetre, but the factor is that of a metre
    assert!(unit(&BY_PYUFF.replace("1.0000000000000000D+03", "1.0000000000000000D+00")).is_none());
    // a unit system defined by the user
    assert!(unit(&BY_PYUFF.replace("        10  ", "         9  ")).is_none());
    // the function itself has texts of units
    let stated = BY_PYUFF
        .replace(
            "        12    0    0    0 NONE                 NONE",
            "        12    0    0    0 NONE                 g",
        )
        .replace(
            "        13    0    0    0 NONE                 NONE",
            "        13    0    0    0 NONE                 kN",
        );
    assert!((unit(&stated).unwrap().scale() / 9.80665e-3 - 1.0).abs() < 1e-12);
    // nodes without units
    let (_, nodes) = BY_PYUFF.split_at(BY_PYUFF.find("    -1\n    15").unwrap());
    let contents = strict(nodes.as_bytes()).unwrap();
    assert_eq!(
        property(&contents.series[0].properties, POSITION),
        Some("250.5 -12.25 4")
    );
    assert!(contents.series[0].ordinate_axis.unit.is_none());
}

#[test]
fn units_and_nodes_of_another_layout_are_listed_and_cost_no_function() {
    for (broken, listed) in [
        (BY_PYUFF.replace("        10  ", "       ten  "), "164"),
        (
            BY_PYUFF.replace("1.0000000000000000D+03", "0.0000000000000000D+00"),
            "164",
        ),
        (BY_PYUFF.replace("2.50500E+02", "2.505zzE+02"), "15"),
    ] {
        let contents = strict(broken.as_bytes()).unwrap();
        assert_eq!(property(&contents.properties, SKIPPED), Some(listed));
        assert_eq!(contents.series.len(), 1);
        let has_units = contents.series[0].ordinate_axis.unit.is_some();
        let position = property(&contents.series[0].properties, POSITION);
        assert_eq!(
            (has_units, position.is_some()),
            (listed == "15", listed == "164")
        );
    }
    let cut = &BY_PYUFF[..BY_PYUFF.find("        10").unwrap()];
    let error = strict(cut.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("data set 164"), "{error}");
}
