//! A thread that takes parcels one after the other, so that whoever gives them never waits.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::Builder;
use std::time::{Duration, Instant};

/// Hands parcels to a thread of its own. While that is busy with one, or rests, it wants no other:
/// a parcel that is outdated by then is never made.
pub struct Courier<T> {
    shared: Arc<Shared<T>>,
}

struct Shared<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
}

struct State<T> {
    parcel: Option<T>,
    busy: bool,
    rest_until: Option<Instant>,
    /// There will be no more parcels.
    closed: bool,
    /// The thread has ended.
    ended: bool,
}

/// How long a courier that is dropped is waited for, which may be writing a file.
const LAST_WAIT: Duration = Duration::from_secs(2);

impl<T: Send + 'static> Courier<T> {
    /// Starts the thread. `deliver` takes a parcel and says for how long it wants no other.
    ///
    /// # Errors
    /// The system's reason why there is no thread.
    pub fn start(
        name: &str,
        mut deliver: impl FnMut(T) -> Duration + Send + 'static,
    ) -> std::io::Result<Self> {
        let state =
            State { parcel: None, busy: false, rest_until: None, closed: false, ended: false };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let ending = End(Arc::clone(&shared));
        let work = move || {
            let shared = &*ending.0;
            while let Some(parcel) = shared.take() {
                let rest = deliver(parcel);
                let mut state = shared.lock();
                state.busy = false;
                state.rest_until = Instant::now().checked_add(rest);
            }
        };
        Builder::new().name(name.to_owned()).spawn(work)?;
        Ok(Self { shared })
    }

    /// Whether a parcel that is given now would be delivered at once.
    pub fn is_free(&self) -> bool {
        let state = self.shared.lock();
        let rested = state.rest_until.is_none_or(|until| Instant::now() >= until);
        rested && !state.busy && state.parcel.is_none()
    }

    /// Gives a parcel, in place of one that has not been taken.
    pub fn give(&self, parcel: T) {
        self.shared.lock().parcel = Some(parcel);
        self.shared.changed.notify_all();
    }

    /// Gives no more parcels and waits until those given are delivered, or for so long at most.
    pub fn finish(self, limit: Duration) {
        self.shared.close(limit);
    }
}

impl<T> Drop for Courier<T> {
    fn drop(&mut self) {
        self.shared.close(LAST_WAIT);
    }
}

impl<T> Shared<T> {
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a parcel; `None` if there are no more.
    fn take(&self) -> Option<T> {
        let mut state = self.lock();
        loop {
            if let Some(parcel) = state.parcel.take() {
                state.busy = true;
                return Some(parcel);
            }
            if state.closed {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn close(&self, limit: Duration) {
        let mut state = self.lock();
        // Who has waited once does not do so again.
        let waits = !std::mem::replace(&mut state.closed, true);
        self.changed.notify_all();
        if waits {
            drop(self.changed.wait_timeout_while(state, limit, |state| !state.ended));
        }
    }
}

/// Says that the thread has ended, also when it panicked.
struct End<T>(Arc<Shared<T>>);

impl<T> Drop for End<T> {
    fn drop(&mut self) {
        self.0.lock().ended = true;
        self.0.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    const LONG: Duration = Duration::from_secs(600);

    #[test]
    fn a_parcel_that_is_not_taken_gives_way_to_a_newer_one() {
        let (sender, delivered) = mpsc::channel();
        let (release, gate) = mpsc::channel::<()>();
        let courier = Courier::start("test", move |parcel: u32| {
            sender.send(parcel).expect("someone listens");
            gate.recv().expect("someone opens");
            Duration::ZERO
        })
        .expect("a thread");
        assert!(courier.is_free());
        courier.give(1);
        assert_eq!(delivered.recv(), Ok(1));
        assert!(!courier.is_free(), "it is busy");
        courier.give(2);
        courier.give(3);
        release.send(()).expect("it waits");
        release.send(()).expect("it will wait");
        courier.finish(LONG);
        assert_eq!(delivered.iter().collect::<Vec<_>>(), [3]);
    }

    #[test]
    fn one_who_rests_wants_nothing_but_takes_what_is_given() {
        let (sender, delivered) = mpsc::channel();
        let courier = Courier::start("test", move |parcel: u32| {
            sender.send(parcel).expect("someone listens");
            LONG
        })
        .expect("a thread");
        courier.give(1);
        assert_eq!(delivered.recv(), Ok(1));
        assert!(!courier.is_free(), "it rests");
        courier.give(2);
        courier.finish(LONG);
        assert_eq!(delivered.iter().collect::<Vec<_>>(), [2]);
    }

    #[test]
    fn one_who_never_comes_back_is_not_waited_for() {
        let (_kept, gate) = mpsc::channel::<()>();
        let courier = Courier::start("test", move |(): ()| {
            let _ = gate.recv();
            Duration::ZERO
        })
        .expect("a thread");
        courier.give(());
        courier.finish(Duration::from_millis(10));
    }
}
