//! WAVE files written by scipy.io.wavfile and libsndfile, compared with the samples that libsndfile
//! reads: `fixtures/reference/wav`.

use labio::format;

use crate::series::{even, pair, real, rows_of};

const VALUES: &str = include_str!("../../../fixtures/reference/wav/values.csv");

macro_rules! files {
    ($(($name:literal, $encoding:literal)),* $(,)?) => {
        [$(($name, $encoding, include_bytes!(concat!("../../../fixtures/reference/wav/", $name, ".wav")).as_slice())),*]
    };
}

/// Name, expected encoding and bytes of each file.
const FILES: [(&str, &str, &[u8]); 11] = files![
    ("scipy_pcm8", "PCM 8 bits"),
    ("scipy_pcm16", "PCM 16 bits"),
    ("scipy_pcm32", "PCM 32 bits"),
    ("scipy_float32", "floating point 32 bits"),
    ("scipy_float64", "floating point 64 bits"),
    ("scipy_mono", "PCM 16 bits"),
    ("sndfile_wav_pcm24", "PCM 24 bits"),
    ("sndfile_extensible_pcm16", "PCM 16 bits"),
    ("sndfile_extensible_pcm24", "PCM 24 bits"),
    ("sndfile_extensible_pcm32", "PCM 32 bits"),
    ("sndfile_rf64_pcm24", "PCM 24 bits"),
];

/// Both readers divide integers by a power of two: the samples are equal to the last bit.
#[test]
fn samples_are_libsndfiles() {
    let mut compared = 0;
    for (file, encoding, bytes) in FILES {
        let contents = format::read_bytes(bytes).unwrap();
        assert_eq!(contents.format, "wav");
        let properties = &contents.properties;
        assert!(
            properties.contains(&pair("encoding", encoding)),
            "{file}: {properties:?}"
        );
        let rows = rows_of(VALUES, file);
        let total: usize = contents.series.iter().map(|s| s.ordinate.len()).sum();
        assert_eq!(total, rows.len(), "{file}");
        for row in rows {
            let rate: f64 = row[1].parse().unwrap();
            let frame: usize = row[2].parse().unwrap();
            let channel: usize = row[3].parse().unwrap();
            let expected: f64 = row[4].parse().unwrap();
            let series = &contents.series[channel];
            assert_eq!(series.abscissa, even(0.0, rate.recip()));
            let values = real(&contents, channel);
            assert_eq!(values[frame], expected, "{file} {frame} {channel}");
            compared += 1;
        }
    }
    assert_eq!(compared, VALUES.lines().count() - 1);
}
