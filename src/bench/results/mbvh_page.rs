//! Ernst and Greiner's tables 1 to 4 and figure 4, from the figures of `bench mbvh`.

use super::member::{Malformed, Member};
use crate::bench::mbvh::paper;
use crate::bench::table::{Table, beside, cell, scene_label};

/// The tables by name, as Markdown.
///
/// # Errors
/// A member that is missing or of another kind.
pub fn make_tables(root: &Member<'_>) -> Result<Vec<(&'static str, String)>, Malformed> {
    let scenes = root.get("scenes")?.items()?;
    let scenes = scenes.into_iter().map(Scene::read).collect::<Result<Vec<_>, _>>()?;
    let builds = make(&scenes, &BUILDS, Scene::build_rows)?;
    let rates = make(&scenes, &RATES, Scene::rates_rows)?;
    let caches = make(&scenes, &CACHES, Scene::cache_rows)?;
    let widths = make(&scenes, &WIDTHS, Scene::width_rows)?;
    let incoherence = make(&scenes, &INCOHERENCE, Scene::incoherence_rows)?;
    Ok(vec![
        ("mbvh-1", builds),
        ("mbvh-2", rates),
        ("mbvh-3", caches),
        ("mbvh-4", widths),
        ("mbvh-figure-4", incoherence),
    ])
}

const BUILDS: [&str; 8] =
    ["", "tree s", "collapse s", "thousands of leaves", "empty", "mean leaf", "mean depth", "MB"];
const RATES: [&str; 8] = ["", "bvh2", "mbvh4", "S", "tests", "boxes", "H", "S by slices"];
const CACHES: [&str; 4] = ["MB", "H", "krays/s", "by slices"];
const WIDTHS: [&str; 8] =
    ["", "bvh2", "mbvh4", "mbvh8", "mbvh16", "slices mbvh4", "slices mbvh8", "slices mbvh16"];
const INCOHERENCE: [&str; 5] =
    ["", "over mbvh4, I = 0", "over mbvh4, I = 1", "below mbvh4", "below bvh2"];

/// Rows of a table.
type Rows = Vec<Vec<String>>;

fn make<'a>(
    scenes: &[Scene<'a>],
    heading: &[&str],
    rows: fn(&Scene<'a>) -> Result<Rows, Malformed>,
) -> Result<String, Malformed> {
    let mut table = Table::new("", "", heading);
    for scene in scenes {
        table.rows.extend(rows(scene)?);
    }
    Ok(table.markdown_rows())
}

/// A scene, and the paper's of its size.
struct Scene<'a> {
    member: Member<'a>,
    label: String,
    paper: Option<&'static paper::Scene>,
}

impl<'a> Scene<'a> {
    fn read(member: Member<'a>) -> Result<Self, Malformed> {
        let triangles = member.get("triangles")?.count()? as usize;
        let paper = paper::Scene::of(triangles);
        let name = member.get("name")?.text()?;
        let label = scene_label(name, triangles, paper.map(|paper| paper.name));
        Ok(Self { member, label, paper })
    }

