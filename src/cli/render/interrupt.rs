//! Ctrl-C and SIGTERM.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};

use crate::cli::error::CliError;

/// The first signal ends the render early, a second one the process.
pub struct Interrupt {
    raised: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    /// Listens from now on.
    ///
    /// # Errors
    /// If the system does not let it.
    pub fn listen() -> Result<Self, CliError> {
        let (raised, signal) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
        let register = |number: i32| -> std::io::Result<()> {
            let code = 128 + number;
            // In this order: a signal that finds the flag raised already ends the process.
            signal_hook::flag::register_conditional_shutdown(number, code, raised.clone())?;
            signal_hook::flag::register(number, raised.clone())?;
            signal_hook::flag::register_usize(number, signal.clone(), number as usize)?;
            Ok(())
        };
        [SIGINT, SIGTERM]
            .into_iter()
            .try_for_each(register)
            .map_err(|error| CliError::Limit(format!("cannot listen to signals: {error}")))?;
        Ok(Self { raised, signal })
    }

    /// True once there was a signal.
    pub fn raised(&self) -> &AtomicBool {
        &self.raised
    }

    /// 130 after Ctrl-C, 143 after SIGTERM.
    pub fn exit_code(&self) -> u8 {
        128 + self.signal.load(Ordering::Relaxed) as u8
    }
}
