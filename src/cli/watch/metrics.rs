//! Figures of a run for Prometheus, as node_exporter's textfile collector reads them.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;
use std::time::{Duration, SystemTime};

use crate::cli::status::Status;
use crate::files::{self, Flush, memory};

/// What a run is at, in figures.
#[derive(Clone, Copy, Debug)]
pub struct Figures {
    /// How far it is.
    pub status: Status,
    /// When it began.
    pub started: SystemTime,
    /// Rays that were shot; `None` while they are not counted.
    pub rays: Option<u64>,
    /// Checkpoints that were written.
    pub checkpoints: u64,
    /// What the process ends with, once it is known.
    pub exit_code: Option<u8>,
}

/// One metric: its name, its type, what it tells, and how it is read off.
struct Metric {
    name: &'static str,
    kind: &'static str,
    help: &'static str,
    /// `None`: it is left out.
    value: fn(&Figures) -> Option<f64>,
}

/// All metrics. The guide lists them.
const METRICS: &[Metric] = &[
    Metric {
        name: "dapple_render_samples_done",
        kind: "gauge",
        help: "Samples taken, over all pixels.",
        value: |it| Some(it.status.progress.map_or(0, |progress| progress.done) as f64),
    },
    Metric {
        name: "dapple_render_samples_wanted",
        kind: "gauge",
        help: "Samples wanted, over all pixels.",
        value: |it| Some(it.status.progress?.total as f64),
    },
    Metric {
        name: "dapple_render_start_time_seconds",
        kind: "gauge",
        help: "When the run began, since the beginning of 1970.",
        value: |it| Some(seconds(it.started.duration_since(SystemTime::UNIX_EPOCH).ok()?)),
    },
    Metric {
        name: "dapple_render_elapsed_seconds",
        kind: "gauge",
        help: "Time since the first sample.",
        value: |it| Some(it.status.progress.map_or(0.0, |progress| seconds(progress.elapsed))),
    },
    Metric {
        name: "dapple_render_left_seconds",
        kind: "gauge",
        help: "Time that the samples will still take at the pace so far.",
        value: |it| Some(seconds(it.status.progress?.left()?)),
    },
    Metric {
        name: "dapple_render_rays_total",
        kind: "counter",
        help: "Rays shot.",
        value: |it| Some(it.rays? as f64),
    },
    Metric {
        name: "dapple_render_checkpoints_total",
        kind: "counter",
        help: "Checkpoints written.",
        value: |it| Some(it.checkpoints as f64),
    },
    Metric {
        name: "dapple_render_peak_memory_bytes",
        kind: "gauge",
        help: "The most memory that the process has had.",
        value: |_| Some(memory::peak()? as f64),
    },
    Metric {
        name: "dapple_render_finished",
        kind: "gauge",
        help: "Whether the run is over, well or not.",
        value: |it| Some(f64::from(u8::from(it.exit_code.is_some()))),
    },
    Metric {
        name: "dapple_render_exit_code",
        kind: "gauge",
        help: "What the process ended with.",
        value: |it| Some(f64::from(it.exit_code?)),
    },
];

fn seconds(duration: Duration) -> f64 {
    duration.as_secs_f64()
}

/// The figures in Prometheus's text format, labelled with the scene.
pub fn format(scene: &str, figures: &Figures) -> String {
    let scene = escape(scene);
    let mut text = String::new();
    for Metric { name, kind, help, value } in METRICS {
        if let Some(value) = value(figures) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "# HELP {name} {help}\n# TYPE {name} {kind}");
            let _ = writeln!(text, "{name}{{scene=\"{scene}\"}} {value}");
        }
    }
    text
}

/// A label's value, as it stands between quotes.
fn escape(value: &str) -> String {
    value.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

/// Writes the file: a collector sees it whole.
///
/// # Errors
/// The system's reason.
pub fn write(path: &Path, text: &str) -> io::Result<()> {
    files::write(path, Flush::WhenIdle, |file| file.write_all(text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::status::Phase;
    use crate::render::Progress;

    fn figures() -> Figures {
        let progress =
            Progress { before: 0, done: 30, total: 120, elapsed: Duration::from_millis(5500) };
        Figures {
            status: Status {
                phase: Phase::Render,
                progress: Some(progress),
                pixels: 4,
                ..Status::default()
            },
            started: SystemTime::UNIX_EPOCH + Duration::from_secs(1000),
            rays: Some(7),
            checkpoints: 2,
            exit_code: Some(130),
        }
    }

    #[test]
    fn figures_are_told_as_prometheus_reads_them() {
        let text = format("a \"b\"\\c\nd", &figures());
        let samples: Vec<(&str, &str)> = text
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(|line| line.rsplit_once(' ').expect("a value"))
            .collect();
        let label = r#"{scene="a \"b\"\\c\nd"}"#;
        for (name, value) in [
            ("samples_done", "30"),
            ("samples_wanted", "120"),
            ("start_time_seconds", "1000"),
            ("elapsed_seconds", "5.5"),
            ("left_seconds", "16.5"),
            ("rays_total", "7"),
            ("checkpoints_total", "2"),
            ("finished", "1"),
            ("exit_code", "130"),
        ] {
            let name = format!("dapple_render_{name}{label}");
            assert!(samples.contains(&(&*name, value)), "{name} {value}: {text}");
        }
        let start = Figures { status: Status::default(), rays: None, exit_code: None, ..figures() };
        let text = format("a", &start);
        assert!(text.contains("\ndapple_render_finished{scene=\"a\"} 0\n"), "{text}");
        for unknown in ["left_seconds", "rays_total", "exit_code", "samples_wanted"] {
            assert!(!text.contains(unknown), "{text}");
        }
    }

    #[test]
    fn each_sample_has_a_help_and_a_type_before_it() {
        let text = format("a", &figures());
        let lines: Vec<&str> = text.lines().collect();
        for lines in lines.chunks(3) {
            let [help, kind, sample] = lines else { panic!("{lines:?}") };
            let name = sample.split('{').next().expect("a name");
            assert!(help.starts_with(&format!("# HELP {name} ")), "{help}");
            let counts = name.ends_with("_total");
            let expected = if counts { "counter" } else { "gauge" };
            assert_eq!(*kind, format!("# TYPE {name} {expected}"));
        }
    }

    #[test]
    fn the_metrics_are_those_of_the_guide() {
        let guide = include_str!("../../../docs/guide.md");
        let (_, table) =
            guide.split_once("| metric | type | what it says |\n|---|---|---|\n").expect("there");
        let rows: Vec<&str> = table.lines().take_while(|line| line.starts_with('|')).collect();
        let expected: Vec<String> = METRICS
            .iter()
            .map(|it| format!("| `{}` | {} | {} |", it.name, it.kind, it.help))
            .collect();
        assert!(rows == expected, "the table should be\n{}", expected.join("\n"));
    }
}
