//! Who gets a picture now and then.

use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::courier::Courier;
use super::due::Due;
use crate::cli::settings::parse_long::Every;
use crate::film::Picture;

/// When the first picture is due at the latest: there is a coarse one by then.
const FIRST: Duration = Duration::from_secs(1);
/// For how long no other picture is wanted, in terms of what the last one took: so a large picture
/// costs the render at most a fifth of one core.
const REST: u32 = 4;

/// Gives pictures to a thread that writes, sends or draws them.
pub struct Outlet {
    due: Mutex<Due>,
    courier: Courier<Arc<Picture>>,
    /// How long its last picture is waited for; `None`: it gets none, for someone else sees to it.
    last: Option<Duration>,
}

impl Outlet {
    /// An outlet that takes a picture every so often by `deliver`, which says for how long there is
    /// no use in another; at the end it gets a last one, waited for as long as `last` says.
    ///
    /// # Errors
    /// The system's reason why there is no thread.
    pub fn start(
        name: &str,
        every: Every,
        last: Option<Duration>,
        mut deliver: impl FnMut(&Arc<Picture>) -> Duration + Send + 'static,
    ) -> io::Result<Self> {
        let courier = Courier::start(name, move |picture: Arc<Picture>| {
            let start = Instant::now();
            let pause = deliver(&picture);
            pause.max(start.elapsed() * REST)
        })?;
        Ok(Self { due: Mutex::new(Due::new(every).and_first_after(FIRST)), courier, last })
    }

    /// Gives a picture if one is due and would be taken at once.
    pub fn update(
        &self,
        elapsed: Duration,
        samples: f64,
        picture: &mut dyn FnMut() -> Arc<Picture>,
    ) {
        let mut due = self.due.lock().unwrap_or_else(PoisonError::into_inner);
        if due.is_due(elapsed, samples) && self.courier.is_free() {
            self.courier.give(picture());
            due.done(elapsed, samples);
        }
    }

    /// Gives the last picture, if it is to have one, and waits until it is taken care of.
    pub fn finish(self, picture: &mut dyn FnMut() -> Arc<Picture>) {
        /// A picture that is being written is waited for.
        const LONG: Duration = Duration::from_secs(3600);
        if self.last.is_some() {
            self.courier.give(picture());
        }
        self.courier.finish(self.last.unwrap_or(LONG));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;
    use crate::film::Window;

    /// A picture that tells its number.
    fn numbered(number: f32) -> Arc<Picture> {
        let window = Window::of_size(1, 1);
        let mut picture = Picture::new(window, window);
        picture.set_channel("R", vec![number]);
        Arc::new(picture)
    }

    #[test]
    fn pictures_are_made_only_when_they_are_due_and_taken() {
        let (sender, delivered) = mpsc::channel();
        let (release, gate) = mpsc::channel::<()>();
        let every = Every::Time(Duration::from_secs(10));
        let last = Some(Duration::from_secs(600));
        let outlet = Outlet::start("test", every, last, move |picture| {
            sender.send(picture.channel("R").expect("there")[0]).expect("someone listens");
            gate.recv().expect("someone opens");
            Duration::from_secs(600)
        })
        .expect("a thread");
        let mut made = 0;
        let mut update = |second: u64| {
            outlet.update(Duration::from_secs(second), 0.0, &mut || {
                made += 1;
                numbered(second as f32)
            });
        };
        update(0);
        update(1);
        assert_eq!(delivered.recv(), Ok(1.0));
        // It is due again, but busy, and then it rests.
        update(30);
        release.send(()).expect("it waits");
        update(60);
        assert_eq!(made, 1);
        release.send(()).expect("it will wait");
        outlet.finish(&mut || numbered(99.0));
        assert_eq!(delivered.iter().collect::<Vec<_>>(), [99.0]);
    }

    #[test]
    fn who_does_not_want_the_last_picture_gets_none() {
        let (sender, delivered) = mpsc::channel();
        let every = Every::Samples(4);
        let outlet = Outlet::start("test", every, None, move |picture| {
            sender.send(picture.channel("R").expect("there")[0]).expect("someone listens");
            Duration::ZERO
        })
        .expect("a thread");
        outlet.update(Duration::from_secs(600), 3.9, &mut || numbered(0.0));
        outlet.update(Duration::from_secs(601), 4.0, &mut || numbered(1.0));
        outlet.finish(&mut || panic!("it is not asked for"));
        assert_eq!(delivered.iter().collect::<Vec<_>>(), [1.0]);
    }
}
