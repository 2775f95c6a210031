//! Properties of the contents of any file that was read.

use labio::{Abscissa, Contents, Provenance};

use super::prints;

/// Checks that series have one abscissa for each value, that the strict reader returned no defect,
/// and that records have the properties on which the processing relies.
pub fn check(contents: &Contents, bytes: &[u8], is_strict: bool) {
    assert!(
        !is_strict || contents.defects.is_empty(),
        "the strict reader returned defects: {:?}",
        contents.defects
    );
    for defect in &contents.defects {
        prints(defect);
    }
    for series in &contents.series {
        if let Abscissa::Uneven(values) = &series.abscissa {
            assert_eq!(
                values.len(),
                series.ordinate.len(),
                "abscissa of `{}`",
                series.name
            );
        }
        for axis in [&series.abscissa_axis, &series.ordinate_axis] {
            if let Some(unit) = &axis.unit {
                let scale = unit.scale();
                assert!(scale.is_finite() && scale > 0.0, "{scale} of `{unit}`");
            }
        }
    }
    records(contents, bytes);
}

fn records(contents: &Contents, bytes: &[u8]) {
    let found = contents.records(&Provenance::of_bytes(contents.format, bytes));
    for reason in &found.left_out {
        prints(reason);
    }
    assert_eq!(found.channel_names.len(), contents.series.len());
    let placed = found.channel_names.iter().flatten().count();
    let channels: usize = found
        .records
        .iter()
        .map(|record| record.channels().len())
        .sum();
    assert_eq!(placed, channels, "each channel has a series");
    for record in &found.records {
        let rate = record.sampling_rate_hz();
        assert!(rate.is_finite() && rate > 0.0, "sampling rate {rate}");
        assert!(record.start_time().is_finite() && record.n_samples() >= 2);
        assert_eq!(record.samples().nrows(), record.channels().len());
        assert!(record.samples().iter().all(|sample| sample.is_finite()));
        for (index, channel) in record.channels().iter().enumerate() {
            let same = |other: &labio::Channel| other.name() == channel.name();
            assert!(!channel.name().is_empty());
            assert_eq!(
                record.channels().iter().position(same),
                Some(index),
                "two channels of the same name"
            );
        }
    }
}
