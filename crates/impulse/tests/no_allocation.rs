//! A march allocates its arrays before the first step, and nothing during the steps.

use impulse::{ContactLaw, Impact};

use crate::bodies::{long_rod, mass};

#[test]
fn a_step_allocates_nothing() {
    let (striker, rod) = (mass(0.1), long_rod(1e3));
    for law in [ContactLaw::Rigid, ContactLaw::hertz(5e9).unwrap()] {
        let allocations = [4096.0, 8192.0].map(|n_steps| {
            let impact = Impact::between(&striker, &rod)
                .at_velocity(1.0)
                .through(law.clone())
                .in_steps_of(1e-3 / n_steps)
                .discretised(1e-3)
                .unwrap();
            allocation_counter::measure(|| {
                impact.predict().unwrap();
            })
            .count_total
        });
        // twice as many steps need one more block size with its transforms, but no allocation in
        // any of the 4096 additional steps
        assert!(
            allocations[1] < allocations[0] + 100,
            "{law:?} {allocations:?}"
        );
    }
}
