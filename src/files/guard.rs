//! Work by others that must not end the process, whatever it is given.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Does some work of a crate that may panic. The last line of defence: what is known to be wrong
/// with its input is found before.
///
/// # Errors
/// `message`, if it panics.
pub fn run<T>(message: &str, work: impl FnOnce() -> T) -> Result<T, String> {
    let before = GUARDED.replace(true);
    // What the work leaves half done is dropped, and nobody else sees it.
    let done = panic::catch_unwind(AssertUnwindSafe(work));
    GUARDED.set(before);
    done.map_err(|_| format!("{message}: its decoder failed"))
}

/// Whether a panic of this thread is one that [`run`] catches.
pub fn is_guarded() -> bool {
    GUARDED.get()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error() {
        assert_eq!(run("is broken", || 7), Ok(7));
        let failed = run("is broken", || [1, 2][std::hint::black_box(2)]);
        assert_eq!(failed, Err("is broken: its decoder failed".to_owned()));
        assert!(!is_guarded());
    }
}
