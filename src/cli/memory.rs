//! Refuses work that needs more memory than there is, before it begins.

use crate::cli::error::CliError;
use crate::files::memory::limit;

/// Refuses work that needs more memory than there is; `what` names it in the message, as in
/// `a frame of 8x8`.
///
/// # Errors
/// [`CliError::Limit`] with both figures.
pub fn require(what: &str, needed: u64) -> Result<(), CliError> {
    let limit = limit();
    if needed <= limit {
        return Ok(());
    }
    let giga = |bytes: u64| bytes as f64 * 1e-9;
    let (needed, limit) = (giga(needed), giga(limit));
    Err(CliError::Limit(format!("{what} needs {needed:.1} GB of memory, there are {limit:.1} GB")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_the_figure() {
        assert!(require("a pixel", 400).is_ok());
        let error = require("a frame of 9x9", 1 << 60).expect_err("there is no such machine");
        assert_eq!(error.exit_code(), 5);
        let start = "a frame of 9x9 needs 1152921504.6 GB of memory, there are ";
        assert!(error.to_string().starts_with(start), "{error}");
    }
}
