//! Check that errors can be printed.

/// Checks that an error and all its sources have non-empty messages.
pub fn prints(error: &dyn std::error::Error) {
    let mut next = Some(error);
    while let Some(error) = next {
        assert!(
            !error.to_string().trim().is_empty(),
            "an error has an empty message: {error:?}"
        );
        next = error.source();
    }
}
