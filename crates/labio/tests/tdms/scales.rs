//! Scales that convert raw numbers to quantities.

use super::*;

fn scaled(raw_index: &[u8], properties: &[Vec<u8>], raw: &[u8]) -> Result<Vec<f64>, String> {
    let contains = if raw_index.starts_with(&[0x69, 0x12]) {
        USUAL | DAQMX
    } else {
        USUAL
    };
    let contents = strict(&segment(
        contains,
        &[object("/'g'/'a'", raw_index, properties)],
        raw,
    ));
    contents
        .map(|contents| values(&contents.series[0]).to_vec())
        .map_err(|error| error.to_string())
}

#[test]
fn scales_make_quantities_of_numbers() {
    let raw = i16s(&[1, 2, 3]);
    let linear = |scale: u32, slope: f64, intercept: f64, source: Option<u32>| {
        let mut properties = vec![
            word(&format!("NI_Scale[{scale}]_Scale_Type"), "Linear"),
            real(&format!("NI_Scale[{scale}]_Linear_Slope"), slope),
            real(&format!("NI_Scale[{scale}]_Linear_Y_Intercept"), intercept),
        ];
        properties.extend(
            source.map(|source| index(&format!("NI_Scale[{scale}]_Linear_Input_Source"), source)),
        );
        properties
    };
    let of = |n: u32, parts: &[Vec<Vec<u8>>]| {
        [vec![index("NI_Number_Of_Scales", n)], parts.concat()].concat()
    };

    let of_integers = |properties: &[Vec<u8>]| scaled(&numbers(2, 3), properties, &raw).unwrap();
    let once = of(1, &[linear(0, 2.0, 10.0, None)]);
    assert_eq!(of_integers(&once), [12.0, 14.0, 16.0]);

    let coefficients = |size: Option<u32>| {
        let mut properties = vec![word("NI_Scale[0]_Scale_Type", "Polynomial")];
        properties.extend(
            [10.0, 1.0, 2.0, 3.0]
                .iter()
                .zip(0..)
                .map(|(c, i)| real(&format!("NI_Scale[0]_Polynomial_Coefficients[{i}]"), *c)),
        );
        properties.extend(size.map(|n| index("NI_Scale[0]_Polynomial_Coefficients_Size", n)));
        properties
    };
    for (size, expected) in [
        (None, [16.0, 44.0, 112.0]),
        (Some(4), [16.0, 44.0, 112.0]),
        (Some(3), [13.0, 20.0, 31.0]),
        (Some(0), [0.0; 3]),
    ] {
        assert_eq!(of_integers(&of(1, &[coefficients(size)])), expected);
    }

    // the input of the last scale is the previous scale or the raw numbers
    for (source, expected) in [(1, [21.0, 27.0, 33.0]), (u32::MAX, [6.0, 9.0, 12.0])] {
        let chain = [
            linear(0, 1.0, 1.0, Some(u32::MAX)),
            linear(1, 2.0, 2.0, Some(0)),
            linear(2, 3.0, 3.0, Some(source)),
        ];
        assert_eq!(of_integers(&of(3, &chain)), expected);
    }

    let done = [once, vec![word("NI_Scaling_Status", "scaled")]].concat();
    assert_eq!(of_integers(&done), [1.0, 2.0, 3.0]);
}

#[test]
fn tables_are_read_from_the_values_called_scaled() {
    let table = |name: &str, values: &[f64]| {
        let mut properties = vec![index(
            &format!("NI_Scale[0]_Table_{name}_Size"),
            u32::try_from(values.len()).unwrap(),
        )];
        properties.extend(
            values
                .iter()
                .zip(0..)
                .map(|(v, i)| real(&format!("NI_Scale[0]_Table_{name}[{i}]"), *v)),
        );
        properties
    };
    let of = |from: &[f64], to: &[f64]| {
        let kind = vec![
            index("NI_Number_Of_Scales", 1),
            word("NI_Scale[0]_Scale_Type", "Table"),
        ];
        [
            kind,
            table("Scaled_Values", from),
            table("Pre_Scaled_Values", to),
        ]
        .concat()
    };
    let raw = f64s(&[0.5, 1.0, 1.5, 2.5, 3.0, 3.5]);
    let through = |from: &[f64], to: &[f64]| scaled(&numbers(10, 6), &of(from, to), &raw);
    let expected = [2.0, 2.0, 3.0, 6.0, 8.0, 8.0];
    assert_eq!(
        through(&[1.0, 2.0, 3.0], &[2.0, 4.0, 8.0]).unwrap(),
        expected
    );
    assert_eq!(
        through(&[3.0, 2.0, 1.0], &[8.0, 4.0, 2.0]).unwrap(),
        expected
    );
    assert!(through(&[1.0, 3.0, 2.0], &[2.0, 4.0, 8.0]).is_err());
    assert!(through(&[1.0, 3.0], &[2.0]).is_err());
}

