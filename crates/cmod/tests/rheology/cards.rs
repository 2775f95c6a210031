//! Cards are read by a small parser for each format, and E(ω) is computed from their numbers.

use std::f64::consts::TAU;

use cmod::CmodError;
use cmod::estimate::ErrorSource;
use cmod::rheology::card::{BulkBehaviour, LS_DYNA_TERMS, MaterialCard, Moduli};
use cmod::rheology::{CommonError, FitOptions, PronyFit};
use num_complex::Complex64;
use rodwave::modulus::{ComplexModulus, ConstantQ, GeneralisedMaxwell};
use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;
use testbed::noise::Noise;

use super::measured::{logarithmic, series, with_noise};

fn law() -> GeneralisedMaxwell {
    let branches = [
        (0.3123456e9, 2.2e-6),
        (0.4e9, 4e-5),
        (0.15e9, 3.3e-4),
        (0.25e9, 0.01),
    ];
    series(1.5e9, &branches)
}

/// Solid with instantaneous shear and bulk moduli and terms (modulus, relaxation time).
#[derive(Debug, Default)]
struct Solid {
    shear: f64,
    bulk: f64,
    shear_terms: Vec<(f64, f64)>,
    bulk_terms: Vec<(f64, f64)>,
}

impl Solid {
    fn relaxed(instantaneous: f64, terms: &[(f64, f64)], omega: f64) -> Complex64 {
        let lost: Complex64 = terms
            .iter()
            .map(|(modulus, time)| modulus / Complex64::new(1.0, omega * time))
            .sum();
        instantaneous - lost
    }

    fn young(&self, omega: f64) -> Complex64 {
        let g = Self::relaxed(self.shear, &self.shear_terms, omega);
        let k = Self::relaxed(self.bulk, &self.bulk_terms, omega);
        9.0 * k * g / (3.0 * k + g)
    }

    fn of_young(young: f64, poisson: f64) -> Self {
        Self {
            shear: young / (2.0 * (1.0 + poisson)),
            bulk: young / (3.0 * (1.0 - 2.0 * poisson)),
            ..Self::default()
        }
    }
}

fn numbers(line: &str) -> Vec<f64> {
    line.split(',')
        .map(str::trim)
        .filter(|field| !field.is_empty())
        .map(|field| field.parse().unwrap())
        .collect()
}

fn read_abaqus(text: &str) -> Solid {
    let mut lines = text.lines().filter(|line| !line.starts_with("**"));
    let mut keyword = String::new();
    let (mut young, mut poisson, mut ratios) = (0.0, 0.0, Vec::new());
    let mut instantaneous = None;
    for line in &mut lines {
        if line.starts_with('*') {
            keyword = line.to_owned();
            if keyword.starts_with("*ELASTIC") {
                instantaneous = Some(keyword.ends_with("MODULI=INSTANTANEOUS"));
                assert!(instantaneous == Some(true) || keyword.ends_with("MODULI=LONG TERM"));
            }
        } else if keyword.starts_with("*ELASTIC") {
            [young, poisson] = numbers(line).try_into().unwrap();
        } else if keyword == "*VISCOELASTIC, TIME=PRONY" {
            let [g, k, tau] = numbers(line).try_into().unwrap();
            ratios.push([g, k, tau]);
        }
    }
    let mut solid = Solid::of_young(young, poisson);
    if instantaneous == Some(false) {
        solid.shear /= 1.0 - ratios.iter().map(|[g, ..]| g).sum::<f64>();
        solid.bulk /= 1.0 - ratios.iter().map(|[_, k, _]| k).sum::<f64>();
    }
    for [g, k, tau] in ratios {
        solid.shear_terms.push((g * solid.shear, tau));
        solid.bulk_terms.push((k * solid.bulk, tau));
    }
    solid
}

fn read_ansys(text: &str) -> Solid {
    let property = |name: &str| -> f64 {
        let prefix = format!("MP,{name},7,");
        let line = text.lines().find(|line| line.starts_with(&prefix)).unwrap();
        line[prefix.len()..].parse().unwrap()
    };
    let mut solid = Solid::of_young(property("EX"), property("PRXY"));
    let mut expected = 0;
    let mut shear = true;
    for line in text.lines() {
        if let Some(table) = line.strip_prefix("TB,PRONY,7,1,") {
            let (count, option) = table.split_once(',').unwrap();
            expected += count.parse::<usize>().unwrap();
            shear = option == "SHEAR";
            assert!(shear || option == "BULK");
        } else if let Some(data) = line.strip_prefix("TBDATA,") {
            let [_, ratio, tau] = numbers(data).try_into().unwrap();
            if shear {
                solid.shear_terms.push((ratio * solid.shear, tau));
            } else {
                solid.bulk_terms.push((ratio * solid.bulk, tau));
            }
        }
    }
    assert_eq!(solid.shear_terms.len() + solid.bulk_terms.len(), expected);
    solid
}

