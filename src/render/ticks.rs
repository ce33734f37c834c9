//! A second thread that looks after a render now and then.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Runs `work` while another thread calls `tick` ten times a second, and once more at the end.
pub fn with_ticks(tick: &(dyn Fn() + Sync), work: impl FnOnce() + Send) {
    let (finished, wake) = (Mutex::new(false), Condvar::new());
    /// Says that the work is over, also when it panicked.
    struct Finish<'a>(&'a Mutex<bool>, &'a Condvar);
    impl Drop for Finish<'_> {
        fn drop(&mut self) {
            *lock(self.0) = true;
            self.1.notify_all();
        }
    }
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut over = lock(&finished);
            loop {
                // The work may be over before this thread is there to wait.
                if !*over {
                    let waited = wake.wait_timeout(over, Duration::from_millis(100));
                    over = waited.unwrap_or_else(PoisonError::into_inner).0;
                }
                let is_over = *over;
                drop(over);
                tick();
                if is_over {
                    break;
                }
                over = lock(&finished);
            }
        });
        let _finish = Finish(&finished, &wake);
        work();
    });
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
