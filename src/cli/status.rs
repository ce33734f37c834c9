//! How far a run is, as programs read it.

use std::time::Duration;

use serde_json::json;

use crate::render::Progress;

/// What a run does at the moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// It reads the scene.
    #[default]
    Read,
    /// It builds a structure.
    Build,
    /// It takes samples.
    Render,
    /// It writes the outputs.
    Write,
    /// It is over.
    End,
}

impl Phase {
    /// Its name for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Build => "build",
            Self::Render => "render",
            Self::Write => "write",
            Self::End => "end",
        }
    }

    /// What it is, for people.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Read => "reading the scene",
            Self::Build => "building the structure",
            Self::Render => "rendering",
            Self::Write => "writing the outputs",
            Self::End => "ended",
        }
    }
}

/// How far a run is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status {
    /// What it does.
    pub phase: Phase,
    /// The last that was told of its samples; `None` before the first.
    pub progress: Option<Progress>,
    /// How many pixels share the samples; 0 while it is unknown.
    pub pixels: u64,
    /// How much of what the phase does is done, where that is known of reading and building.
    pub phase_share: Option<f64>,
    /// Time since the phase began.
    pub in_phase: Duration,
}

impl Status {
    /// Samples of each pixel so far, on average.
    pub fn samples_per_pixel(&self) -> f64 {
        let done = self.progress.map_or(0, |progress| progress.done);
        if self.pixels == 0 { 0.0 } else { done as f64 / self.pixels as f64 }
    }

    /// How much of the samples is taken, from 0 to 1.
    pub fn share(&self) -> f64 {
        self.progress.map_or(0.0, |it| it.done as f64 / it.total.max(1) as f64)
    }

    /// How much of the phase is done, from 0 to 1, where that is known.
    pub fn share_of_phase(&self) -> Option<f64> {
        match self.phase {
            Phase::Read | Phase::Build => self.phase_share,
            Phase::Render => self.progress.map(|_| self.share()),
            Phase::Write | Phase::End => None,
        }
    }

    /// The time that the phase will still take at its pace so far, where that is known.
    pub fn left_of_phase(&self) -> Option<Duration> {
        if self.phase == Phase::Render {
            return self.progress.and_then(|progress| progress.left());
        }
        let share = self.share_of_phase().filter(|&share| share > 0.0)?;
        Some(self.in_phase.mul_f64((1.0 - share) / share))
    }

    /// As an object in a line; the guide says what its keys are.
    pub fn to_json(self) -> String {
        let left = self.progress.and_then(|progress| progress.left());
        json!({
            "phase": self.phase.name(),
            "done": self.progress.map_or(0, |progress| progress.done),
            "total": self.progress.map_or(0, |progress| progress.total),
            "share": self.share(),
            "spp": self.samples_per_pixel(),
            "elapsed_s": self.progress.map_or(0.0, |progress| progress.elapsed.as_secs_f64()),
            "left_s": left.map(|left| left.as_secs_f64()),
            "phase_share": self.share_of_phase(),
            "phase_left_s": self.left_of_phase().map(|left| left.as_secs_f64()),
        })
        .to_string()
    }

    /// As lines of Open Job Description: a percentage and what is done.
    pub fn to_openjd(self) -> String {
        let percent = 100.0 * self.share();
        format!("openjd_progress: {percent:.1}\nopenjd_status: {}", self.phase.describe())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status() -> Status {
        let progress =
            Progress { before: 0, done: 30, total: 120, elapsed: Duration::from_secs(5) };
        Status { phase: Phase::Render, progress: Some(progress), pixels: 4, ..Status::default() }
    }

    #[test]
    fn the_keys_are_those_of_the_guide() {
        let guide = include_str!("../../docs/guide.md");
        let (_, table) = guide.split_once("| key | what it says |\n|---|---|\n").expect("there");
        let rows = table.lines().take_while(|line| line.starts_with('|'));
        let mut listed: Vec<&str> = rows.filter_map(|row| row.split('`').nth(1)).collect();
        listed.sort_unstable();
        let object: serde_json::Value = serde_json::from_str(&status().to_json()).expect("JSON");
        let keys: Vec<&String> = object.as_object().expect("an object").keys().collect();
        assert_eq!(keys, listed);
    }

    #[test]
    fn figures_are_those_of_the_samples() {
        let object: serde_json::Value = serde_json::from_str(&status().to_json()).expect("JSON");
        let expected = json!({
            "phase": "render", "done": 30, "total": 120, "share": 0.25, "spp": 7.5,
            "elapsed_s": 5.0, "left_s": 15.0, "phase_share": 0.25, "phase_left_s": 15.0,
        });
        assert_eq!(object, expected);
        let start: serde_json::Value =
            serde_json::from_str(&Status::default().to_json()).expect("JSON");
        assert_eq!((&start["phase"], &start["left_s"]), (&json!("read"), &json!(null)));
        assert_eq!(status().to_openjd(), "openjd_progress: 25.0\nopenjd_status: rendering");
    }

    #[test]
    fn reading_and_building_tell_their_share_and_the_time_left() {
        let in_phase = Duration::from_secs(6);
        let status = Status { phase: Phase::Build, in_phase, ..Status::default() };
        assert_eq!((status.share_of_phase(), status.left_of_phase()), (None, None));
        let status = Status { phase_share: Some(0.75), ..status };
        assert_eq!(status.left_of_phase(), Some(Duration::from_secs(2)));
        let object: serde_json::Value = serde_json::from_str(&status.to_json()).expect("JSON");
        assert_eq!((&object["share"], &object["phase_share"]), (&json!(0.0), &json!(0.75)));
    }
}
