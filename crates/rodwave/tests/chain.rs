//! Elements, transition matrices and chains: closed forms, properties, paper E, and refusals.

mod elements;
mod mobility;
mod paper_e;
mod refusals;
mod sections;
