//! Progress of a run: as a bar, as lines or for programs.

use std::io::{IsTerminal, stderr};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle as BarStyle};

pub use crate::cli::console::say;
use crate::cli::console::{hide_bar, print, show_bar};
use crate::cli::settings::parse::ProgressStyle;
use crate::cli::status::{Phase, Status};
use crate::files::Meter;
use crate::render::Progress;
use crate::scene::Notice;

/// Reports the progress of a run on standard error, from a thread of its own: whoever tells of
/// progress does not wait for a terminal, and while nobody tells there are reports still.
pub struct Reporter {
    shared: Arc<Shared>,
    /// Whether a change of phase is reported at once.
    each_phase: bool,
    /// None if nothing is reported.
    thread: Mutex<Option<JoinHandle<()>>>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    wake: Condvar,
    /// Of reading and building.
    meter: Arc<Meter>,
}

#[derive(Default)]
struct State {
    status: Status,
    /// When its phase began.
    since: Option<Instant>,
    /// What is to be reported at once.
    pending: Vec<Status>,
    /// The phase that was entered last; `None` at the start.
    told: Option<Phase>,
    /// There is no more to report.
    over: bool,
}

/// Steps of a bar.
const BAR_STEPS: u64 = 10_000;
/// What takes no longer is not worth a bar.
const MOMENT: Duration = Duration::from_millis(500);

/// How progress is reported.
struct Form {
    every: Duration,
    each_phase: bool,
    report: Box<dyn FnMut(Status) + Send>,
}

impl Reporter {
    /// A reporter of some style; with `Auto`, a bar if someone may be looking.
    pub fn new(style: ProgressStyle) -> Self {
        let shared = Arc::new(Shared::default());
        let form = Form::of(style);
        let each_phase = form.as_ref().is_some_and(|form| form.each_phase);
        let thread = form.and_then(|mut form| {
            let shared = Arc::clone(&shared);
            let work = move || shared.report(&mut form);
            // A render without a bar is better than none.
            std::thread::Builder::new().name("progress".to_owned()).spawn(work).ok()
        });
        Self { shared, each_phase, thread: Mutex::new(thread) }
    }

    /// Takes note of what the run does from now on.
    pub fn enter(&self, phase: Phase) {
        let mut state = lock(&self.shared.state);
        if state.since.is_none() || state.status.phase != phase {
            (state.status.phase, state.since) = (phase, Some(Instant::now()));
            self.shared.meter.restart();
        }
        let status = self.shared.look(&state);
        if self.each_phase && state.told.replace(phase) != Some(phase) {
            state.pending.push(status);
            self.shared.wake.notify_all();
        }
    }

    /// What is told how much of the reading or the building is done.
    pub fn meter(&self) -> &Arc<Meter> {
        &self.shared.meter
    }

    /// Takes note of how many pixels share the samples.
    pub fn expect_pixels(&self, pixels: u64) {
        lock(&self.shared.state).status.pixels = pixels;
    }

    /// Takes note of the progress.
    pub fn update(&self, progress: Progress) {
        lock(&self.shared.state).status.progress = Some(progress);
    }

    /// Removes the bar; programs get their last line.
    pub fn finish(&self) {
        self.enter(Phase::End);
        self.stop();
    }

    fn stop(&self) {
        lock(&self.shared.state).over = true;
        self.shared.wake.notify_all();
        if let Some(thread) = lock(&self.thread).take() {
            let _ = thread.join();
            hide_bar();
        }
    }
}

impl Drop for Reporter {
    fn drop(&mut self) {
        self.stop();
    }
}

impl Shared {
    /// Reports until there is no more to report.
    fn report(&self, form: &mut Form) {
        loop {
            let (pending, over) = self.wait(form.every);
            for status in pending {
                (form.report)(status);
            }
            if over {
                return;
            }
        }
    }

