//! Signals: a render that is told to end saves first.
//!
//! USR1 saves and ends with 75 (again), TERM with 143 and INT (Ctrl-C) with 130; HUP saves and goes
//! on. While something is being saved further ones are ignored, except for the third INT, which ends
//! at once. While the scene is read and the structure is built there is nothing to save: all but HUP
//! end at once.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicUsize, Ordering};

use crate::cli::error::CliError;

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
    /// Listens from now on.
    ///
    /// # Errors
    /// If the system does not let it.
    pub fn listen() -> Result<Self, CliError> {
        let signals = Self::default();
        system::listen(&signals)
            .map_err(|error| CliError::Limit(format!("cannot listen to signals: {error}")))?;
        Ok(signals)
    }

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

    /// The same for the process.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.code())
    }
}

#[cfg(unix)]
mod system {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};
    use signal_hook::iterator::Signals as Incoming;

    use super::{AGAIN, Ordering, Signals};
    use crate::cli::progress::say;
    use crate::files::remove_pending;

    /// Starts a thread that takes signals as they come.
    pub fn listen(signals: &Signals) -> std::io::Result<()> {
        let mut incoming = Incoming::new([SIGHUP, SIGINT, SIGTERM, SIGUSR1])?;
        let signals = signals.clone();
        let take = move || incoming.forever().for_each(|signal| signals.take(signal));
        std::thread::Builder::new().name("signals".to_owned()).spawn(take)?;
        Ok(())
    }

    impl Signals {
        fn take(&self, signal: i32) {
            let code = match signal {
                SIGHUP => {
                    self.0.save.store(true, Ordering::Relaxed);
                    return;
                }
                SIGUSR1 => AGAIN,
                _ => 128 + signal as u8,
            };
            let has_samples = self.0.has_samples.load(Ordering::SeqCst);
            let times = match signal {
                SIGINT => self.0.interrupts.fetch_add(1, Ordering::SeqCst) + 1,
                _ => 0,
            };
            if has_samples && times < 3 {
                self.stop(code);
                return;
            }
            say(if has_samples {
                "interrupted again: ended without saving"
            } else {
                "interrupted while reading and building: there is nothing to save"
            });
            remove_pending();
            std::process::exit(i32::from(code));
        }
    }
}

#[cfg(not(unix))]
mod system {
    use std::sync::Arc;

    use signal_hook::consts::{SIGINT, SIGTERM};

    use super::Signals;

    /// Where there are no signals but INT and TERM: the first saves and ends, a second ends at once.
    pub fn listen(signals: &Signals) -> std::io::Result<()> {
        let cancel = Arc::new(std::sync::atomic::AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            let code = 128 + signal;
            signal_hook::flag::register_conditional_shutdown(signal, code, cancel.clone())?;
            signal_hook::flag::register(signal, cancel.clone())?;
        }
        let signals = signals.clone();
        let wait = move || {
            while !cancel.load(std::sync::atomic::Ordering::Relaxed) {
                std::thread::sleep(std::time::Duration::from_millis(50));
            }
            signals.stop(130);
        };
        std::thread::Builder::new().name("signals".to_owned()).spawn(wait)?;
        Ok(())
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
        signals.0.save.store(true, Ordering::Relaxed);
        assert!(signals.takes_save() && !signals.takes_save());
    }
}
