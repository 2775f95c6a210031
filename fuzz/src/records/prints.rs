//! Errors can be printed.

/// Prints an error with all its sources, none of which is empty.
pub fn prints(error: &dyn std::error::Error) {
    let mut next = Some(error);
    while let Some(error) = next {
        assert!(
            !error.to_string().trim().is_empty(),
            "an error says nothing: {error:?}"
        );
        next = error.source();
    }
}
