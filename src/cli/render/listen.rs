//! Takes the system's signals.

use super::signals::Signals;
use crate::cli::error::CliError;

/// Listens to signals from now on.
///
/// # Errors
/// If the system does not let it.
pub fn listen() -> Result<Signals, CliError> {
    let signals = Signals::default();
    start(signals.clone())
        .map_err(|error| CliError::Limit(format!("cannot listen to signals: {error}")))?;
    Ok(signals)
}

/// Starts a thread that takes signals as they come.
#[cfg(unix)]
fn start(signals: Signals) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};

    let mut incoming = signal_hook::iterator::Signals::new([SIGHUP, SIGINT, SIGTERM, SIGUSR1])?;
    let work = move || incoming.forever().for_each(|signal| take(&signals, signal));
    std::thread::Builder::new().name("signals".to_owned()).spawn(work)?;
    Ok(())
}

#[cfg(unix)]
fn take(signals: &Signals, signal: i32) {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGUSR1};

    use super::signals::AGAIN;

    let code = match signal {
        SIGHUP => return signals.ask_to_save(),
        SIGUSR1 => AGAIN,
        _ => 128 + signal as u8,
    };
    let interrupts = if signal == SIGINT { signals.count_interrupt() } else { 0 };
    if signals.has_samples() && interrupts < 3 {
        return signals.stop(code);
    }
    crate::cli::progress::say(if signals.has_samples() {
        "interrupted again: ended without saving"
    } else {
        "interrupted while reading and building: there is nothing to save"
    });
    crate::files::remove_pending();
    std::process::exit(i32::from(code));
}

/// Where there are no signals but INT and TERM: the first saves and ends, a second ends at once.
#[cfg(not(unix))]
fn start(signals: Signals) -> std::io::Result<()> {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;

    let raised = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        let code = 128 + signal;
        signal_hook::flag::register_conditional_shutdown(signal, code, raised.clone())?;
        signal_hook::flag::register(signal, raised.clone())?;
    }
    let wait = move || {
        while !raised.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(50));
        }
        signals.stop(130);
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(wait)?;
    Ok(())
}
