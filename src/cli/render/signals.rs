//! Signals: a render that is told to end saves first.
//!
//! USR1 saves and ends with 75 (again), TERM with 143 and INT (Ctrl-C) with 130; HUP saves and goes
//! on. While something is being saved further ones are ignored, except for the third INT, which
//! ends at once. While the scene is read and the structure is built there is nothing to save: all
//! but HUP end at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicUsize, Ordering};

/// Exit code of a render that is to be started again (`EX_TEMPFAIL` of sysexits.h).
pub const AGAIN: u8 = 75;

/// What a render is told from outside.
#[derive(Clone, Default)]
pub struct Signals(Arc<State>);

#[derive(Default)]
struct State {
    cancel: AtomicBool,
    save: AtomicBool,
    /// Exit code of what cancelled; 0: nothing did.
    code: AtomicU8,
    interrupts: AtomicUsize,
    /// Whether there may be samples to save.
    has_samples: AtomicBool,
}

impl Signals {
    /// True once the render is to end.
    pub fn cancel(&self) -> &AtomicBool {
        &self.0.cancel
    }

    /// Whether it is to end.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancel.load(Ordering::Relaxed)
    }

    /// Whether it was told to save and go on, since this was last asked.
    pub fn takes_save(&self) -> bool {
        self.0.save.swap(false, Ordering::Relaxed)
    }

    /// Says that from now on there may be samples to save.
    pub fn expect_samples(&self) {
        self.0.has_samples.store(true, Ordering::SeqCst);
    }

    /// Tells it to save and go on.
    pub fn ask_to_save(&self) {
        self.0.save.store(true, Ordering::Relaxed);
    }

    /// Counts an interrupt; returns how many there were.
    pub fn count_interrupt(&self) -> usize {
        self.0.interrupts.fetch_add(1, Ordering::SeqCst) + 1
    }

    /// Whether there may be samples to save.
    pub fn has_samples(&self) -> bool {
        self.0.has_samples.load(Ordering::SeqCst)
    }

    /// Ends the render with an exit code, unless it is ending already.
    pub fn stop(&self, code: u8) {
        let _ = self.0.code.compare_exchange(0, code, Ordering::SeqCst, Ordering::SeqCst);
        self.0.cancel.store(true, Ordering::SeqCst);
    }

    /// Takes back that this render is to end, if nothing from outside says so: the next one may
    /// begin.
    pub fn go_on(&self) {
        self.0.cancel.store(false, Ordering::SeqCst);
        // A signal sets the code before it cancels, so none is lost in between.
        if self.code() != 0 {
            self.0.cancel.store(true, Ordering::SeqCst);
        }
    }

    /// The exit code of what ended it: 0 if nothing did.
    pub fn code(&self) -> u8 {
        self.0.code.load(Ordering::SeqCst)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stops_first_decides_on_the_exit_code() {
        let signals = Signals::default();
        assert!(!signals.is_cancelled() && signals.code() == 0);
        signals.stop(AGAIN);
        signals.stop(143);
        assert!(signals.is_cancelled() && signals.code() == AGAIN);
        assert!(!signals.takes_save());
        signals.go_on();
        assert!(signals.is_cancelled(), "a signal ends what comes next, too");
        let out_of_time = Signals::default();
        out_of_time.stop(0);
        out_of_time.go_on();
        assert!(!out_of_time.is_cancelled());
        signals.ask_to_save();
        assert!(signals.takes_save() && !signals.takes_save());
    }
}
