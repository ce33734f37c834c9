//! The figures of a file that can be compared, in one form.

use super::files::Bench;
use super::member::{Malformed, Member};
use super::short_run::{ShortRun, What};
use crate::accel::Event;

/// What a figure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Millions of rays a second: of a machine and a moment.
    Rate,
    /// Work or size: the same on any machine.
    Work,
}

/// A figure of a structure.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// What was measured, such as a set of rays: the same for all structures.
    pub group: String,
    /// The structure.
    pub structure: String,
    /// What the figure is.
    pub kind: Kind,
    /// The figure.
    pub value: f64,
}

/// Which part of a file is read.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// The place of a scene.
    pub place: usize,
    /// Of so many pictures of a flight the middle one.
    pub stride: usize,
    /// Whether work that depends on the rays is read.
    pub same_rays: bool,
}

impl Part {
    /// Of a file, what a short run measures again.
    pub fn of_file(run: &ShortRun) -> Self {
        let stride = match run.what {
            What::Coherent { stride, .. } => stride,
            _ => 1,
        };
        Self { place: run.place, stride, same_rays: run.same_rays }
    }

    /// All of the short run itself.
    pub fn of_run(run: &ShortRun) -> Self {
        Self { place: 0, stride: 1, same_rays: run.same_rays }
    }
}

/// The figures of a part of a file.
///
/// # Errors
/// A member that is missing or of another kind.
pub fn read_cells(bench: Bench, root: &Member<'_>, part: Part) -> Result<Vec<Cell>, Malformed> {
    let mut cells = Cells(Vec::new());
    match bench {
        Bench::Accels => cells.read_accels(root)?,
        Bench::Kd => cells.read_kd(root, part)?,
        Bench::Mbvh => cells.read_mbvh(&find_scene(root, part)?, part)?,
        Bench::Coherent => cells.read_coherent(&find_scene(root, part)?, part)?,
        Bench::Render => cells.read_render(&find_scene(root, part)?, part)?,
    }
    Ok(cells.0)
}

/// Whether a short run of `bench accels` measures a structure: kd-trees are those of `bench kd`.
pub fn is_quick(id: &str) -> bool {
    id != "brute" && !id.starts_with("kd-")
}

fn find_scene<'a>(root: &Member<'a>, part: Part) -> Result<Member<'a>, Malformed> {
    let scenes = root.get("scenes")?;
    let found = scenes.items()?.into_iter().nth(part.place);
    found.ok_or_else(|| scenes.wrong("has too few scenes"))
}

/// A list that grows.
struct Cells(Vec<Cell>);

impl Cells {
    fn add(&mut self, group: impl Into<String>, structure: &str, kind: Kind, value: f64) {
        let (group, structure) = (group.into(), structure.to_owned());
        self.0.push(Cell { group, structure, kind, value });
    }

    /// Members that are work.
    fn add_work(
        &mut self,
        from: &Member<'_>,
        (group, structure): (&str, &str),
        keys: &[&str],
    ) -> Result<(), Malformed> {
        for key in keys {
            let value = from.get(key)?.number()?;
            self.add(format!("{group}{key}"), structure, Kind::Work, value);
        }
        Ok(())
    }

    fn read_accels(&mut self, root: &Member<'_>) -> Result<(), Malformed> {
        for row in root.get("structures")?.items()? {
            let id = row.get("accel")?.text()?;
            if !is_quick(id) {
                continue;
            }
            for (group, key) in [("random", "random_mrays_s"), ("primary", "primary_mrays_s")] {
                self.add(group, id, Kind::Rate, row.get(key)?.positive()?);
            }
            self.add_work(&row, ("", id), &["bytes"])?;
        }
        Ok(())
    }

    fn read_kd(&mut self, root: &Member<'_>, part: Part) -> Result<(), Malformed> {
        const WORK: [&str; 5] =
            ["inner_nodes", "leaves", "triangle_tests", "triangles", "restarts"];
        for row in root.get("walks")?.items()? {
            let id = row.get("accel")?.text()?;
            self.add_work(&row, ("", id), &["bytes", "sah_cost"])?;
            for (set, figures) in row.get("sets")?.entries()? {
                self.add(set, id, Kind::Rate, figures.get("mrays_s")?.positive()?);
                if part.same_rays {
                    self.add_work(&figures, (&format!("{set}: "), id), &WORK)?;
                }
            }
        }
        Ok(())
    }

