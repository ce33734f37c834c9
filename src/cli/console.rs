//! Standard error: lines, a bar below them, and pictures between.
//!
//! The bar is taken off while something else is written, and drawn again below it.

use std::io::{self, Write, stderr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use indicatif::ProgressBar;

use crate::cli::log;

/// The bar that is shown.
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// How many lines have been printed.
static LINES: AtomicU64 = AtomicU64::new(0);

/// Prints a line, which the log gets too.
pub fn say(line: &str) {
    log::write(line);
    print(line);
}

/// Prints a line that is of no use later, such as one about progress. That no one may be reading is
/// no reason to stop.
pub fn print(line: &str) {
    LINES.fetch_add(1, Ordering::Relaxed);
    above_bar(|| {
        let _ = writeln!(stderr(), "{line}");
    });
}

/// Writes bytes as they are, which may move the cursor and should leave it where a line begins.
///
/// # Errors
/// The system's reason.
pub fn draw(bytes: &[u8]) -> io::Result<()> {
    above_bar(|| {
        let mut stderr = stderr().lock();
        stderr.write_all(bytes)?;
        stderr.flush()
    })
}

/// How many lines have been printed: as long as it is the same, what was drawn stands just above
/// the cursor.
pub fn lines() -> u64 {
    LINES.load(Ordering::Relaxed)
}

/// Shows a bar below all that is printed from now on.
pub fn show_bar(bar: &ProgressBar) {
    *shown() = Some(bar.clone());
}

/// Removes the bar.
pub fn hide_bar() {
    let bar = shown().take();
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}

fn shown() -> MutexGuard<'static, Option<ProgressBar>> {
    BAR.lock().unwrap_or_else(PoisonError::into_inner)
}

fn above_bar<R>(print: impl FnOnce() -> R) -> R {
    // Not held meanwhile: whoever fails in there wants to say so.
    let bar = shown().clone();
    match bar {
        Some(bar) => bar.suspend(print),
        None => print(),
    }
}
