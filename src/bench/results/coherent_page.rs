//! Barczak's tables 1 to 4, from the figures of `bench coherent`.

use super::member::{Malformed, Member};
use crate::bench::fly_through::paper;
use crate::bench::table::{Table, beside, cell, scene_label};

/// The tables by name, as Markdown.
///
/// # Errors
/// A member that is missing or of another kind.
pub fn make_tables(root: &Member<'_>) -> Result<Vec<(&'static str, String)>, Malformed> {
    let scenes = root.get("scenes")?.items()?;
    let scenes = scenes.iter().map(Scene::read).collect::<Result<Vec<_>, _>>()?;
    let make = |heading: &[&str], row: fn(&Scene) -> Vec<String>| {
        let mut table = Table::new("", "", heading);
        table.rows = scenes.iter().map(row).collect();
        table.markdown_rows()
    };
    Ok(vec![
        ("coherent-1", make(&VISITS, Scene::visits_row)),
        ("coherent-2", make(&RATES, Scene::rates_row)),
        ("coherent-3", make(&MEMORY, Scene::memory_row)),
        ("coherent-4", make(&PARTITION, Scene::partition_row)),
    ])
}

const VISITS: [&str; 8] =
    ["", "packets", "EP", "EP searched", "PC", "PC searched", "EP over packets", "PC over packets"];
const RATES: [&str; 8] = ["", "packets", "EP", "PC", "EP S", "EP S, most", "PC S", "PC S, most"];
const MEMORY: [&str; 6] = ["", "MB", "mean %", "most %", "pool %", "recursion over iteration"];
const PARTITION: [&str; 6] = ["", "partition", "PC", "S", "bvh2 PC", "bvh2 S"];

/// A structure's figures over a flight.
struct Column {
    /// Nodes a picture, looked for and walked, in thousands.
    searched: f64,
    walked: f64,
    rate: f64,
    /// Seconds of each picture.
    seconds: Vec<f64>,
}

impl Column {
    fn read(member: &Member<'_>) -> Result<Self, Malformed> {
        let list = member.get("seconds")?;
        let seconds: Vec<f64> =
            list.items()?.iter().map(Member::positive).collect::<Result<_, _>>()?;
        if seconds.is_empty() {
            return Err(list.wrong("has no pictures"));
        }
        let pictures = seconds.len() as f64;
        let thousands =
            |key: &str| Ok::<_, Malformed>(member.get(key)?.number()? * 1e-3 / pictures);
        Ok(Self {
            searched: thousands("searched_nodes")?,
            walked: thousands("inner_nodes")? + thousands("leaves")?,
            rate: member.get("mrays_s")?.positive()?,
            seconds,
        })
    }

    /// How many times as fast as another: over all pictures, and at most.
    fn speed_up(&self, over: &Self) -> [f64; 2] {
        let sum = |column: &Self| column.seconds.iter().sum::<f64>();
        let pairs = over.seconds.iter().zip(&self.seconds);
        [sum(over) / sum(self), pairs.map(|(theirs, ours)| theirs / ours).fold(0.0, f64::max)]
    }
}

/// A scene, and the paper's of its size.
struct Scene {
    label: String,
    paper: Option<&'static paper::Scene>,
    packet: Column,
    entry: Column,
    compressed: Column,
    partition: [Column; 2],
    single: [Column; 2],
    megabytes: f64,
    pool: [f64; 3],
    compressing: f64,
}

impl Scene {
    fn read(member: &Member<'_>) -> Result<Self, Malformed> {
        let triangles = member.get("triangles")?.count()? as usize;
        let paper = paper::Scene::of(triangles);
        let name = member.get("name")?.text()?;
        let columns = member.get("columns")?;
        let column = |name: &str| {
            for column in columns.items()? {
                if column.get("name")?.text()? == name {
                    return Column::read(&column);
                }
            }
            Err(columns.wrong(format!("lacks {name}")))
        };
        let pool = member.get("pool_percent")?;
        let share = |key: &str| pool.get(key)?.number();
        let [iterative, recursive] =
            ["iterative_s", "recursive_s"].map(|key| member.get(key)?.positive());
        Ok(Self {
            label: scene_label(name, triangles, paper.map(|paper| paper.name)),
            paper,
            packet: column("Packet")?,
            entry: column("EntryPoint")?,
            compressed: column("Compressed")?,
            partition: [column("Partition")?, column("PartitionCompressed")?],
            single: [column("Single")?, column("SingleCompressed")?],
            megabytes: member.get("node_bytes")?.number()? * 1e-6,
            pool: [share("mean")?, share("max")?, share("pool")?],
            compressing: recursive? / iterative?,
        })
    }

    /// Our figure beside one of the paper's.
    fn beside(
        &self,
        ours: f64,
        theirs: impl Fn(&paper::Scene) -> f64,
        decimals: [usize; 2],
    ) -> String {
        beside(ours, self.paper.map(theirs), decimals)
    }

    /// Table 1.
    fn visits_row(&self) -> Vec<String> {
        let [packet, entry, compressed] = [&self.packet, &self.entry, &self.compressed];
        let over = |one: &Column| (one.searched + one.walked) / packet.walked.max(1e-9);
        vec![
            self.label.clone(),
            self.beside(packet.walked, |p| p.visits[0], [0, 0]),
            self.beside(entry.walked, |p| p.visits[1], [0, 0]),
            self.beside(entry.searched, |p| p.searched[0], [1, 1]),
            self.beside(compressed.walked, |p| p.visits[2], [0, 0]),
            self.beside(compressed.searched, |p| p.searched[1], [1, 1]),
            self.beside(over(entry), |p| p.ratios[0], [2, 2]),
            self.beside(over(compressed), |p| p.ratios[1], [2, 2]),
        ]
    }

    /// Table 2.
    fn rates_row(&self) -> Vec<String> {
        let [packet, entry, compressed] = [&self.packet, &self.entry, &self.compressed];
        let mut row = vec![self.label.clone()];
        for (i, column) in [packet, entry, compressed].into_iter().enumerate() {
            row.push(self.beside(column.rate, |p| p.rates[i], [2, 2]));
        }
        for (i, column) in [entry, compressed].into_iter().enumerate() {
            let [mean, most] = column.speed_up(packet);
            row.push(self.beside(mean, |p| p.speed_ups[i][0], [2, 2]));
            row.push(self.beside(most, |p| p.speed_ups[i][1], [2, 2]));
        }
        row
    }

    /// Table 3.
    fn memory_row(&self) -> Vec<String> {
        let mut row = vec![self.label.clone()];
        row.push(self.beside(self.megabytes, |p| p.megabytes, [2, 2]));
        for (i, share) in self.pool.into_iter().enumerate() {
            row.push(self.beside(share, |p| p.pool[i], [2, 2]));
        }
        row.push(self.beside(self.compressing, |_| paper::ITERATIVE, [2, 1]));
        row
    }

    /// Table 4.
    fn partition_row(&self) -> Vec<String> {
        let [from, with] = &self.partition;
        let [single, single_with] = &self.single;
        vec![
            self.label.clone(),
            self.beside(from.rate, |p| p.partition[0], [2, 2]),
            self.beside(with.rate, |p| p.partition[1], [2, 2]),
            self.beside(with.speed_up(from)[0], |p| p.partition_speed_up, [2, 2]),
            cell(Some(single_with.rate), 2),
            cell(Some(single_with.speed_up(single)[0]), 2),
        ]
    }
}