fn read_ls_dyna(text: &str) -> Solid {
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(2)
        .filter(|line| !line.starts_with('$'))
        .map(|line| {
            assert!(line.len() % 10 == 0 && line.len() <= 80, "{line:?}");
            (0..line.len() / 10)
                .map(|k| line[10 * k..10 * (k + 1)].trim().parse().unwrap())
                .collect()
        })
        .collect();
    assert_eq!(rows[0].len(), 8);
    assert!(
        rows[0][3..]
            .iter()
            .chain(&rows[1])
            .all(|entry| *entry == 0.0)
    );
    let mut solid = Solid {
        bulk: rows[0][2],
        ..Solid::default()
    };
    for row in &rows[2..] {
        let [shear, rate, bulk, bulk_rate] = row.as_slice().try_into().unwrap();
        assert!(bulk == 0.0 && bulk_rate == 0.0);
        solid.shear += shear;
        if rate > 0.0 {
            solid.shear_terms.push((shear, 1.0 / rate));
        }
    }
    solid
}

fn read_comsol(text: &str) -> Solid {
    let stated = |name: &str| -> f64 {
        let prefix = format!("% {name} ");
        let mut lines = text.lines();
        let value = lines.find_map(|line| line.strip_prefix(prefix.as_str()));
        value.unwrap().parse().unwrap()
    };
    assert!((stated("density") - 912.0).abs() < 1e-12);
    // Young's modulus and Poisson's ratio are those of the main branch; the other branches add to
    // its shear modulus
    let mut solid = Solid::of_young(stated("Young's modulus"), stated("Poisson's ratio"));
    for line in text.lines().filter(|line| !line.starts_with('%')) {
        let (shear, time) = line.split_once(' ').unwrap();
        let [shear, time] = [shear, time].map(|entry| entry.parse::<f64>().unwrap());
        solid.shear += shear;
        solid.shear_terms.push((shear, time));
    }
    solid
}

fn read_json(text: &str) -> Solid {
    let value: serde_json::Value = serde_json::from_str(text).unwrap();
    let number = |at: &serde_json::Value| at.as_f64().unwrap();
    let solid = &value["solid"];
    let terms = solid["terms"].as_array().unwrap().iter();
    Solid {
        shear: number(&solid["shear_modulus_instantaneous_pa"]),
        bulk: number(&solid["bulk_modulus_pa"]),
        shear_terms: terms
            .map(|term| {
                let entry = |name: &str| number(&term[name]);
                (entry("shear_modulus_pa"), entry("relaxation_time_s"))
            })
            .collect(),
        bulk_terms: Vec::new(),
    }
}

/// Returns the points (frequency, value) of a function for Code_Aster.
fn read_code_aster(text: &str, name: &str) -> Vec<(f64, f64)> {
    let (_, after) = text
        .split_once(&format!("{name} = DEFI_FONCTION("))
        .unwrap();
    let (_, after) = after.split_once("VALE=(\n").unwrap();
    let (values, _) = after.split_once("    ),\n").unwrap();
    let pairs = values.lines().map(numbers);
    pairs.map(|pair| (pair[0], pair[1])).collect()
}

fn largest_error(solid: &Solid) -> f64 {
    let law = law();
    largest((0..60).map(|j| {
        let omega = 10.0_f64.powf(-1.0 + 0.15 * f64::from(j));
        (solid.young(omega) / law.at(omega) - 1.0).norm()
    }))
}

