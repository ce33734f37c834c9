//! The picture that parts add up to, some lines at a time.

use std::collections::BTreeMap;
use std::path::Path;

use toml::{Table as TomlTable, Value};

use super::args::MergeArgs;
use crate::cli::error::CliError;
use crate::cli::render::Header;
use crate::cli::shell;
use crate::film::exr::{self, Layout, RowsError};
use crate::film::{FilmError, Picture, Tonemap, Window, png};
use crate::part::{Head, Merge, PartError};
use crate::render::{Aov, Layers, SIDE, Settings, Tile};

/// Writes the picture, and a PNG of it, as asked for.
pub fn write(args: &MergeArgs, merge: &Merge) -> Result<(), CliError> {
    let head = merge.head();
    let mut header = Header::of_parts(&head, merge.lost_count(), &shell::own_words());
    if args.reproducible {
        header.make_reproducible();
    }
    header.set_unfinished(!merge.gaps().is_empty());
    let settings = settings(&head, header.is_reproducible());
    let layers = Layers::new(&settings);
    let mut lines = Lines { merge, layers: &layers, kept: Vec::new() };
    let frame = Window::of_size(head.resolution.0 as usize, head.resolution.1 as usize);
    let mut colours = args.png.as_ref().map(|_| Colours::new(head.crop()));
    let mut rows = |window: Window| {
        let planes = lines.draw(window)?;
        if let Some(colours) = &mut colours {
            colours.add(&layers, &planes);
        }
        Ok::<_, PartError>(lines.sort(planes))
    };
    let written = match &args.output {
        Some(path) => {
            let strings: BTreeMap<_, _> = header.strings().into_iter().collect();
            let mut channels: Vec<&str> = layers.names().collect();
            channels.sort_unstable();
            let layout = Layout { frame, crop: head.crop(), strings: &strings, channels };
            exr::write_rows(path, &layout, rows).map_err(|error| tell(path, error))
        }
        None => read_all(head.crop(), &mut rows).map_err(CliError::from),
    };
    written?;
    let Some((path, colours)) = args.png.as_deref().zip(colours) else { return Ok(()) };
    let picture = colours.into_picture(frame, head.crop());
    let (tonemap, exposure) = look(args, &head);
    let as_told = (args.tonemap, args.exposure) == (None, None);
    let label = header.label().filter(|_| as_told);
    png::write(path, &picture, tonemap, exposure, label.as_deref()).map_err(CliError::from)
}

/// Reads all rows, for what is not written.
fn read_all(
    crop: Window,
    rows: &mut impl FnMut(Window) -> Result<Vec<Vec<f32>>, PartError>,
) -> Result<(), PartError> {
    let starts = (crop.y0..crop.y1).step_by(SIDE as usize);
    starts
        .map(|y0| Window { y0, y1: (y0 + SIDE as i32).min(crop.y1), ..crop })
        .try_for_each(|window| rows(window).map(drop))
}

fn tell(path: &Path, error: RowsError<PartError>) -> CliError {
    match error {
        RowsError::Rows(error) => error.into(),
        RowsError::Format(message) => FilmError::invalid(path, message).into(),
        RowsError::Io(source) => CliError::not_written(path, &source),
    }
}

/// The settings that decide on the layers.
fn settings(head: &Head, is_reproducible: bool) -> Settings {
    let told = told(head);
    let (width, height) = head.resolution;
    let mut settings = Settings::new(width, height);
    settings.crop = head.crop();
    if let Some(Value::Array(layers)) = told.get("aov") {
        let names = layers.iter().filter_map(Value::as_str);
        settings.aovs = names.filter_map(|name| name.parse::<Aov>().ok()).collect();
    }
    settings.aovs.retain(|aov| *aov != Aov::Cost || !is_reproducible);
    settings.transport.transparent = told.get("transparent").and_then(Value::as_bool) == Some(true);
    settings
}

/// How the PNG shows light.
fn look(args: &MergeArgs, head: &Head) -> (Tonemap, f32) {
    let told = told(head);
    let tonemap = told.get("tonemap").and_then(Value::as_str).and_then(|name| name.parse().ok());
    let exposure = told.get("exposure").and_then(Value::as_float).map(|stops| stops as f32);
    let tonemap = args.tonemap.or(tonemap).unwrap_or_default();
    (tonemap, args.exposure.or(exposure).unwrap_or_default())
}

/// The settings that the parts were rendered with.
fn told(head: &Head) -> TomlTable {
    head.settings.parse().unwrap_or_default()
}

/// Draws lines of the picture from tiles.
struct Lines<'a> {
    merge: &'a Merge,
    layers: &'a Layers,
    /// The last row of tiles: lines may begin in the middle of one.
    kept: Vec<Tile>,
}

impl Lines<'_> {
    /// The values of each layer's channel in a window as wide as the picture.
    fn draw(&mut self, window: Window) -> Result<Vec<Vec<f32>>, PartError> {
        let reach = |tile: &Tile| tile.window.y1 > window.y0;
        self.kept.retain(reach);
        let next = self.kept.iter().map(|tile| tile.window.y1).max().unwrap_or(window.y0);
        if next < window.y1 {
            self.kept.extend(self.merge.tiles_of_rows(next..window.y1)?);
        }
        let mut planes = self.layers.blank(window);
        for tile in &self.kept {
            self.layers.draw(tile, window, &mut planes);
        }
        Ok(planes)
    }

    /// The planes in the order of their names.
    fn sort(&self, planes: Vec<Vec<f32>>) -> Vec<Vec<f32>> {
        let mut named: Vec<_> = self.layers.names().zip(planes).collect();
        named.sort_by_key(|(name, _)| *name);
        named.into_iter().map(|(_, plane)| plane).collect()
    }
}

/// The colours of a picture: what a PNG shows.
struct Colours {
    /// Red, green, blue and alpha.
    planes: [Vec<f32>; 4],
}

/// The channels of a PNG.
const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

impl Colours {
    fn new(crop: Window) -> Self {
        Self { planes: std::array::from_fn(|_| Vec::with_capacity(crop.area())) }
    }

    fn add(&mut self, layers: &Layers, planes: &[Vec<f32>]) {
        for (name, plane) in layers.names().zip(planes) {
            if let Some(at) = CHANNELS.iter().position(|channel| *channel == name) {
                self.planes[at].extend_from_slice(plane);
            }
        }
    }

    fn into_picture(self, frame: Window, crop: Window) -> Picture {
        let mut picture = Picture::new(frame, crop);
        for (name, plane) in CHANNELS.into_iter().zip(self.planes) {
            picture.set_channel(name, plane);
        }
        picture
    }
}
