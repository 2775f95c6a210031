//! Cards for programs of finite elements, read back by a parser of each format: E(ω) from their numbers.

use cmod::rheology::card::{BulkBehaviour, MaterialCard, Moduli};
use num_complex::Complex64;
use rodwave::modulus::{ComplexModulus, GeneralisedMaxwell, MaxwellBranch};

use testbed::claim::{Claims, Ours, Within, missing};
use testbed::difference::largest;
use testbed::hold;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    let all_digits = Within(
        3e-13,
        "all digits: rounding of sums of five terms and of four roots",
    );
    let ten_columns = Within(5e-6, "six digits in ten columns, half of the last");
    claims.by("E = 9KG/(3K + G) of the numbers on the card, formats of Abaqus, ANSYS and LS-DYNA");
    for (name, bulk) in [
        (
            "constant Poisson ratio",
            BulkBehaviour::ConstantPoissonRatio,
        ),
        ("elastic bulk", BulkBehaviour::Elastic),
    ] {
        for (kind, moduli) in [
            ("instantaneous", Moduli::Instantaneous),
            ("long-term", Moduli::LongTerm),
        ] {
            claims.deviation(
                format!("Abaqus, {name}, {kind} moduli: worst modulus over ten decades"),
                all_digits,
                error_of(|card| Ok(read_abaqus(&card.abaqus(moduli, bulk)?))),
            );
        }
        claims.deviation(
            format!("ANSYS, {name}: worst modulus over ten decades"),
            all_digits,
            error_of(|card| read_ansys(&card.ansys(7, bulk)?)),
        );
    }
    claims.deviation(
        "LS-DYNA: worst modulus over ten decades",
        ten_columns,
        error_of(|card| read_ls_dyna(&card.ls_dyna(7)?)),
    );
    hold!(claims);
}

/// Shear and bulk modulus of instantaneous values and terms (modulus, relaxation time).
#[derive(Debug, Default)]
struct Solid {
    shear: f64,
    bulk: f64,
    shear_terms: Vec<(f64, f64)>,
    bulk_terms: Vec<(f64, f64)>,
}

impl Solid {
    fn of_young(young: f64, poisson: f64) -> Self {
        Self {
            shear: young / (2.0 * (1.0 + poisson)),
            bulk: young / (3.0 * (1.0 - 2.0 * poisson)),
            ..Self::default()
        }
    }

    fn young(&self, omega: f64) -> Complex64 {
        let relaxed = |instantaneous: f64, terms: &[(f64, f64)]| {
            let term = |&(modulus, time): &(f64, f64)| modulus / Complex64::new(1.0, omega * time);
            instantaneous - terms.iter().map(term).sum::<Complex64>()
        };
        let g = relaxed(self.shear, &self.shear_terms);
        let k = relaxed(self.bulk, &self.bulk_terms);
        9.0 * k * g / (3.0 * k + g)
    }
}

fn error_of(read: impl Fn(&MaterialCard<'_>) -> Ours<Solid>) -> Ours {
    let branch = |(modulus, relaxation_time)| MaxwellBranch {
        modulus,
        relaxation_time,
    };
    let branches = [
        (0.3123456e9, 2.2e-6),
        (0.4e9, 4e-5),
        (0.15e9, 3.3e-4),
        (0.25e9, 0.01),
    ];
    let law = GeneralisedMaxwell::new(1.5e9, branches.map(branch).to_vec())?;
    let solid = read(&MaterialCard::new("PP-homo", 912.0, 0.38, &law)?)?;
    Ok(largest((0..60).map(|j| {
        let omega = 10.0_f64.powf(-1.0 + 0.15 * f64::from(j));
        (solid.young(omega) / law.at(omega) - 1.0).norm()
    })))
}

/// NaN where a field is no number.
fn numbers(line: &str) -> Vec<f64> {
    line.split(',')
        .map(str::trim)
        .filter(|field| !field.is_empty())
        .map(|field| field.parse().unwrap_or(f64::NAN))
        .collect()
}

fn read_abaqus(text: &str) -> Solid {
    let mut keyword = "";
    let mut solid = Solid::default();
    let mut long_term = false;
    let mut ratios = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with("**")) {
        if line.starts_with('*') {
            keyword = line;
            long_term |= line.ends_with("MODULI=LONG TERM");
            continue;
        }
        match numbers(line)[..] {
            [young, poisson] if keyword.starts_with("*ELASTIC") => {
                solid = Solid::of_young(young, poisson);
            }
            [g, k, tau] if keyword == "*VISCOELASTIC, TIME=PRONY" => ratios.push([g, k, tau]),
            _ => {}
        }
    }
    if long_term {
        solid.shear /= 1.0 - ratios.iter().map(|[g, ..]| g).sum::<f64>();
        solid.bulk /= 1.0 - ratios.iter().map(|[_, k, _]| k).sum::<f64>();
    }
    for [g, k, tau] in ratios {
        solid.shear_terms.push((g * solid.shear, tau));
        solid.bulk_terms.push((k * solid.bulk, tau));
    }
    solid
}

fn read_ansys(text: &str) -> Ours<Solid> {
    let property = |name: &str| -> Ours {
        let prefix = format!("MP,{name},7,");
        let value = text.lines().find_map(|line| line.strip_prefix(&prefix));
        Ok(value.ok_or_else(|| missing(name))?.parse()?)
    };
    let mut solid = Solid::of_young(property("EX")?, property("PRXY")?);
    let mut shear = true;
    for line in text.lines() {
        if line.starts_with("TB,PRONY,7,1,") {
            shear = line.ends_with("SHEAR");
        } else if let Some(data) = line.strip_prefix("TBDATA,") {
            match numbers(data)[..] {
                [_, ratio, tau] if shear => solid.shear_terms.push((ratio * solid.shear, tau)),
                [_, ratio, tau] => solid.bulk_terms.push((ratio * solid.bulk, tau)),
                _ => return Err(missing("a term of three numbers")),
            }
        }
    }
    Ok(solid)
}

/// Fields of ten columns.
fn read_ls_dyna(text: &str) -> Ours<Solid> {
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(2)
        .filter(|line| !line.starts_with('$'))
        .map(|line| {
            (0..line.len() / 10)
                .map(|k| {
                    line[10 * k..10 * (k + 1)]
                        .trim()
                        .parse()
                        .unwrap_or(f64::NAN)
                })
                .collect()
        })
        .collect();
    let constants = rows.first().ok_or_else(|| missing("the first row"))?;
    let mut solid = Solid {
        bulk: *constants
            .get(2)
            .ok_or_else(|| missing("the bulk modulus"))?,
        ..Solid::default()
    };
    for row in rows.iter().skip(2) {
        let [shear, rate, ..] = row[..] else {
            return Err(missing("a term of two numbers"));
        };
        solid.shear += shear;
        if rate > 0.0 {
            solid.shear_terms.push((shear, 1.0 / rate));
        }
    }
    Ok(solid)
}
