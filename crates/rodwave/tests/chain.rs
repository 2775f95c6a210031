//! Elements, transition matrices and chains: closed forms, properties, paper E, and what is
//! refused.

mod elements;
mod mobility;
mod paper_e;
mod refusals;
mod sections;
