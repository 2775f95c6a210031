//! Claims of the crate `impulse`: forces with a closed form, the impacts of paper E, and forces
//! from measured responses.

#[path = "against_line.rs"]
mod against_line;
#[path = "closed_forms.rs"]
mod closed_forms;
mod contact_laws;
mod hammer;
#[path = "kernels.rs"]
mod kernels;
mod measured_bodies;
#[path = "paper_e_contact.rs"]
mod paper_e_contact;
mod reconstruction;
mod uncertainty;