    /// How far the run is now.
    fn look(&self, state: &State) -> Status {
        let in_phase = state.since.map_or(Duration::ZERO, |since| since.elapsed());
        Status { phase_share: self.meter.share(), in_phase, ..state.status }
    }

    /// Waits for something to report, `every` at most; then that is what there is now. Says whether
    /// it is the last.
    fn wait(&self, every: Duration) -> (Vec<Status>, bool) {
        let idle = |state: &mut State| state.pending.is_empty() && !state.over;
        let waited = self.wake.wait_timeout_while(lock(&self.state), every, idle);
        let (mut state, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        if timeout.timed_out() {
            return (vec![self.look(&state)], false);
        }
        (std::mem::take(&mut state.pending), state.over)
    }
}

impl Form {
    /// None where nothing is reported.
    fn of(style: ProgressStyle) -> Option<Self> {
        let (every, each_phase) = (Duration::from_secs(1), true);
        Some(match style {
            ProgressStyle::None => return None,
            ProgressStyle::Json => {
                Self { every, each_phase, report: Box::new(|status| print(&status.to_json())) }
            }
            ProgressStyle::Openjd => {
                Self { every, each_phase, report: Box::new(|status| print(&status.to_openjd())) }
            }
            ProgressStyle::Auto if !stderr().is_terminal() => Self::lines(),
            ProgressStyle::Plain => Self::lines(),
            ProgressStyle::Auto | ProgressStyle::Bar => Self::bar(),
        })
    }

    fn lines() -> Self {
        let mut lines = Lines::default();
        let report = move |status: Status| {
            if let Some(line) = lines.next(&status) {
                print(&line);
            }
        };
        Self { every: Duration::from_secs(10), each_phase: true, report: Box::new(report) }
    }

