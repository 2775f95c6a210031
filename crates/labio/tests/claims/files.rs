//! Archives of other software: every name, number and property is the one that the script next to
//! the archive saved.

use labio::format::mat5::Mat5;
use labio::format::npz::Npz;
use labio::format::{Reader, Strictness};

use crate::mat5::{PACKED, PLAIN, said};
use crate::npy::SAVED;
use testbed::claim::{Claim, Claims};
use testbed::hold;

const NUMPY: &str = r#"
force Real([0.5, -1.25, 3.0]) []
counts Real([1.0, -2.0, 300.0]) [("descr", "<i2")]
big Real([1.5, 2.5]) [("descr", ">f4")]
transfer Complex([Complex { re: 1.0, im: 2.0 }, Complex { re: -3.0, im: -0.5 }]) [("descr", "<c8")]
pair[0, :] Real([1.0, 2.0, 3.0]) [("array", "pair"), ("shape", "(2, 3)"), ("descr", "<f8"), ("fortran_order", "True")]
pair[1, :] Real([4.0, 5.0, 6.0]) [("array", "pair"), ("shape", "(2, 3)"), ("descr", "<f8"), ("fortran_order", "True")]
tall[:, 0] Real([1.0, 3.0, 5.0]) [("array", "tall"), ("shape", "(3, 2)"), ("descr", "|u1")]
tall[:, 1] Real([2.0, 4.0, 6.0]) [("array", "tall"), ("shape", "(3, 2)"), ("descr", "|u1")]
nothing Real([]) []
fs = 51200
operator = Ödeen
channels[0] = F
channels[1] = end A"#;

const MATLAB: &str = "
force [0.5, -1.25, 3.0, 1e300]
counts [1.0, -2.0, 300.0] int16
single [1.5, 2.5] single
large [1099511627776.0, -4503599627370496.0] int64
flags [1.0, 0.0, 1.0] logical
transfer 1+2i -3-0.5i 0+0.0000001i
wide(1,:) [1.0, 2.0, 3.0]
wide(2,:) [4.0, 5.0, 6.0]
tall(:,1) [1.0, 3.0, 5.0] uint8
tall(:,2) [2.0, 4.0, 6.0] uint8
cube(:,1,1) [0.0, 6.0]
cube(:,2,1) [2.0, 8.0]
cube(:,3,1) [4.0, 10.0]
cube(:,1,2) [1.0, 7.0]
cube(:,2,2) [3.0, 9.0]
cube(:,3,2) [5.0, 11.0]
rod.material.density [1410.0, 1420.0]
mixed{1} [1.0, 2.0]
fs = 51200
operator = Ödeen
lines(1,:) = ab
lines(2,:) = cd
empty = empty, 0x3 double
rod.length = 2
rod.material.name = POM
hits(1).peak = 1
hits(1).label = a
hits(2).peak = 2
hits(2).label = b
mixed{2} = text";

/// Number of lines of one listing that are not in the other.
fn unlike(found: &str, expected: &str) -> f64 {
    let [found, expected] = [found, expected].map(|text| text.trim().lines().collect::<Vec<_>>());
    let mut unlike = found.len().abs_diff(expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        if found != expected {
            eprintln!("{found}\n    expected {expected}");
            unlike += 1;
        }
    }
    unlike as f64
}

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    report.check(
        Claim::new(
            "archive of arrays and texts of every width, byte order and memory order",
            "NumPy, fixtures/reference/npz",
        )
        .expects(0.0, "entries that differ, of 13"),
        || {
            let contents = Npz.read(SAVED, Strictness::Strict)?;
            let series = contents.series.iter();
            let series = series.map(|s| format!("{} {:?} {:?}", s.name, s.ordinate, s.properties));
            let properties = contents.properties.iter();
            let properties = properties.map(|(key, value)| format!("{key} = {value}"));
            Ok(unlike(
                &series.chain(properties).collect::<Vec<_>>().join("\n"),
                NUMPY,
            ))
        },
    );
    report.check(
        Claim::new(
            "MATLAB files, plain and compressed, of numbers, texts, structures and cells",
            "SciPy, fixtures/reference/mat5",
        )
        .expects(0.0, "entries that differ, of 60"),
        || {
            let [plain, packed] = [PLAIN, PACKED].map(|file| Mat5.read(file, Strictness::Strict));
            Ok(unlike(&said(&plain?), MATLAB) + unlike(&said(&packed?), MATLAB))
        },
    );
    hold!(report);
}