#[test]
fn modulus_is_that_of_the_numbers_on_the_card() {
    let law = law();
    let card = MaterialCard::new("PP-homo", 912.0, 0.38, &law).unwrap();
    let of_bulk = |bulk| {
        [
            read_abaqus(&card.abaqus(Moduli::Instantaneous, bulk).unwrap()),
            read_abaqus(&card.abaqus(Moduli::LongTerm, bulk).unwrap()),
            read_ansys(&card.ansys(7, bulk).unwrap()),
        ]
        .map(|solid| largest_error(&solid))
    };
    let all_digits = [BulkBehaviour::ConstantPoissonRatio, BulkBehaviour::Elastic].map(of_bulk);
    let further = [
        read_comsol(&card.comsol().unwrap()),
        read_json(&card.json().unwrap()),
    ];
    let further = further.map(|solid| largest_error(&solid));
    let ten_columns = largest_error(&read_ls_dyna(&card.ls_dyna(7).unwrap()));
    assert!(ten_columns > 1e-9, "ten columns cannot hold more");
    let mut claims = Claims::default();
    claims.by(
        "E = 9KG/(3K + G) of the numbers on the card, formats of Abaqus, ANSYS, LS-DYNA and COMSOL",
    );
    claims.deviation(
        "Abaqus (instantaneous and long-term moduli) and ANSYS, constant ratio and elastic bulk: worst modulus over ten decades",
        Within(
            1e-13,
            "rounding of sums of five terms and of four roots, twice as large where K and G are converted to E and back",
        ),
        Ok(largest(all_digits.into_iter().flatten())),
    );
    claims.deviation(
        "COMSOL and JSON, elastic bulk: worst modulus over ten decades",
        Within(1e-13, "rounding as above"),
        Ok(largest(further)),
    );
    claims.deviation(
        "LS-DYNA: worst modulus over ten decades",
        Within(
            3e-7,
            "rounding of terms of one sign to seven digits, which fit in ten columns",
        ),
        Ok(ten_columns),
    );
    hold!(claims);
}