    fn bar() -> Self {
        let bar = make_bar();
        let report = move |status: Status| {
            let share = status.share_of_phase();
            if matches!(status.phase, Phase::Write | Phase::End) {
                hide_bar();
            } else if let Some(share) = share.filter(|_| is_worth_a_bar(&status)) {
                show_bar(&bar);
                bar.set_length(BAR_STEPS);
                bar.set_position((share * BAR_STEPS as f64) as u64);
                bar.set_message(format_bar(&status));
            }
        };
        Self { every: Duration::from_millis(100), each_phase: true, report: Box::new(report) }
    }
}

/// Lines for people. That outputs are written is the last of them, and is said once.
#[derive(Default)]
struct Lines {
    /// Whether the next may be the last: there was one, and not the last.
    under_way: bool,
}

impl Lines {
    /// The next one, where there is something to say.
    fn next(&mut self, status: &Status) -> Option<String> {
        if matches!(status.phase, Phase::Write | Phase::End) {
            // After a render of a moment it is not worth a word.
            let is_told = std::mem::take(&mut self.under_way) && status.phase == Phase::Write;
            return is_told.then(|| status.phase.describe().to_owned());
        }
        let line = format_status(status);
        self.under_way |= line.is_some();
        line
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn make_bar() -> ProgressBar {
    let bar = ProgressBar::new(0);
    let template = "{wide_bar} {percent:>3}%  {elapsed_precise}  {msg}";
    if let Ok(style) = BarStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// What is behind the bar.
fn format_bar(status: &Status) -> String {
    match status.phase {
        Phase::Render => format_left(status.left_of_phase()),
        phase => format!("{}, {}", phase.describe(), format_left(status.left_of_phase())),
    }
}

/// A scene that is read or built in a moment needs no bar for that.
fn is_worth_a_bar(status: &Status) -> bool {
    status.phase == Phase::Render || status.in_phase > MOMENT
}

/// How far the run is as a line for people, where there is something to say.
fn format_status(status: &Status) -> Option<String> {
    match status.phase {
        Phase::Read | Phase::Build => {
            let (share, left) = (status.share_of_phase()?, format_left(status.left_of_phase()));
            Some(format!("{}: {:.1}%, {left}", status.phase.describe(), 100.0 * share))
        }
        _ => status.progress.map(format_line),
    }
}

/// The progress as a line for people.
pub fn format_line(progress: Progress) -> String {
    let percent = 100.0 * progress.done as f64 / progress.total.max(1) as f64;
    format!("{percent:.1}%, {}", format_left(progress.left()))
}

fn format_left(left: Option<Duration>) -> String {
    match left {
        Some(left) => format!("{} left", format_clock(left)),
        None => "starting".to_owned(),
    }
}

/// Hours, minutes and seconds, as few of them as will do.
fn format_clock(duration: Duration) -> String {
    let seconds = duration.as_secs_f64().round() as u64;
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    if hours > 0 {
        format!("{hours}h {minutes:02}m")
    } else if minutes > 0 {
        format!("{minutes}m {seconds:02}s")
    } else {
        format!("{seconds}s")
    }
}

/// Prints what a scene asks for that is not honoured, or what was decided for the user.
pub fn note(notice: &Notice) {
    say(&format!("note: {}: {}", notice.place, notice.message));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_like_a_clock() {
        assert_eq!(format_clock(Duration::from_millis(400)), "0s");
        assert_eq!(format_clock(Duration::from_secs(125)), "2m 05s");
        assert_eq!(format_clock(Duration::from_secs(2 * 3600 + 61)), "2h 01m");
    }

    #[test]
    fn lines_for_people_tell_the_share_and_the_time_left() {
        let at = |done| Progress { before: 0, done, total: 8, elapsed: Duration::from_secs(60) };
        assert_eq!(format_line(at(0)), "0.0%, starting");
        assert_eq!(format_line(at(2)), "25.0%, 3m 00s left");
    }

    #[test]
    fn reading_and_building_have_lines_too_once_something_is_known() {
        let in_phase = Duration::from_secs(30);
        let status = Status { phase: Phase::Build, in_phase, ..Status::default() };
        assert_eq!(format_status(&status), None);
        let status = Status { phase_share: Some(0.25), ..status };
        let line = "building the structure: 25.0%, 1m 30s left";
        assert_eq!(format_status(&status).as_deref(), Some(line));
        assert_eq!(format_bar(&status), "building the structure, 1m 30s left");
        assert!(is_worth_a_bar(&status));
        assert!(!is_worth_a_bar(&Status { in_phase: MOMENT, ..status }));
    }

    #[test]
    fn that_all_is_done_is_said_once_and_nothing_after_it() {
        let at = |phase, done| {
            let elapsed = Duration::from_secs(60);
            let progress = Some(Progress { before: 0, done, total: 8, elapsed });
            Status { phase, progress, ..Status::default() }
        };
        let mut lines = Lines::default();
        assert!(lines.next(&at(Phase::Render, 2)).is_some_and(|it| it.starts_with("25.0%")));
        assert_eq!(lines.next(&at(Phase::Write, 8)).as_deref(), Some("writing the outputs"));
        for phase in [Phase::Write, Phase::Write, Phase::End] {
            assert_eq!(lines.next(&at(phase, 8)), None, "{phase:?}");
        }
        let mut failed = Lines::default();
        assert!(failed.next(&at(Phase::Render, 2)).is_some());
        assert_eq!(failed.next(&at(Phase::End, 2)), None, "there is nothing to write");
        assert_eq!(Lines::default().next(&at(Phase::Write, 8)), None, "it took a moment");
    }

    #[test]
    fn a_phase_begins_with_an_empty_meter_and_a_new_clock() {
        let reporter = Reporter::new(ProgressStyle::None);
        reporter.enter(Phase::Read);
        reporter.meter().expect(4);
        reporter.meter().finish(1);
        let look = || reporter.shared.look(&lock(&reporter.shared.state)).phase_share;
        reporter.enter(Phase::Read);
        assert_eq!(look(), Some(0.25));
        reporter.enter(Phase::Build);
        assert_eq!(look(), None);
    }
}
