//! Ernst and Greiner's figure 1, from the figures of `bench render`.

use super::member::{Malformed, Member};
use crate::bench::mbvh::paper;
use crate::bench::table::{Table, beside, cell, scene_label};

/// The table by name, as Markdown.
///
/// # Errors
/// A member that is missing or of another kind.
pub fn make_tables(root: &Member<'_>) -> Result<Vec<(&'static str, String)>, Malformed> {
    let mut table = Table::new("", "", &["", "million rays"]);
    for scene in root.get("scenes")?.items()? {
        let triangles = scene.get("triangles")?.count()? as usize;
        let paper = paper::Scene::of(triangles);
        let name = scene.get("name")?.text()?;
        let rays = scene.get("rays")?.positive()? * 1e-6;
        let label = scene_label(name, triangles, paper.map(|paper| paper.name));
        let mut row = vec![label, cell(Some(rays), 1)];
        let structures = scene.get("structures")?.items()?;
        for (i, structure) in structures.iter().enumerate() {
            let id = structure.get("accel")?.text()?;
            let heading = if i == 0 { format!("{id} s") } else { id.to_owned() };
            let column = i + 2;
            match table.heading.get(column) {
                None => table.heading.push(heading),
                Some(known) if *known == heading => {}
                Some(known) => return Err(structure.wrong(format!("is not {known}, as above"))),
            }
            row.push(if i == 0 {
                cell(Some(structure.get("render_s")?.positive()?), 1)
            } else {
                let theirs = paper.filter(|_| id.starts_with("mbvh4"));
                let theirs = theirs.map(|paper| paper.render_speed_up);
                beside(structure.get("speed_up")?.positive()?, theirs, [2, 2])
            });
        }
        table.rows.push(row);
    }
    Ok(vec![("render", table.markdown_rows())])
}
