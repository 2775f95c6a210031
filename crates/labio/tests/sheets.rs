//! Sheets: a laboratory's description of its sensors and triggers, whose values are checked by the
//! constructors.

#![cfg(feature = "serde")]

use labio::hits::{Criteria, Extent, Slope, Trigger};
use labio::{
    BridgeLayout, Date, Direction, Polarity, Position, Quantity, Rating, SensorChain, StrainBridge,
};
use serde_json::{from_str, to_string};

#[test]
fn an_accelerometer_is_read_from_its_sheet() {
    let chain: SensorChain = from_str(
        r#"{
            "transducer": { "Sensitivity": { "value": 10.2, "unit": "mV/g", "standard_uncertainty": 0.1 } },
            "polarity": "Inverted",
            "serial": "LW 4711",
            "calibrated_on": "2025-03-14",
            "position": { "x": 0.35, "standard_uncertainty": 0.0005 },
            "direction": "MinusX"
        }"#,
    )
    .unwrap();
    let sensitivity = Rating::new(10.2, "mV/g")
        .unwrap()
        .with_uncertainty(0.1)
        .unwrap();
    let expected = SensorChain::of_sensitivity(sensitivity)
        .unwrap()
        .with_polarity(Polarity::Inverted)
        .with_serial("LW 4711")
        .with_calibration_date(Date::new(2025, 3, 14).unwrap())
        .with_direction(Direction::MinusX)
        .with_position(Position {
            x: 0.35,
            standard_uncertainty: 0.0005,
        })
        .unwrap();
    assert_eq!(chain, expected);
    assert_eq!(
        from_str::<SensorChain>(&to_string(&chain).unwrap()).unwrap(),
        chain
    );
}

#[test]
fn strain_gauges_are_read_from_their_sheet() {
    let chain: SensorChain = from_str(
        r#"{
            "transducer": { "Bridge": {
                "layout": { "FullPoisson": { "poisson_ratio": 0.35 } },
                "gauge_factor": { "value": 2.1, "unit": "1" },
                "excitation": { "value": 5.0, "unit": "V" }
            } },
            "gain": { "value": 500.0, "unit": "1" }
        }"#,
    )
    .unwrap();
    assert_eq!(
        chain.quantity_from(Quantity::Voltage).unwrap(),
        Quantity::Strain
    );
    let bridge = StrainBridge::new(
        BridgeLayout::FullPoisson {
            poisson_ratio: 0.35,
        },
        Rating::new(2.1, "1").unwrap(),
        Rating::new(5.0, "V").unwrap(),
    );
    let expected = SensorChain::of_bridge(bridge.unwrap())
        .with_gain(Rating::new(500.0, "1").unwrap())
        .unwrap();
    assert_eq!(chain, expected);
    assert_eq!(
        from_str::<SensorChain>(&to_string(&chain).unwrap()).unwrap(),
        chain
    );
}

#[test]
fn triggers_and_criteria_are_read_with_their_defaults() {
    let trigger: Trigger = from_str(
        r#"{ "channel": "force", "level": 5.0, "length": { "Seconds": 0.5 }, "pre_trigger": { "Samples": 200 } }"#,
    )
    .unwrap();
    let expected = Trigger::new("force", 5.0, Extent::Seconds(0.5))
        .unwrap()
        .with_pre_trigger(Extent::Samples(200));
    assert_eq!(trigger, expected);
    let full = expected
        .with_slope(Slope::Either)
        .with_hysteresis(1.0)
        .unwrap()
        .with_hold_off(Extent::Seconds(2.0));
    assert_eq!(
        from_str::<Trigger>(&to_string(&full).unwrap()).unwrap(),
        full
    );

    let criteria: Criteria =
        from_str(r#"{ "double_hit": 0.1, "level_shift": null, "full_scales": { "force": 10.0 } }"#)
            .unwrap();
    let expected = Criteria::default()
        .with_double_hit(Some(0.1))
        .unwrap()
        .with_level_shift(None)
        .unwrap()
        .with_full_scale("force", 10.0)
        .unwrap();
    assert_eq!(criteria, expected);
    assert_eq!(
        from_str::<Criteria>(&to_string(&criteria).unwrap()).unwrap(),
        criteria
    );
}

#[test]
fn a_sheet_with_an_impossible_value_is_refused_as_the_constructor_would() {
    let refusal = |error: serde_json::Error| {
        // serde_json adds the place in the text to the message
        error
            .to_string()
            .split(" at line")
            .next()
            .unwrap()
            .to_owned()
    };
    let chain = |sensitivity: &str, rest: &str| {
        let sheet = format!(r#"{{ "transducer": {{ "Sensitivity": {sensitivity} }}{rest} }}"#);
        refusal(from_str::<SensorChain>(&sheet).unwrap_err())
    };
    let good = r#"{ "value": 10.0, "unit": "mV/g" }"#;
    let trigger = |sheet: &str| refusal(from_str::<Trigger>(sheet).unwrap_err());
    let refusals = [
        chain(r#"{ "value": 10.0, "unit": "mV/ge" }"#, ""),
        chain(r#"{ "value": -10.0, "unit": "mV/g" }"#, ""),
        chain(r#"{ "value": 10.0, "unit": "mV/g", "standard_uncertainty": -1.0 }"#, ""),
        chain(good, r#", "calibrated_on": "2025-02-30""#),
        chain(good, r#", "gain": { "value": 0.0, "unit": "1" }"#),
        chain(good, r#", "polarty": "Inverted""#),
        trigger(r#"{ "channel": "force", "level": 5.0, "length": { "Samples": 100 }, "hysteresis": -1.0 }"#),
        refusal(from_str::<Criteria>(r#"{ "drop_out_run": 1 }"#).unwrap_err()),
        refusal(from_str::<Criteria>(r#"{ "double_hits": 1 }"#).unwrap_err()),
    ]
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    `mV/ge` is not a known unit: `ge` is not among the known symbols
    sensitivity is -10, expected a finite value above 0
    standard uncertainty is -1, expected a finite value of at least 0
    `2025-02-30` is not a date, expected a day such as 2026-11-21
    amplifier gain is 0, expected a finite value above 0
    unknown field `polarty`, expected one of `transducer`, `gain`, `polarity`, `offset`, `time_skew`, `time_skew_uncertainty`, `position`, `direction`, `serial`, `calibrated_on`
    trigger hysteresis is -1, expected a finite value of at least 0
    a run of lost samples has 1 samples, expected at least 2
    unknown field `double_hits`, expected one of `several_passages`, `force_channel`, `full_scales`, `peak_over_noise`, `double_hit`, `clipped_run`, `drop_out_run`, `static_offset`, `level_shift`, `remainder`
    ");
}
