//! Claims about the libraries: the number of ours is computed where the claim is made.

use super::check::{Check, Claim, NotMeasured, Report, refused};
pub(super) use super::difference::largest;

/// A number of ours, or why there is none.
pub(super) type Ours<T = f64> = Result<T, NotMeasured>;

/// How far ours may be from what is expected, and why that far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Within(pub(super) f64, pub(super) &'static str);

/// The claims of one topic, in the order in which they are made.
#[derive(Debug)]
pub(super) struct Claims {
    source: &'static str,
    checks: Vec<Check>,
}

impl Claims {
    pub(super) const fn new() -> Self {
        Self {
            source: "",
            checks: Vec::new(),
        }
    }

    /// Names the equation, table or law that the next claims are about.
    pub(super) fn by(&mut self, source: &'static str) -> &mut Self {
        self.source = source;
        self
    }

    /// `what` is `expected`, in `unit`.
    pub(super) fn claim(
        &mut self,
        what: impl Into<String>,
        unit: &'static str,
        expected: f64,
        within: Within,
        ours: Ours,
    ) {
        let claim = Claim {
            what: what.into(),
            source: self.source,
            unit,
            expected,
            tolerance: within.0,
            tolerance_from: within.1,
        };
        self.checks.push(Check::of(claim, ours));
    }

    /// A relative deviation that should be none.
    pub(super) fn deviation(&mut self, what: impl Into<String>, within: Within, ours: Ours) {
        self.claim(what, "1", 0.0, within, ours);
    }

    pub(super) fn into_report(self) -> Report {
        Report {
            checks: self.checks,
            ..Report::default()
        }
    }
}

/// One number of several that were computed together.
pub(super) fn of<T>(found: &Ours<T>, number: impl FnOnce(&T) -> f64) -> Ours {
    found.as_ref().map(number).map_err(Clone::clone)
}

/// What the libraries refuse is a number that is missing.
impl<E: std::error::Error> From<E> for NotMeasured {
    fn from(error: E) -> Self {
        refused(&error)
    }
}

/// What the computation of a claim misses.
pub(super) fn missing(what: &str) -> NotMeasured {
    NotMeasured::Refused(format!("{what} is missing"))
}

#[cfg(test)]
mod tests {
    use super::super::check::Verdict;
    use super::*;

    #[test]
    fn what_a_library_refuses_is_a_claim_that_failed_with_the_reason() {
        let found = || -> Ours<[f64; 2]> {
            let first: f64 = "2.5".parse()?;
            let second: f64 = "two and a half".parse()?;
            Ok([first, second])
        };
        let found = found();
        let mut claims = Claims::new();
        claims.by("a ruler");
        claims.claim("length", "m", 2.5, Within(0.1, "its scale"), Ok(2.55));
        claims.deviation("width", Within(0.1, "its scale"), of(&found, |f| f[1]));
        let checks = claims.into_report().checks;
        assert_eq!(checks[0].verdict, Verdict::Pass);
        assert_eq!(checks[0].claim.source, "a ruler");
        assert_eq!(checks[1].verdict, Verdict::Fail);
        assert_eq!(checks[1].reason.as_deref(), Some("invalid float literal"));
    }
}
