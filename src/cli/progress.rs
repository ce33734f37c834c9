//! Progress of a render: as a bar, as lines or as JSON.

use std::io::{IsTerminal, Write, stderr};
use std::sync::Mutex;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle as BarStyle};

use crate::cli::settings::parse::ProgressStyle;
use crate::render::Progress;
use crate::scene::Notice;

/// Reports the progress of a render on standard error.
pub struct Reporter {
    form: Form,
}

enum Form {
    Bar(ProgressBar),
    /// When the next line is due, in time since the start.
    Lines(Mutex<Duration>),
    Json(Mutex<Duration>),
    Silent,
}

/// Between plain lines.
const LINE_EVERY: Duration = Duration::from_secs(10);
/// Between JSON objects.
const JSON_EVERY: Duration = Duration::from_secs(1);

impl Reporter {
    /// A reporter of some style; with `Auto`, a bar if someone may be looking.
    pub fn new(style: ProgressStyle) -> Self {
        let form = match style {
            ProgressStyle::None => Form::Silent,
            ProgressStyle::Json => Form::Json(Mutex::new(Duration::ZERO)),
            ProgressStyle::Plain => Form::Lines(Mutex::new(LINE_EVERY)),
            ProgressStyle::Auto if !stderr().is_terminal() => Form::Lines(Mutex::new(LINE_EVERY)),
            ProgressStyle::Auto | ProgressStyle::Bar => Form::Bar(make_bar()),
        };
        Self { form }
    }

    /// Takes note of the progress, and reports it if it is time to.
    pub fn update(&self, progress: Progress) {
        match &self.form {
            Form::Silent => {}
            Form::Bar(bar) => {
                bar.set_length(progress.total);
                bar.set_position(progress.done);
                bar.set_message(format_left(progress));
            }
            Form::Lines(due) => {
                if is_due(due, progress, LINE_EVERY) {
                    let percent = 100.0 * progress.done as f64 / progress.total.max(1) as f64;
                    say(&format!("{percent:.1}%, {}", format_left(progress)));
                }
            }
            Form::Json(due) => {
                if is_due(due, progress, JSON_EVERY) {
                    say(&to_json(progress));
                }
            }
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        if let Form::Bar(bar) = &self.form {
            bar.finish_and_clear();
        }
    }
}

fn make_bar() -> ProgressBar {
    let bar = ProgressBar::new(0);
    let template = "{wide_bar} {percent:>3}%  {elapsed_precise}  {msg}";
    if let Ok(style) = BarStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// Whether a report is due; if so, the next one is due later.
fn is_due(due: &Mutex<Duration>, progress: Progress, every: Duration) -> bool {
    let Ok(mut due) = due.lock() else { return false };
    if progress.elapsed < *due {
        return false;
    }
    *due = progress.elapsed + every;
    true
}

fn format_left(progress: Progress) -> String {
    match progress.left() {
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

fn to_json(progress: Progress) -> String {
    serde_json::json!({
        "done": progress.done,
        "total": progress.total,
        "elapsed_s": progress.elapsed.as_secs_f64(),
        "left_s": progress.left().map(|left| left.as_secs_f64()),
    })
    .to_string()
}

/// Prints what a scene asks for that is not honoured, or what was decided for the user.
pub fn note(notice: &Notice) {
    say(&format!("note: {}: {}", notice.place, notice.message));
}

/// Prints a line on standard error. That no one may be reading is no reason to stop.
pub fn say(line: &str) {
    let _ = writeln!(stderr(), "{line}");
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
    fn lines_come_at_intervals() {
        let due = Mutex::new(LINE_EVERY);
        let at = |seconds| Progress {
            before: 0,
            done: 1,
            total: 2,
            elapsed: Duration::from_secs(seconds),
        };
        let said: Vec<u64> =
            (0..35).filter(|&second| is_due(&due, at(second), LINE_EVERY)).collect();
        assert_eq!(said, [10, 20, 30]);
    }
}
