//! Integration tests of cmod: one program, a module for each subject.

mod branch;
mod checks;
mod creep_recovery;
mod gauge_uncertainty;
mod golden_paper_a;
mod golden_paper_c;
mod hard_to_break;
mod lateral_inertia;
mod multi_point;
mod neighbours;
mod reference_lmfit;
mod reference_mpmath;
mod rheology;
mod two_point;
mod virtual_rig;
mod virtual_tests;
