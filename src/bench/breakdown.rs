//! Where the time of a render goes, as a table.

use serde_json::{Map, Value, json};

use super::table::{Table, cell};

/// The renders of one scene by one structure.
#[derive(Clone, Debug)]
pub struct Breakdown {
    /// What tables call the scene.
    pub scene: String,
    /// Id and options of the structure.
    pub spec: String,
    /// Paths that were followed in all rounds.
    pub paths: u64,
    /// Seconds of all rounds, on the clock.
    pub seconds: f64,
    /// Threads that rendered.
    pub threads: usize,
    /// Seconds of each stage in all rounds, over all threads.
    pub stages: Vec<(&'static str, f64)>,
    /// Seconds to write the picture once, which no round counts.
    pub writing: f64,
}

impl Breakdown {
    /// Seconds that all threads had.
    fn available(&self) -> f64 {
        self.seconds * self.threads as f64
    }

    /// Seconds of all stages.
    fn accounted(&self) -> f64 {
        self.stages.iter().map(|(_, seconds)| seconds).sum()
    }

    /// Adds a round.
    pub fn add(&mut self, paths: u64, seconds: f64, stages: &[(&'static str, f64)]) {
        self.paths += paths;
        self.seconds += seconds;
        if self.stages.is_empty() {
            self.stages = stages.iter().map(|&(name, _)| (name, 0.0)).collect();
        }
        for ((_, sum), (_, seconds)) in self.stages.iter_mut().zip(stages) {
            *sum += seconds;
        }
    }

    /// As an object.
    pub fn json(&self) -> Value {
        let stages: Map<String, Value> =
            self.stages.iter().map(|&(name, seconds)| (name.to_owned(), seconds.into())).collect();
        json!({
            "scene": self.scene,
            "accel": self.spec,
            "paths": self.paths,
            "thread_s": self.available(),
            "stages_s": stages,
            "writing_s": self.writing,
        })
    }
}

/// A row a stage, for each scene and structure.
pub fn make_table(breakdowns: &[Breakdown]) -> Table {
    let note = "Seconds over all threads and rounds, their share of the time that the threads had, \
                and nanoseconds a path. What no stage counts, and what is waited for at the end, \
                when threads run out of tiles, is \"other\"; the picture is written after that.";
    let heading = ["", "s", "%", "ns a path"];
    let mut table = Table::new("Where the time goes", note, &heading);
    for breakdown in breakdowns {
        let (available, paths) = (breakdown.available(), breakdown.paths.max(1) as f64);
        table.rows.push(vec![format!("{}, {}", breakdown.scene, breakdown.spec)]);
        let other = ("other", (available - breakdown.accounted()).max(0.0));
        for &(name, seconds) in breakdown.stages.iter().chain([&other]) {
            table.rows.push(vec![
                format!("  {name}"),
                cell(Some(seconds), 3),
                cell(Some(100.0 * seconds / available.max(1e-9)), 1),
                cell(Some(seconds * 1e9 / paths), 1),
            ]);
        }
        table.rows.push(vec!["  all".to_owned(), cell(Some(available), 3), cell(Some(100.0), 1)]);
        table.rows.push(vec!["  writing the picture".to_owned(), cell(Some(breakdown.writing), 3)]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_all_that_the_threads_had() {
        let mut breakdown = Breakdown {
            scene: "car".to_owned(),
            spec: "auto".to_owned(),
            paths: 0,
            seconds: 0.0,
            threads: 2,
            stages: Vec::new(),
            writing: 0.25,
        };
        for _ in 0..2 {
            breakdown.add(500_000, 1.0, &[("closest hits", 1.5), ("film", 0.25)]);
        }
        let text = make_table(&[breakdown.clone()]).markdown();
        assert!(text.contains("|   closest hits | 3.000 | 75.0 | 3000.0 |"), "{text}");
        assert!(text.contains("|   other | 0.500 | 12.5 | 500.0 |"), "{text}");
        assert_eq!(breakdown.json()["stages_s"]["film"], 0.5);
        assert_eq!(breakdown.json()["thread_s"], 4.0);
    }
}
