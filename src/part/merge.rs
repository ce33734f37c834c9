//! Adds up parts, tile by tile.
//!
//! No more than a row of tiles is in memory, however many parts there are.

use std::io::{self, Write};
use std::ops::Range;
use std::path::PathBuf;

use rayon::prelude::*;

use super::error::PartError;
use super::file::{EncodedTile, Part, PartWriter};
use super::head::Head;
use super::plan::{Cell, Chain, Gap, Plan};
use crate::film::Window;
use crate::render::Tile;

/// Parts of one picture that fit each other.
#[derive(Debug)]
pub struct Merge {
    parts: Vec<Part>,
    plan: Plan,
    wanted: Range<u64>,
}

impl Merge {
    /// Reads heads and indices of parts, and works out how they add up: to a picture from its first
    /// sample to its last, or to a larger part.
    ///
    /// # Errors
    /// [`PartError`]: one that cannot be read, parts of two pictures, or parts that overlap. Gaps
    /// are no error here.
    pub fn new(paths: &[PathBuf], to_picture: bool) -> Result<Self, PartError> {
        let parts: Vec<Part> =
            paths.iter().map(|path| Part::open(path)).collect::<Result<_, _>>()?;
        if let Some((first, others)) = parts.split_first() {
            for other in others {
                first.head.require_same(&other.head, (first.path(), other.path()))?;
            }
        }
        let samples = || parts.iter().map(|part| part.head.samples());
        let last = samples().map(|it| it.end).max().unwrap_or(0);
        let wanted = if to_picture {
            0..parts.iter().map(|part| part.head.spp).max().unwrap_or(0).max(last)
        } else {
            samples().map(|it| it.start).min().unwrap_or(0)..last
        };
        let plan = Plan::new(&parts, &wanted)?;
        Ok(Self { parts, plan, wanted })
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// What is missing.
    pub fn gaps(&self) -> &[Gap] {
        &self.plan.gaps
    }

    /// Pairs of parts that have the same samples.
    pub fn repeated(&self) -> impl Iterator<Item = (&Part, &Part)> {
        self.plan.repeated.iter().map(|&(a, b)| (&self.parts[a], &self.parts[b]))
    }

    /// Whether every pixel has the same samples, so that what there is makes a picture.
    pub fn is_even(&self) -> bool {
        self.plan.is_even(&self.parts)
    }

    /// The head of the part, or of the picture, that these add up to.
    pub fn head(&self) -> Head {
        let mut head = self.parts[0].head.clone();
        head.set_crop(self.plan.window);
        head.set_samples(&self.wanted);
        head.spp = self.parts.iter().map(|part| part.head.spp).max().unwrap_or(0);
        head.spp = head.spp.max(self.wanted.end);
        head.render_s = self.fresh_parts().map(|part| part.head.render_s).sum();
        head
    }

    /// How many samples were not finite.
    pub fn lost_count(&self) -> u64 {
        self.fresh_parts().map(Part::lost_count).sum()
    }

    /// The parts that do not repeat others.
    fn fresh_parts(&self) -> impl Iterator<Item = &Part> {
        let repeats = |at: usize| self.plan.repeated.iter().any(|&(_, later)| later == at);
        self.parts.iter().enumerate().filter(move |&(at, _)| !repeats(at)).map(|(_, part)| part)
    }

    /// Adds up the tiles that have pixels in some rows of the frame.
    ///
    /// # Errors
    /// [`PartError::Damaged`], or [`PartError::Differ`].
    pub fn tiles_of_rows(&self, rows: Range<i32>) -> Result<Vec<Tile>, PartError> {
        let reach = |window: Window| window.y0 < rows.end && window.y1 > rows.start;
        let cells: Vec<&Cell> = self.plan.cells.iter().filter(|cell| reach(cell.window)).collect();
        cells.into_par_iter().map(|cell| self.add_up(cell)).collect()
    }

    /// Writes the part that these add up to.
    ///
    /// # Errors
    /// [`PartError`] of reading, or else that of writing.
    pub fn write_part(&self, out: impl Write) -> Result<io::Result<()>, PartError> {
        let mut writer = match PartWriter::new(out, &self.head()) {
            Ok(writer) => writer,
            Err(error) => return Ok(Err(error)),
        };
        let rows = self.plan.cells.chunk_by(|a, b| a.window.y0 == b.window.y0);
        for row in rows {
            let tiles: Result<Vec<EncodedTile>, PartError> =
                row.par_iter().map(|cell| Ok(EncodedTile::new(&self.add_up(cell)?))).collect();
            for tile in tiles? {
                if let Err(error) = writer.add(&tile) {
                    return Ok(Err(error));
                }
            }
        }
        Ok(writer.finish())
    }

    /// Adds up the tiles that make a cell.
    fn add_up(&self, cell: &Cell) -> Result<Tile, PartError> {
        let tiles: Vec<Tile> =
            cell.chains.iter().map(|chain| self.follow(chain)).collect::<Result<_, _>>()?;
        match <[Tile; 1]>::try_from(tiles) {
            Ok([tile]) if tile.window == cell.window => Ok(tile),
            Ok([tile]) => Ok(Tile::assemble(cell.window, vec![tile])),
            Err(tiles) => Ok(Tile::assemble(cell.window, tiles)),
        }
    }

    /// Adds up the tiles of a chain.
    fn follow(&self, chain: &Chain) -> Result<Tile, PartError> {
        let mut sum: Option<Tile> = None;
        let mut last: Option<(usize, Tile)> = None;
        for link in &chain.links {
            let tile = self.parts[link.part].read(link.tile)?;
            if let Some((part, before)) = last.as_ref().filter(|_| link.repeats) {
                if let Some((x, y)) = before.find_difference(&tile) {
                    let file = |part: usize| self.parts[part].path().to_owned();
                    return Err(PartError::Differ { a: file(*part), b: file(link.part), x, y });
                }
                continue;
            }
            match &mut sum {
                None => sum = Some(tile.clone()),
                Some(sum) => {
                    sum.pass_over(tile.range.start);
                    sum.append(&tile).map_err(|error| {
                        let file = self.parts[link.part].path();
                        PartError::damaged(
                            file,
                            &format!("the tile {}", chain.window),
                            error.to_string(),
                        )
                    })?;
                }
            }
            last = Some((link.part, tile));
        }
        Ok(sum.unwrap_or_else(|| Tile::new(chain.window, self.wanted.start)))
    }
}