/// Code_Aster interpolates between the points on logarithmic scales, and defines no values outside
/// them.
#[test]
fn functions_of_code_aster_are_those_of_the_law_in_its_band() {
    let law = law();
    let card = MaterialCard::new("PP-homo", 912.0, 0.38, &law)
        .unwrap()
        .with_comment("of a \"test\" \\ sheet");
    let text = card.code_aster(3.0, 2e4).unwrap();
    assert!(text.contains(r#"PROL_GAUCHE="EXCLU", PROL_DROITE="EXCLU""#));
    assert!(
        text.ends_with(
            "PP_homo = dict(E=PP_homo_E, AMOR_HYST=PP_homo_ETA, RHO=9.12e2, NU=3.8e-1)\n"
        )
    );
    let functions = ["PP_homo_E", "PP_homo_ETA"].map(|name| read_code_aster(&text, name));
    for points in &functions {
        assert!((points[0].0 - 3.0).abs() < 1e-12);
        assert!((points[points.len() - 1].0 - 2e4).abs() < 1e-8);
        assert!(points.is_sorted_by(|a, b| a.0 < b.0));
    }
    let worst = largest((0..200).map(|j| {
        let frequency = 3.0 * (2e4_f64 / 3.0).powf((f64::from(j) + 0.5) / 200.0);
        let exact = law.at(TAU * frequency);
        let found = functions.each_ref().map(|points| {
            let after = points.iter().position(|(f, _)| *f > frequency).unwrap();
            let ((f, a), (g, b)) = (points[after - 1], points[after]);
            let share = (frequency / f).ln() / (g / f).ln();
            a * (b / a).powf(share)
        });
        (found[0] / exact.re - 1.0)
            .abs()
            .max((found[1] * exact.re / exact.im - 1.0).abs())
    }));
    // tolerance: linear interpolation over steps of 0.115 in ln f has an error of an eighth of
    // their square times the curvature of ln η, which is about one
    assert!(worst < 2e-3, "{worst}");
    for (lowest, highest) in [
        (0.0, 1.0),
        (2.0, 2.0),
        (3.0, f64::INFINITY),
        (f64::NAN, 1.0),
    ] {
        assert!(card.code_aster(lowest, highest).is_err());
    }
    let json: serde_json::Value = serde_json::from_str(&card.json().unwrap()).unwrap();
    assert_eq!(json["comments"][0], "of a \"test\" \\ sheet");
    assert_eq!(json["rod"]["branches"].as_array().unwrap().len(), 4);
}

/// With an elastic bulk the Poisson ratio increases as the material relaxes, and the relaxation
/// times in shear are shorter than those of E.
#[test]
fn elastic_bulk_is_not_a_constant_ratio() {
    let law = law();
    let card = MaterialCard::new("PP", 912.0, 0.38, &law).unwrap();
    let read = |bulk| read_abaqus(&card.abaqus(Moduli::LongTerm, bulk).unwrap());
    let (constant, elastic) = (
        read(BulkBehaviour::ConstantPoissonRatio),
        read(BulkBehaviour::Elastic),
    );
    assert_eq!(elastic.shear_terms.len(), law.branches().len());
    for (term, branch) in elastic.shear_terms.iter().zip(law.branches()) {
        assert!(term.1 < branch.relaxation_time && term.1 > 0.5 * branch.relaxation_time);
    }
    assert!(
        elastic
            .bulk_terms
            .iter()
            .all(|(modulus, _)| *modulus == 0.0)
    );
    assert!(
        constant
            .bulk_terms
            .iter()
            .all(|(modulus, _)| *modulus > 0.0)
    );
}

/// Compares the texts of the cards literally, because these programs depend on ten-column fields
/// and on the ends of lines.
#[test]
fn texts_of_the_cards() {
    let law = series(1.5e9, &[(0.5e9, 1e-4)]);
    let card = MaterialCard::new("PP", 912.0, 0.25, &law).unwrap();
    let constant = BulkBehaviour::ConstantPoissonRatio;
    assert_eq!(
        card.abaqus(Moduli::Instantaneous, constant).unwrap(),
        "\
** units: m, kg, s, Pa
*MATERIAL, NAME=PP
*DENSITY
912,
*ELASTIC, MODULI=INSTANTANEOUS
2e9, 0.25
*VISCOELASTIC, TIME=PRONY
2.5e-1, 2.5e-1, 1e-4
"
    );
    assert_eq!(
        card.ansys(3, constant).unwrap(),
        "\
! PP; units: m, kg, s, Pa; elastic constants are instantaneous
MP,EX,3,2e9
MP,PRXY,3,0.25
MP,DENS,3,912
TB,PRONY,3,1,1,SHEAR
TBDATA,1,2.5e-1,1e-4
TB,PRONY,3,1,1,BULK
TBDATA,1,2.5e-1,1e-4
"
    );
    // K = 4/3 GPa; 9K - E∞ = 10.5 GPa and 9K - E(∞) = 10 GPa: μ = 1.05 λ, G∞ = 3K E∞/10.5 GPa, G(0)
    // = 0.8 GPa
    assert_eq!(
        card.ls_dyna(3).unwrap(),
        "\
*MAT_GENERAL_VISCOELASTIC_TITLE
PP
$ units: m, kg, s, Pa
$#     mid        ro      bulk       pcf        ef      tref         a         b
         3    9.12e21.333333e9       0e0       0e0       0e0       0e0       0e0
$#    lcid        nt    bstart     tramp     lcidk       ntk   bstartk    trampk
         0         0         0         0         0         0         0         0
$#      gi     betai        ki    betaki
5.714286e8       0e0       0e0       0e0
2.285714e8    1.05e4       0e0       0e0
"
    );
}

#[test]
fn materials_that_have_no_card() {
    let law = law();
    for name in ["", "7up", "a b", "a,b", "a\nb", "é"] {
        assert!(matches!(
            MaterialCard::new(name, 912.0, 0.3, &law),
            Err(CmodError::CardName { .. })
        ));
    }
    for poisson in [0.5, -1.0, f64::NAN] {
        assert!(MaterialCard::new("PP", 912.0, poisson, &law).is_err());
    }
    assert!(MaterialCard::new("PP", 0.0, 0.3, &law).is_err());
    let fluid = GeneralisedMaxwell::new(0.0, law.branches().to_vec()).unwrap();
    assert!(MaterialCard::new("PP", 912.0, 0.3, &fluid).is_err());
    let spring = series(1e9, &[]);
    assert!(MaterialCard::new("PP", 912.0, 0.3, &spring).is_err());

    let many = std::array::from_fn::<_, 18, _>(|j| (1e7, 10.0_f64.powf(j as f64 - 9.0)));
    let long = series(1e9, &many);
    let card = MaterialCard::new("PP", 912.0, 0.3, &long).unwrap();
    assert_eq!(
        card.ls_dyna(1).unwrap_err(),
        CmodError::CardTerms {
            program: "LS-DYNA",
            found: 19,
            most: LS_DYNA_TERMS
        }
    );
    let twins = series(1e9, &[(4e8, 4e-5); 2]);
    let card = MaterialCard::new("PP", 912.0, 0.3, &twins).unwrap();
    assert!(card.ansys(1, BulkBehaviour::Elastic).is_err());
}

/// Records of constant Q over two decades. Whatever series the criterion chooses, beyond the band
/// the card is not stiffer than E' + E'' at the top and not softer than E' - E'' at the bottom, and
/// its Poisson ratio is the stated one at the stated frequency.
#[test]
fn l1_cards_hold_what_the_band_of_the_data_allows() {
    let law = ConstantQ::new(2.6e9, 0.1, 6e3).unwrap();
    let frequency = logarithmic(150.0, 15e3, 40);
    let mut unlimited: f64 = 0.0;
    for seed in 0..60 {
        let data = with_noise(&law, &frequency, 0.01, seed);
        let options = FitOptions::default().with_profiles(false);
        let fit = PronyFit::new(&data, &options).unwrap().fit;
        let top = law.at(TAU * 15e3);
        let series = fit.law.prony_series().unwrap();
        unlimited = unlimited.max(series.unrelaxed_modulus() / top.norm());
        let card = MaterialCard::from_fit("PP", 912.0, 0.35, &fit, &data)
            .and_then(|card| card.with_poisson_ratio_at(1.5e3, Some(0.01)))
            .unwrap();
        let text = card
            .abaqus(Moduli::Instantaneous, BulkBehaviour::Elastic)
            .unwrap();
        let solid = read_abaqus(&text);
        let young = |omega: f64| solid.young(omega);
        let instantaneous = young(1e12).re;
        // E' + E'' is 1.095 |E|; tolerance: three standard errors of 1 % on a line
        assert!(instantaneous < 1.13 * top.norm(), "{text}");
        assert!(young(1e-6).re > 0.87 * law.at(TAU * 150.0).norm(), "{text}");
        let (k, g) = (
            solid.bulk,
            Solid::relaxed(solid.shear, &solid.shear_terms, TAU * 1.5e3),
        );
        let poisson = (3.0 * k - 2.0 * g) / (2.0 * (3.0 * k + g));
        assert!((poisson.re - 0.35).abs() < 1e-9, "{poisson}");
        // 40 lines with 1 % noise and a law of few branches: the largest deviation is some standard
        // errors
        let deviation = frequency
            .iter()
            .map(|f| (young(TAU * f) / law.at(TAU * f) - 1.0).norm())
            .fold(0.0, f64::max);
        assert!(deviation < 0.05, "{deviation} {text}");
    }
    assert!(unlimited > 1.5, "the test shows nothing: {unlimited}");
}

/// The card states its sources, and contains no value that the data do not determine.
#[test]
fn l1_cards_begin_with_what_they_rest_on() {
    let law = law();
    let frequency = logarithmic(100.0, 15e3, 60);
    let data = with_noise(&law, &frequency, 0.003, 1);
    let fit = PronyFit::new(&data, &FitOptions::default()).unwrap().fit;
    let card = MaterialCard::from_fit("PP", 912.0, 0.35, &fit, &data)
        .and_then(|card| card.with_poisson_ratio_at(1e3, Some(0.02)))
        .unwrap()
        .with_comment("temperature of the data: 23 degC\nSHA-256 00");
    let text = card.ls_dyna(1).unwrap();
    for said in [
        "$ data: 60 lines, 1.0000e2 to 1.5000e4 Hz\n",
        "$ largest deviation from the data: ",
        "$ E(0) = ",
        "$ modulus 1: ",
        "$ Poisson ratio 0.35 +- 0.02 at 1.000e3 Hz",
        "$ elastic bulk: K = ",
        "+- 1.3e1 %",
        "$ temperature of the data: 23 degCSHA-256 00\n",
    ] {
        assert!(text.contains(said), "{said} {text}");
    }
    let comments = || text.lines().filter(|line| line.starts_with("$ "));
    assert!(comments().all(|line| line.len() <= 80), "{text}");

    // a fluid and a spring have no card, and the reason is reported
    let refused = |law: &dyn ComplexModulus| {
        let data = with_noise(law, &frequency, 0.003, 1);
        let fit = PronyFit::new(&data, &FitOptions::default()).unwrap().fit;
        MaterialCard::from_fit("PP", 912.0, 0.35, &fit, &data)
            .unwrap_err()
            .to_string()
    };
    let fluid = series(0.0, &[(2e9, 3e-4)]);
    let reason = refused(&fluid);
    assert!(reason.contains("long-term modulus of the card"), "{reason}");
    let spring = series(2e9, &[]);
    let reason = refused(&spring);
    assert!(reason.contains("number of relaxations"), "{reason}");
}

/// 600 cards of random draws scatter by the errors that the fit predicts, for data with errors of
/// the lines and one common error of all lines.
#[test]
fn l1_cards_of_draws_scatter_by_the_errors_of_the_modulus() {
    let law = law();
    let frequency = logarithmic(100.0, 15e3, 60);
    let data = with_noise(&law, &frequency, 0.003, 1);
    let shift = data
        .modulus()
        .iter()
        .map(|modulus| 0.01 * modulus)
        .collect();
    let common = CommonError {
        source: ErrorSource::Density,
        shift,
    };
    let data = data.with_common_errors(vec![common]).unwrap();
    let fit = PronyFit::new(&data, &FitOptions::default()).unwrap().fit;
    let card = MaterialCard::from_fit("PP", 912.0, 0.35, &fit, &data).unwrap();
    let of_density = card.errors().iter().filter(|e| e.source == "density");
    assert_eq!(of_density.count(), 1);
    let mut draws = Noise::seeded(7);
    let at = |card: &MaterialCard<'_>| {
        let text = card.abaqus(Moduli::Instantaneous, BulkBehaviour::Elastic);
        let solid = read_abaqus(&text.unwrap());
        [200.0, 1.5e3, 12e3].map(|f| solid.young(TAU * f))
    };
    let middle = at(&card);
    let mut squares = [[0.0; 2]; 3];
    const COUNT: u32 = 600;
    for _ in 0..COUNT {
        let standard: Vec<f64> = card.errors().iter().map(|_| draws.normal()).collect();
        let drawn = card.moved(&standard, 912.0, 0.35).unwrap();
        for ((square, own), middle) in squares.iter_mut().zip(at(&drawn)).zip(middle) {
            let off = own - middle;
            square[0] += off.re * off.re / f64::from(COUNT);
            square[1] += off.im * off.im / f64::from(COUNT);
        }
    }
    for (square, f) in squares.iter().zip([200.0, 1.5e3, 12e3]) {
        let stated = fit.prediction(TAU * f).unwrap().covariance;
        for (part, found) in square.iter().enumerate() {
            // 600 draws give a standard deviation to 3 %; a card has fewer branches than the fit
            let ratio = (found / stated[part][part]).sqrt();
            assert!((0.8..1.2).contains(&ratio), "{f} Hz, part {part}: {ratio}");
        }
    }
}

/// A Poisson ratio of 0.38 at a frequency at which the modulus is a sixth of the instantaneous
/// modulus gives an instantaneous ratio of -0.22, and the card is refused. If the stated ratio
/// itself is negative, the ratio may be negative at all rates.
#[test]
fn a_card_has_no_negative_poisson_ratio_beside_a_positive_one() {
    let soft = series(1e8, &[(5e8, 1e-4)]);
    let at = |ratio: f64, law: &GeneralisedMaxwell| {
        MaterialCard::new("X", 1000.0, ratio, law)
            .and_then(|card| card.with_poisson_ratio_at(1.0, None))
            .map(|_| ())
    };
    let refused = at(0.38, &soft).unwrap_err().to_string();
    assert!(refused.contains("instantaneous Poisson ratio"), "{refused}");
    assert!(at(0.45, &soft).is_ok());
    assert!(at(-0.1, &series(1e8, &[(2e7, 1e-4)])).is_ok());
}

/// A series of one branch does not explain data over five decades, and its card states this next to
/// the intervals of its parameters.
#[test]
fn a_card_of_a_series_that_does_not_explain_its_data_says_so() {
    let frequency = logarithmic(1.0, 1e5, 60);
    let data = with_noise(&law(), &frequency, 0.003, 1);
    let options = FitOptions::default().with_most_branches(1);
    let fit = PronyFit::new(&data, &options).unwrap().fit;
    let text = MaterialCard::from_fit("PP", 912.0, 0.35, &fit, &data)
        .and_then(|card| card.ls_dyna(1))
        .unwrap();
    assert!(text.contains("does not explain the data"), "{text}");
    assert!(!text.contains("all parameters are identified"), "{text}");
}
