//! What `impulse` claims: forces with a closed form, the impacts of paper E, and forces from measured responses.

mod bodies;
mod closed_forms;
mod contact_laws;
mod hammer;
mod kernels;
mod lines_in_time;
mod measured_bodies;
mod paper_e;
mod reconstruction;
mod uncertainty;