#[test]
fn two_scalers_of_a_channel_are_added_or_subtracted() {
    let raw_index = daqmx(3, &[[5, 0, 0, 0], [4, 0, 4, 1]], &[8]);
    let raw = u32s(&[1, 2, 2, 4, 3, 6]);
    for (kind, expected) in [("Add", [3.0, 6.0, 9.0]), ("Subtract", [1.0, 2.0, 3.0])] {
        let properties = [
            index("NI_Number_Of_Scales", 3),
            word("NI_Scale[2]_Scale_Type", kind),
            index(&format!("NI_Scale[2]_{kind}_Left_Operand_Input_Source"), 0),
            index(&format!("NI_Scale[2]_{kind}_Right_Operand_Input_Source"), 1),
        ];
        assert_eq!(scaled(&raw_index, &properties, &raw).unwrap(), expected);
    }
    // a single scale, which belongs to the scaler itself
    let one = daqmx(3, &[[5, 0, 0, 0]], &[4]);
    assert_eq!(
        scaled(&one, &[index("NI_Number_Of_Scales", 1)], &u32s(&[7, 8, 9])).unwrap(),
        [7.0, 8.0, 9.0]
    );
    assert!(
        scaled(&raw_index, &[], &raw)
            .unwrap_err()
            .contains("2 of them without a scale")
    );
}

#[test]
fn scales_of_the_group_and_of_the_file_hold_for_their_channels() {
    let scale = |slope: f64| {
        [
            index("NI_Number_Of_Scales", 1),
            word("NI_Scale[0]_Scale_Type", "Linear"),
            real("NI_Scale[0]_Linear_Slope", slope),
            real("NI_Scale[0]_Linear_Y_Intercept", 0.0),
        ]
    };
    let objects = [
        object("/", &NO_DATA, &scale(2.0)),
        object("/'g'", &NO_DATA, &scale(3.0)),
        object("/'g'/'a'", &numbers(2, 1), &[]),
        object("/'h'/'b'", &numbers(2, 1), &[]),
        object("/'g'/'c'", &numbers(2, 1), &scale(5.0)),
    ];
    let expected = named(&[("a", &[3.0]), ("b", &[2.0]), ("c", &[5.0])]);
    assert_eq!(
        all_values(&segment(USUAL, &objects, &i16s(&[1, 1, 1]))),
        expected
    );
}

/// Properties of sensors that are missing or impossible; the values are compared with those of
/// npTDMS.
#[test]
fn incomplete_and_impossible_sensors_are_refused() {
    let raw = [0x3f, 0xb0, 0, 0, 0, 0, 0, 0]
        .into_iter()
        .rev()
        .collect::<Vec<u8>>();
    let of = |kind: &str, numbers_of: &[(&str, f64)], choices: &[(&str, u32)]| {
        let name = |name: &str| format!("NI_Scale[0]_{kind}_{name}");
        let mut properties = vec![
            index("NI_Number_Of_Scales", 1),
            word("NI_Scale[0]_Scale_Type", kind),
        ];
        properties.extend(
            numbers_of
                .iter()
                .map(|(own, value)| real(&name(own), *value)),
        );
        properties.extend(choices.iter().map(|(own, value)| index(&name(own), *value)));
        scaled(&numbers(10, 1), &properties, &raw)
    };
    let strain = [
        ("Poisson_Ratio", 0.3),
        ("Gage_Resistance", 350.0),
        ("Lead_Wire_Resistance", 0.0),
        ("Initial_Bridge_Voltage", 0.0),
        ("Gage_Factor", 2.0),
        ("Bridge_Shunt_Calibration_Gain_Adjustment", 1.0),
        ("Voltage_Excitation", 2.5),
    ];
    let quarter = [("Configuration", 10_271)];
    // 1/16 V: r = 0.025, -4r/(1 + 2r)/k
    let found = of("Strain", &strain, &quarter).unwrap();
    assert!((found[0] + 0.05 / 1.05).abs() < 1e-15, "{found:?}");
    for (without, _) in strain {
        let rest: Vec<(&str, f64)> = strain.into_iter().filter(|own| own.0 != without).collect();
        let said = of("Strain", &rest, &quarter).unwrap_err();
        assert!(said.contains(without) && said.contains("missing"), "{said}");
    }
    for zero in ["Gage_Resistance", "Gage_Factor", "Voltage_Excitation"] {
        let wrong = strain.map(|(name, value)| (name, if name == zero { 0.0 } else { value }));
        let said = of("Strain", &wrong, &quarter).unwrap_err();
        assert!(
            said.contains(zero) && said.contains("a number above 0"),
            "{said}"
        );
    }
    let said = of("Strain", &strain, &[("Configuration", 7)]).unwrap_err();
    assert!(
        said.contains("is 7, expected the number of a full, half or quarter bridge"),
        "{said}"
    );
    let said = of("RTD", &[], &[("Resistance_Configuration", 5)]).unwrap_err();
    assert!(said.contains("is 5, expected 2, 3 or 4 wires"), "{said}");
    let kind = ("Thermocouple_Type", 10_073);
    let said = of("Thermocouple", &[], &[("Thermocouple_Type", 1)]).unwrap_err();
    assert!(
        said.contains("expected the number of type B, E, J, K, N, R, S or T"),
        "{said}"
    );
    let said = of("Thermocouple", &[], &[kind, ("Scaling_Direction", 2)]).unwrap_err();
    assert!(
        said.contains("0 for a temperature or 1 for a voltage"),
        "{said}"
    );
    assert!(of("Thermocouple", &[], &[kind]).is_ok());
}