    /// A structure by id and by what its leaves hold.
    fn structure(&self, id: &str, mode: &str) -> Result<Member<'a>, Malformed> {
        let structures = self.member.get("structures")?;
        for structure in structures.items()? {
            if structure.get("accel")?.text()? == id && structure.get("triangles")?.text()? == mode
            {
                return Ok(structure);
            }
        }
        Err(structures.wrong(format!("lacks {id} with triangles={mode}")))
    }

    /// Table 1.
    fn build_rows(&self) -> Result<Rows, Malformed> {
        let mut rows = Vec::new();
        for (which, id) in ["bvh2", "mbvh4"].into_iter().enumerate() {
            let ours = self.structure(id, "cache")?;
            let theirs = self.paper.map(|paper| paper.built[which]);
            let wide = which == 1;
            let of = |key: &str| ours.get(key)?.number();
            let optional = |ours: f64, theirs, decimals| {
                if wide { beside(ours, theirs, decimals) } else { String::new() }
            };
            rows.push(vec![
                format!("{}: {id}", self.label),
                beside(of("tree_s")?, theirs.map(|built| built.tree_seconds), [2, 1]),
                optional(
                    of("collapse_s")?,
                    theirs.and_then(|built| built.collapse_seconds),
                    [3, 2],
                ),
                beside(of("leaves")? * 1e-3, theirs.map(|built| built.leaves), [0, 0]),
                optional(of("empty")? * 1e-3, theirs.and_then(|built| built.empty), [0, 0]),
                beside(of("mean_leaf")?, theirs.map(|built| built.mean_leaf), [1, 1]),
                beside(of("mean_depth")?, theirs.map(|built| built.mean_depth), [1, 1]),
                beside(of("bytes")? * 1e-6, theirs.map(|built| built.megabytes), [1, 1]),
            ]);
        }
        Ok(rows)
    }

    /// Table 2.
    fn rates_rows(&self) -> Result<Rows, Malformed> {
        let (binary, wide) = (self.structure("bvh2", "cache")?, self.structure("mbvh4", "cache")?);
        let mut rows = Vec::new();
        for (kind, shown) in [("shadow", "shadow rays"), ("closest", "nearest hits")] {
            let (binary, wide) = (binary.get(kind)?, wide.get(kind)?);
            let pair = self.paper.map(|paper| match kind {
                "shadow" => paper.shadow,
                _ => paper.closest,
            });
            let rate = |of: &Member<'_>, key: &str| of.get(key)?.positive();
            let [one, four] = [&binary, &wide].map(|of| rate(of, "single_mrays_s"));
            let [slices, wide_slices] = [&binary, &wide].map(|of| rate(of, "slices_mrays_s"));
            let (one, four) = (one?, four?);
            let of = |key: &str| wide.get(key)?.number();
            let theirs = |of: fn(&paper::Shot) -> f64| pair.map(|pair| of(&pair[1]));
            let hits = pair.and_then(|pair| pair[1].hit_rate);
            rows.push(vec![
                format!("{}: {shown}", self.label),
                beside(one * 1e3, pair.map(|pair| pair[0].krays), [0, 0]),
                beside(four * 1e3, theirs(|shot| shot.krays), [0, 0]),
                beside(four / one, pair.map(|pair| paper::speed_up(&pair)), [2, 2]),
                beside(of("triangle_tests")?, theirs(|shot| shot.triangle_tests), [1, 1]),
                beside(of("box_tests")?, theirs(|shot| shot.box_tests), [1, 1]),
                beside(of("hit_rate")? * 100.0, hits, [1, 1]),
                cell(Some(wide_slices? / slices?), 2),
            ]);
        }
        Ok(rows)
    }

    /// Table 3; of a scene without caches nothing.
    fn cache_rows(&self) -> Result<Rows, Malformed> {
        let row = |cache: &Member<'_>| {
            let (megabytes, closest) = (cache.get("mb")?.count()?, cache.get("closest")?);
            let theirs = paper::CACHES.iter().find(|(size, ..)| *size == megabytes);
            let theirs = theirs.filter(|_| self.paper.is_some());
            let rate = |key: &str| Ok::<_, Malformed>(closest.get(key)?.positive()? * 1e3);
            let hits = closest.get("hit_rate")?.number()? * 100.0;
            Ok(vec![
                megabytes.to_string(),
                beside(hits, theirs.map(|(_, hits, _)| *hits), [1, 1]),
                beside(rate("single_mrays_s")?, theirs.map(|(.., krays)| *krays), [0, 0]),
                cell(Some(rate("slices_mrays_s")?), 0),
            ])
        };
        self.member.get("caches")?.items()?.iter().map(row).collect()
    }

    /// Table 4: the rates of wide trees over the binary one's; the paper's are what vectors might
    /// make of its simulation.
    fn width_rows(&self) -> Result<Rows, Malformed> {
        let rate = |id: &str, key: &str| {
            self.structure(id, "inline")?.get("closest")?.get(key)?.positive()
        };
        let (single, slices) = ("single_mrays_s", "slices_mrays_s");
        let binary = rate("bvh2", single)?;
        let theirs = self.paper.map(|paper| paper.closest[0].krays);
        let mut row = vec![self.label.clone(), beside(binary * 1e3, theirs, [0, 0])];
        const WIDE: [&str; 3] = ["mbvh4", "mbvh8", "mbvh16"];
        for (i, id) in WIDE.into_iter().enumerate() {
            let potential = self.paper.and_then(|paper| paper.potential);
            let theirs = potential.map(|potential| potential[i]);
            row.push(beside(rate(id, single)? / binary, theirs, [2, 2]));
        }
        for id in WIDE {
            row.push(cell(Some(rate(id, slices)? / rate("bvh2", slices)?), 2));
        }
        Ok(vec![row])
    }

    /// Figure 4: packets over single rays, and from where on they are slower.
    fn incoherence_rows(&self) -> Result<Rows, Malformed> {
        let mut points = Vec::new();
        for point in self.member.get("incoherence")?.items()? {
            let rates = point.get("mrays_s")?;
            let [packets, binary, wide] = ["bvh-packet", "bvh2", "mbvh4"]
                .map(|id| rates.get(id).and_then(|rate| rate.positive()));
            let packets = packets?;
            points.push((point.get("i")?.number()?, packets / binary?, packets / wide?));
        }
        let below = |over: fn(&(f64, f64, f64)) -> f64| {
            let first = points.iter().find(|point| over(point) < 1.0);
            first.map_or("nowhere".to_owned(), |point| format!("I = {}", short(point.0)))
        };
        let mut row = vec![self.label.clone()];
        row.extend([points.first(), points.last()].map(|point| cell(point.map(|p| p.2), 2)));
        row.extend([below(|point| point.2), below(|point| point.1)]);
        Ok(vec![row])
    }
}

/// A degree of incoherence, which is written as a `f32`.
fn short(value: f64) -> String {
    (value as f32).to_string()
}
