//! A mutex that is taken in turn.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// A mutex whose holder, if it lets go and comes back at once, does not get it before another who
/// waits. That of the standard library is mostly taken again by the thread that had it, for one
/// that waits must first be woken: whoever looks at a tile would wait for its whole pass.
pub(super) struct FairMutex<T> {
    /// Held by the one who waits: who comes later waits for this.
    turn: Mutex<()>,
    value: Mutex<T>,
}

impl<T> FairMutex<T> {
    /// Guards a value.
    pub fn new(value: T) -> Self {
        Self { turn: Mutex::new(()), value: Mutex::new(value) }
    }

    /// Waits for the value. A panic of another holder ends the render anyway; it need not be
    /// reported twice.
    pub fn lock(&self) -> MutexGuard<'_, T> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        self.value.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;

    use super::*;

    #[test]
    fn who_waits_gets_it_from_one_who_always_comes_back() {
        let mutex = FairMutex::new(());
        let (is_held, is_taken) = (AtomicBool::new(false), AtomicBool::new(false));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !is_held.load(Ordering::SeqCst) {
                    std::thread::yield_now();
                }
                let _value = mutex.lock();
                is_taken.store(true, Ordering::SeqCst);
            });
            let came_to_it = (0..2000).any(|_| {
                let _value = mutex.lock();
                is_held.store(true, Ordering::SeqCst);
                std::thread::sleep(Duration::from_millis(1));
                is_taken.load(Ordering::SeqCst)
            });
            assert!(came_to_it, "it waits for ever");
        });
    }
}
