//! MATLAB files: files saved by SciPy, and bytes put together by hand from the definition in both
//! byte orders.

use labio::format::mat5::{Mat5, RATE_SOURCE};
use labio::format::{Reader, Strictness};
use labio::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesAxis};
use num_complex::Complex64;

use crate::series::{axis, bare, bits, contents_of, pair, refusals, written};

// fixtures/reference/mat5/make.py
pub(crate) const PLAIN: &[u8] = include_bytes!("../../../fixtures/reference/mat5/plain.mat");
pub(crate) const PACKED: &[u8] = include_bytes!("../../../fixtures/reference/mat5/packed.mat");
pub(crate) const SPARSE: &[u8] = include_bytes!("../../../fixtures/reference/mat5/sparse.mat");
pub(crate) const OLD: &[u8] = include_bytes!("../../../fixtures/reference/mat5/old.mat");

fn read(bytes: &[u8]) -> Result<Contents, LabioError> {
    Mat5.read(bytes, Strictness::Strict)
}

/// Lists all contents except the description, which contains a date, and the source of the sampling
/// rate, which is not in the file.
pub(crate) fn said(contents: &Contents) -> String {
    let numbers = |ordinate: &Ordinate| match ordinate {
        Ordinate::Real(values) => format!("{values:?}"),
        Ordinate::Complex(values) => values
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join(" "),
    };
    let series = contents.series.iter().map(|s| {
        let class = s.properties.first().map_or("", |(_, class)| class);
        format!("{} {} {class}", s.name, numbers(&s.ordinate))
            .trim_end()
            .to_owned()
    });
    let properties = contents
        .properties
        .iter()
        .filter(|(key, _)| key != "description" && key != RATE_SOURCE)
        .map(|(key, value)| format!("{key} = {value}"));
    let defects = contents
        .defects
        .iter()
        .map(|defect| format!("defect: {defect}"));
    series
        .chain(properties)
        .chain(defects)
        .collect::<Vec<_>>()
        .join("\n")
}

/// Elements in one byte order.
pub(crate) struct Bytes {
    big_endian: bool,
}

impl Bytes {
    fn word(&self, word: u32) -> Vec<u8> {
        match self.big_endian {
            true => word.to_be_bytes().to_vec(),
            false => word.to_le_bytes().to_vec(),
        }
    }

    fn words(&self, words: &[u32]) -> Vec<u8> {
        words.iter().flat_map(|&word| self.word(word)).collect()
    }

    pub(crate) fn element(&self, kind: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes = self.words(&[kind, u32::try_from(data.len()).unwrap()]);
        bytes.extend(data);
        while kind != 15 && !bytes.len().is_multiple_of(8) {
            bytes.push(0);
        }
        bytes
    }

    /// An element of at most four bytes, stored within the tag.
    fn small(&self, kind: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes = self.word(u32::try_from(data.len()).unwrap() << 16 | kind);
        bytes.extend(data);
        bytes.resize(8, 0);
        bytes
    }

    pub(crate) fn matrix(
        &self,
        class: u32,
        shape: &[u32],
        name: &str,
        parts: &[Vec<u8>],
    ) -> Vec<u8> {
        let mut body = self.element(6, &self.words(&[class, 0]));
        body.extend(self.element(5, &self.words(shape)));
        body.extend(self.element(1, name.as_bytes()));
        body.extend(parts.concat());
        self.element(14, &body)
    }

    fn doubles(&self, values: &[f64]) -> Vec<u8> {
        let data: Vec<u8> = values
            .iter()
            .flat_map(|x| match self.big_endian {
                true => x.to_be_bytes(),
                false => x.to_le_bytes(),
            })
            .collect();
        self.element(9, &data)
    }

    pub(crate) fn file(&self, elements: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = vec![b' '; 124];
        bytes.extend(match self.big_endian {
            true => [1, 0, b'M', b'I'],
            false => [0, 1, b'I', b'M'],
        });
        bytes.extend(elements.concat());
        bytes
    }

