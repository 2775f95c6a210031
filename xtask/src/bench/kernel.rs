//! Hottest kernels, as calls whose instructions callgrind counts. Each kernel is prepared, and
//! called once, before the counted call.
//!
//! A kernel is a loop in which a job of the libraries spends most of its time, called through the
//! public function that a program uses. According to profiles of whole programs (`perf record`),
//! the most expensive loops are: in `rodlab modulus` with laws, the choice of the order of a Prony
//! series; in `rodlab identify`, the interpolation of histories, followed by the march in time; in
//! `rodlab force`, the mobilities of chains.

mod modulus;
mod records;
mod rod;

use crate::Outcome;

/// Kernel with its data, ready to run.
type Prepared = Box<dyn FnMut() -> Outcome>;

/// Counted kernel.
pub(super) struct Kernel {
    pub(super) name: &'static str,
    /// Description of one call.
    pub(super) what: &'static str,
    /// Kind of item that a call processes many times.
    pub(super) of: &'static str,
    /// Number of these items.
    pub(super) count: u32,
    prepare: fn() -> Outcome<Prepared>,
}

/// Kernels, in the order of the page.
pub(super) const KERNELS: [Kernel; 9] = [
    rod::GUREVICH_MARCH,
    rod::NORTON_DERIVATIVES,
    rod::HISTORY,
    rod::CHAIN_MOBILITY,
    rod::CONTACT_MARCH,
    records::SPECTRA_OF_HITS,
    records::UNIVERSAL_FILE,
    modulus::TWO_POINT,
    modulus::PRONY_ORDER,
];

/// Prepares the kernel `name` and calls it twice; callgrind counts the second call.
pub(crate) fn run(name: &str) -> Outcome {
    let Some(kernel) = KERNELS.iter().find(|kernel| kernel.name == name) else {
        let expected = KERNELS.map(|kernel| kernel.name).join(", ");
        return Err(format!("there is no kernel `{name}`, expected one of {expected}").into());
    };
    let mut prepared = (kernel.prepare)()?;
    // the plans and allocations of the first call are not counted
    prepared()?;
    collected_by_callgrind(&mut prepared)
}

/// Calls the kernel. Callgrind finds this function by its name and counts while it runs.
#[inline(never)]
fn collected_by_callgrind(prepared: &mut Prepared) -> Outcome {
    prepared()
}

/// Returns the next number of a linear congruential generator, between -1/2 and 1/2.
pub(super) fn noise(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    f64::from((*state >> 32) as u32) / f64::from(u32::MAX) - 0.5
}
