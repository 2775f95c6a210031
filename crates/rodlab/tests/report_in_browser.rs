//! The report as a person meets it: opened in a browser, pointed at, zoomed, on a large screen and on a small one.
//!
//! The browser is chromium, google-chrome or the program that `RODLAB_BROWSER` names; without one the test says that it is skipped.
//! With `RODLAB_KEEP` set to a folder, the pages that were opened stay there for looking at.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a failing test should say so at once"
)]

mod rich;