    /// A file with a vector, a complex number stored in bytes, a text and a structure of
    /// structures.
    pub(crate) fn sample(&self) -> Vec<u8> {
        let inner = self.matrix(
            2,
            &[1, 1],
            "",
            &[
                self.small(5, &self.word(2)),
                self.element(1, b"a\0"),
                self.matrix(6, &[1, 3], "", &[self.doubles(&[1.0, 2.0, 4.0])]),
            ],
        );
        self.file(&[
            self.matrix(6, &[2, 1], "force", &[self.doubles(&[-0.5, 1e300])]),
            self.matrix(
                6 | 0x0800,
                &[1, 1],
                "z",
                &[self.small(2, &[3]), self.small(1, &[0xff])],
            ),
            self.matrix(
                4,
                &[1, 3],
                "unit",
                &[self.element(16, "\u{b5}m".as_bytes())],
            ),
            self.matrix(
                2,
                &[1, 1],
                "rod",
                &[
                    self.small(5, &self.word(5)),
                    self.element(1, b"part\0"),
                    inner,
                ],
            ),
        ])
    }
}

pub(crate) const LITTLE: Bytes = Bytes { big_endian: false };
pub(crate) const BIG: Bytes = Bytes { big_endian: true };

#[test]
fn both_byte_orders_are_read() {
    let little = said(&read(&LITTLE.sample()).unwrap());
    insta::assert_snapshot!(little, @r"
    force [-0.5, 1e300]
    rod.part.a [1.0, 2.0, 4.0]
    z = 3-1i
    unit = µm
    ");
    assert_eq!(said(&read(&BIG.sample()).unwrap()), little);
    assert!(Mat5.recognises(&BIG.sample()[..128]));
}

/// A rate below 1000 Hz, which may be in kHz, is not used, and neither are two variables that
/// contradict each other.
#[test]
fn a_variable_with_the_name_of_a_rate_gives_the_times() {
    let force = LITTLE.matrix(6, &[3, 1], "force", &[LITTLE.doubles(&[1.0, 2.0, 3.0])]);
    let abscissa_and_source = |numbers: &[(&str, f64)]| {
        let numbers = numbers
            .iter()
            .map(|(name, value)| LITTLE.matrix(6, &[1, 1], name, &[LITTLE.doubles(&[*value])]));
        let elements: Vec<Vec<u8>> = numbers.chain([force.clone()]).collect();
        let contents = read(&LITTLE.file(&elements)).unwrap();
        let mut properties = contents.properties.iter();
        let source = properties.find(|(key, _)| key == RATE_SOURCE);
        (
            contents.series[0].abscissa.clone(),
            source.map(|(_, source)| source.clone()),
        )
    };
    let even = |step: f64| Abscissa::Even { start: 0.0, step };
    let step = 1.0 / 65536.0;
    for (name, value, unit) in [
        ("Fs", 65536.0, "Hz"),
        ("sampling_rate", 65536.0, "Hz"),
        ("dt", step, "s"),
    ] {
        let source = format!("variable `{name}`, in {unit}");
        assert_eq!(
            abscissa_and_source(&[(name, value)]),
            (even(step), Some(source))
        );
    }
    let unclear: [&[(&str, f64)]; 3] = [
        &[("fs", 65.536)],
        &[("fs", 65536.0), ("dt", 1e-5)],
        &[("fsize", 65536.0)],
    ];
    for numbers in unclear {
        assert_eq!(abscissa_and_source(numbers), (even(1.0), None));
    }
}

fn series(name: &str, abscissa: Abscissa, ordinate: Ordinate, unit: &str) -> Series {
    Series {
        abscissa,
        abscissa_axis: SeriesAxis::default(),
        ordinate_axis: axis("", unit),
        ..bare(name, ordinate)
    }
}

/// The written file equals the one put together by hand from the definition, and is read back to
/// the bit.
#[test]
fn series_are_written_as_columns_with_abscissae_and_units() {
    let even = Abscissa::Even {
        start: -0.5,
        step: 0.25,
    };
    let forces = vec![-0.0, 1e300, f64::NAN];
    let ratio = vec![Complex64::new(1.0, -2.0), Complex64::new(0.5, 5e-324)];
    let uneven = Abscissa::Uneven(vec![3.0, 4.5]);
    let mut contents = contents_of(vec![
        series("end A", even, Ordinate::Real(forces.clone()), "N"),
        series("2", uneven, Ordinate::Complex(ratio), ""),
    ]);
    contents.properties = vec![pair("rig", "\u{b5}m")];
    let file = written(&Mat5, &contents).unwrap();
    let named = |name: &str, class: u32, shape: &[u32], parts: &[Vec<u8>]| {
        let mut body = LITTLE.element(6, &LITTLE.words(&[class, 0]));
        body.extend(LITTLE.element(5, &LITTLE.words(shape)));
        body.extend(match name.len() {
            1..=4 => LITTLE.small(1, name.as_bytes()),
            _ => LITTLE.element(1, name.as_bytes()),
        });
        body.extend(parts.concat());
        LITTLE.element(14, &body)
    };
    let scalar = |name: &str, value: f64| named(name, 6, &[1, 1], &[LITTLE.doubles(&[value])]);
    let expected = LITTLE.file(&[
        named("end_A", 6, &[3, 1], &[LITTLE.doubles(&forces)]),
        named(
            "x2",
            6 | 0x0800,
            &[2, 1],
            &[LITTLE.doubles(&[1.0, 0.5]), LITTLE.doubles(&[-2.0, 5e-324])],
        ),
        scalar("end_A_start", -0.5),
        scalar("end_A_step", 0.25),
        named(
            "end_A_name",
            4,
            &[1, 5],
            &[LITTLE.element(4, b"e\0n\0d\0 \0A\0")],
        ),
        named("end_A_unit", 4, &[1, 1], &[LITTLE.small(4, b"N\0")]),
        named("x2_x", 6, &[2, 1], &[LITTLE.doubles(&[3.0, 4.5])]),
        named("x2_name", 4, &[1, 1], &[LITTLE.small(4, b"2\0")]),
        named("rig", 4, &[1, 2], &[LITTLE.small(4, &[0xb5, 0, b'm', 0])]),
    ]);
    assert_eq!(file[124..], expected[124..]);
    let back = read(&file).unwrap();
    let names: Vec<&str> = back
        .series
        .iter()
        .map(|series| series.name.as_str())
        .collect();
    assert_eq!(names, ["end A", "2"]);
    // the variables that accompany a series are read back
    let abscissae = back.series.iter().map(|series| &series.abscissa);
    assert!(abscissae.eq(contents.series.iter().map(|series| &series.abscissa)));
    assert_eq!(back.series[0].ordinate_axis.unit_text, "N");
    assert!(back.series[0].ordinate_axis.unit.is_some());
    let keys: Vec<&str> = back
        .properties
        .iter()
        .map(|(key, _)| key.as_str())
        .collect();
    assert_eq!(keys, ["description", "rig"]);
    let Ordinate::Real(values) = &back.series[0].ordinate else {
        unreachable!("{:?}", back.series[0]);
    };
    assert_eq!(bits(values), bits(&forces));
    // two series with the same name, and a property whose name is already that of a unit
    contents.series[1].name = "end A".to_owned();
    contents.properties[0].0 = "end_A_unit".to_owned();
    let back = read(&written(&Mat5, &contents).unwrap()).unwrap();
    assert!(back.series.iter().all(|series| series.name == "end A"));
    let back = said(&back);
    assert!(back.contains("end_A_unit_2"), "{back}");
}

/// Names that equal those of the variables that accompany a series are changed, whichever of the
/// two comes first; long names are shortened for their endings.
#[test]
fn nothing_else_is_taken_for_the_abscissa_or_the_unit_of_a_series() {
    let uneven = || Abscissa::Uneven(vec![3.0, 4.5]);
    let values = |first: f64| Ordinate::Real(vec![first, 2.0]);
    let long = "a".repeat(80);
    for names in [["b_x", "b"], ["b", "b_x"], [&long, "b"]] {
        let mut contents = contents_of(vec![
            series(names[0], uneven(), values(1.0), ""),
            series(names[1], uneven(), values(7.0), ""),
        ]);
        contents.properties = vec![pair("b_unit", "of the rig")];
        let back = read(&written(&Mat5, &contents).unwrap()).unwrap();
        assert_eq!(back.series.len(), 2, "{names:?}");
        for (one, other) in contents.series.iter().zip(&back.series) {
            assert_eq!(one.abscissa, other.abscissa, "{names:?}");
            assert_eq!(one.ordinate, other.ordinate, "{names:?}");
            assert_eq!(one.name, other.name);
            assert_eq!(other.ordinate_axis.unit_text, "", "{names:?}");
        }
        assert!(back.properties.iter().any(|(_, text)| text == "of the rig"));
    }
}

#[test]
fn other_versions_are_refused_by_name() {
    let mut hdf5 = LITTLE.file(&[]);
    hdf5[124..126].copy_from_slice(&[0, 2]);
    for other in [OLD, &hdf5] {
        assert!(Mat5.recognises(other));
    }
    for other in [&b""[..], b"t,F\n1,2\n", &[0; 200], &PLAIN[..100]] {
        assert!(!Mat5.recognises(other));
    }
    let wrong = [OLD, &hdf5, &[0; 200], b""].map(read);
    insta::assert_snapshot!(refusals(wrong), @r"
    mat5, byte 124: version is 4; save it with `-v7`, expected a MATLAB file of version 5
    mat5, byte 124: version is 7.3, which is HDF5; save it with `-v7`, expected a MATLAB file of version 5
    mat5, byte 124: version is [00, 00, 00, 00], expected a MATLAB file of version 5
    mat5, byte 124: version is a file of 0 bytes, expected a MATLAB file of version 5
    ");
}

#[test]
fn what_is_no_data_is_refused_or_passed_over() {
    insta::assert_snapshot!(read(SPARSE).unwrap_err(), @"mat5, byte 136: class of `K` is sparse, expected numbers, text, struct or cell");
    let contents = Mat5.read(SPARSE, Strictness::Tolerant).unwrap();
    assert_eq!((contents.series.len(), contents.defects.len()), (1, 1));
    // a field without readable data does not affect its neighbours
    let bytes = LITTLE.file(&[LITTLE.matrix(
        2,
        &[1, 1],
        "s",
        &[
            LITTLE.small(5, &LITTLE.word(2)),
            LITTLE.element(1, b"f\0g\0"),
            LITTLE.matrix(16, &[1, 1], "", &[]),
            LITTLE.matrix(6, &[1, 2], "", &[LITTLE.doubles(&[1.0, 2.0])]),
        ],
    )]);
    insta::assert_snapshot!(said(&Mat5.read(&bytes, Strictness::Tolerant).unwrap()), @r"
    s.g [1.0, 2.0]
    defect: mat5, byte 216: class of `s.f` is function handle, expected numbers, text, struct or cell
    ");
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let b = LITTLE;
    let whole = b.sample();
    let one =
        |class, shape: &[u32], parts: &[Vec<u8>]| b.file(&[b.matrix(class, shape, "x", parts)]);
    let mut nested = b.matrix(6, &[1, 2], "x", &[b.doubles(&[1.0, 2.0])]);
    for _ in 0..100 {
        nested = b.matrix(1, &[1, 1], "x", &[nested]);
    }
    let mut deflated = b.file(&[b.element(15, &[0x78, 0x9c, 1, 2, 3])]);
    deflated.extend(b.words(&[15, 0]));
    let wrong = [
        whole[..130].to_vec(),
        whole[..whole.len() - 20].to_vec(),
        b.file(&[b.words(&[14, u32::MAX])]),
        b.file(&[b.words(&[0x0005_0001, 0])]),
        b.file(&[b.doubles(&[1.0])]),
        b.file(&[b.element(14, &[])]),
        b.file(&[b.element(14, &b.doubles(&[1.0]))]),
        deflated,
        one(6, &[1, 3], &[b.doubles(&[1.0, 2.0])]),
        one(6, &[1, 3], &[]),
        one(6, &[3], &[b.doubles(&[1.0])]),
        one(6, &[0x7fff_ffff; 3], &[b.doubles(&[1.0])]),
        one(
            6,
            &[0, 0x7fff_ffff, 0x7fff_ffff, 0x7fff_ffff],
            &[b.doubles(&[])],
        ),
        one(6, &[0x7fff_ffff, 1], &[b.doubles(&[1.0])]),
        one(6, &[u32::MAX, 1], &[b.doubles(&[1.0])]),
        one(6, &[1, 2], &[b.element(8, &[0; 16])]),
        one(6, &[1, 2], &[b.element(9, &[0; 12])]),
        one(
            14,
            &[1, 2],
            &[b.element(
                12,
                &[
                    0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f, 0, 0, 0, 0, 0, 0, 0, 0,
                ],
            )],
        ),
        one(6 | 0x0800, &[1, 2], &[b.doubles(&[1.0, 2.0])]),
        one(4, &[2, 2], &[b.small(1, b"abc")]),
        one(4, &[1, 1], &[b.small(4, &[0x00, 0xd8])]),
        one(1, &[1, 1000], &[]),
        one(2, &[1, 1], &[b.small(5, &b.word(3)), b.small(1, b"f\0")]),
        one(2, &[1, 1], &[b.small(5, &b.word(0)), b.small(1, b"f\0")]),
        one(
            2,
            &[1, 1],
            &[
                b.small(5, &b.word(600)),
                b.element(1, &[b'f'; 600]),
                b.element(14, &[]),
            ],
        ),
        one(3, &[1, 1], &[]),
        one(99, &[1, 1], &[]),
        b.file(&[nested]),
    ]
    .map(|bytes| read(&bytes));
    insta::assert_snapshot!(refusals(wrong), @r"
    the mat5 data end 6 bytes too early
    the mat5 data end 20 bytes too early
    the mat5 data end 4294967295 bytes too early
    mat5, byte 128: length of a small element is 5, expected at most 4 bytes
    mat5, byte 128: type of the element is 9, expected an array (14) or a compressed one (15)
    mat5, byte 136: flags of an array is the end of the array, expected an element
    mat5, byte 136: flags of an array is 1 numbers of type 9, expected two of type 6
    mat5, byte 128: compressed element is `incomplete deflate stream`, expected deflated bytes
    mat5, byte 184: `x` is 2 numbers, expected 3, according to its shape
    mat5, byte 184: `x` is the end of the array, expected an element
    mat5, byte 152: shape of an array is 1 lengths, expected at least 2
    mat5, byte 152: shape of an array is 2147483647, expected lengths whose product does not overflow
    mat5, byte 152: shape of an array is [0, 2147483647, 2147483647, 2147483647], expected lengths whose product does not overflow
    mat5, byte 184: `x` is 1 numbers, expected 2147483647, according to its shape
    mat5, byte 152: shape of an array is -1, expected a length
    mat5, byte 184: `x` is of type 8, expected numbers
    mat5, byte 184: `x` is 12 bytes, expected a multiple of the size of its type
    mat5, byte 184: `x` is 9223372036854776000, expected integers that a double represents exactly
    mat5, byte 208: imaginary part of `x` is the end of the array, expected an element
    mat5, byte 184: x is 3 characters in shape [2, 2], expected rows of characters
    mat5, byte 184: x is of type 4, expected characters
    mat5, byte 184: x is the end of the array, expected an element
    mat5, byte 184: fields of `x` is 2 characters, expected names of the stated length
    mat5, byte 184: fields of `x` is 2 characters, expected names of the stated length
    mat5, byte 800: name of a field is 602 bytes, expected at most 512
    mat5, byte 136: class of `x` is object, expected numbers, text, struct or cell
    mat5, byte 136: class of `x` is unknown, expected numbers, text, struct or cell
    mat5, byte 3776: array within arrays is 65 levels deep, expected at most 64 levels
    ");
}
