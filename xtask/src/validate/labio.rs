//! Claims of the crate `labio`.

mod estimators;
mod files;
mod histories;
mod hits;
mod sensors;
mod several;
mod spectra;
mod windows;

use super::check::Report;

pub(crate) fn report() -> Report {
    windows::report()
        .and(spectra::report())
        .and(estimators::report())
        .and(several::report())
        .and(histories::report())
        .and(sensors::report())
        .and(files::report())
}