    fn read_mbvh(&mut self, scene: &Member<'_>, part: Part) -> Result<(), Malformed> {
        const WORK: [&str; 5] = ["nodes", "leaves", "empty", "sah_cost", "bytes"];
        for row in scene.get("structures")?.items()? {
            let (id, mode) = (row.get("accel")?.text()?, row.get("triangles")?.text()?);
            let name = format!("{id} {mode}");
            self.add_work(&row, ("", &name), &WORK)?;
            for kind in ["closest", "shadow"] {
                let rates = row.get(kind)?;
                for (how, key) in [("single", "single_mrays_s"), ("slices", "slices_mrays_s")] {
                    let rate = rates.get(key)?.positive()?;
                    self.add(format!("{kind}, {how}"), &name, Kind::Rate, rate);
                }
                if part.same_rays {
                    let events = Event::ALL.map(Event::name);
                    self.add_work(&rates, (&format!("{kind}: "), &name), &events)?;
                }
            }
        }
        Ok(())
    }

    fn read_coherent(&mut self, scene: &Member<'_>, part: Part) -> Result<(), Malformed> {
        let rays = scene.get("rays")?.positive()?;
        self.add_work(scene, ("", "bvh-packet"), &["bytes", "node_bytes"])?;
        for column in scene.get("columns")?.items()? {
            let name = column.get("name")?.text()?;
            let stride = part.stride.max(1);
            let (mut pictures, mut sum) = (0.0, 0.0);
            let seconds = column.get("seconds")?;
            for picture in seconds.items()?.iter().skip(stride / 2).step_by(stride) {
                sum += picture.positive()?;
                pictures += 1.0;
            }
            if pictures == 0.0 {
                return Err(seconds.wrong("has no pictures"));
            }
            self.add("pictures", name, Kind::Rate, pictures * rays * 1e-6 / sum);
            if part.same_rays {
                self.add_work(&column, ("", name), &Event::ALL.map(Event::name))?;
            }
        }
        Ok(())
    }

    fn read_render(&mut self, scene: &Member<'_>, part: Part) -> Result<(), Malformed> {
        if part.same_rays {
            self.add_work(scene, ("", "all"), &["rays"])?;
        }
        for row in scene.get("structures")?.items()? {
            let id = row.get("accel")?.text()?;
            self.add("render", id, Kind::Rate, row.get("mrays_s")?.positive()?);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const ALL: Part = Part { place: 0, stride: 1, same_rays: true };

    fn rates(cells: &[Cell]) -> Vec<f64> {
        cells.iter().filter(|cell| cell.kind == Kind::Rate).map(|cell| cell.value).collect()
    }

    #[test]
    fn a_flight_is_thinned_to_the_middle_ones() {
        let mut column = json!({ "name": "Packet", "seconds": [9.0, 1.0, 9.0, 9.0, 3.0, 9.0] });
        for event in Event::ALL {
            column[event.name()] = 5.into();
        }
        let scene = json!({ "rays": 2e6, "bytes": 7, "node_bytes": 6, "columns": [column] });
        let file = json!({ "scenes": [scene] });
        let part = Part { stride: 3, same_rays: false, ..ALL };
        let root = Member::root(&file);
        let cells = read_cells(Bench::Coherent, &root, part).expect("is well formed");
        assert_eq!((cells.len(), rates(&cells)), (3, vec![1.0]));
        let cells = read_cells(Bench::Coherent, &root, ALL).expect("is well formed");
        assert_eq!((cells.len(), rates(&cells)), (3 + Event::ALL.len(), vec![0.3]));
    }

    #[test]
    fn work_is_read_where_the_rays_are_the_same() {
        let set = json!({
            "inner_nodes": 1, "leaves": 2, "triangle_tests": 3, "triangles": 4, "restarts": 0,
            "mrays_s": 2.5,
        });
        let walk = json!({
            "accel": "kd-ropes", "bytes": 8, "sah_cost": 1.5,
            "sets": { "random": set },
        });
        let mut file = json!({ "walks": [walk] });
        let count = |file: &serde_json::Value, same_rays| {
            let part = Part { same_rays, ..ALL };
            read_cells(Bench::Kd, &Member::root(file), part).map(|cells| cells.len())
        };
        assert_eq!((count(&file, true), count(&file, false)), (Ok(8), Ok(3)));
        file["walks"][0]["sets"]["random"]["mrays_s"] = 0.into();
        let error = count(&file, true).expect_err("no rate").to_string();
        assert_eq!(error, "walks[0].sets.random.mrays_s is not above zero");
    }

    #[test]
    fn kd_trees_are_left_to_their_own_bench() {
        let row = |id: &str| {
            let rates = [("random_mrays_s", 1.0), ("primary_mrays_s", 2.0)];
            let mut row = json!({ "accel": id, "bytes": 3 });
            for (key, rate) in rates {
                row[key] = rate.into();
            }
            row
        };
        let file = json!({ "structures": [row("auto"), row("brute"), row("kd-ropes")] });
        let cells = read_cells(Bench::Accels, &Member::root(&file), ALL).expect("well formed");
        assert!(cells.iter().all(|cell| cell.structure == "auto"));
        assert_eq!(rates(&cells), [1.0, 2.0]);
    }
}
