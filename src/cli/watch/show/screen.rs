//! Draws in place: each picture over the one before, if nothing has been printed since.

use std::io::stderr;

use super::detect::Way;
use super::thumbnail::Thumbnail;
use super::{blocks, iterm, kitty, sixel};
use crate::cli::console;
use crate::film::{Picture, Tonemap, png};

/// Pixels of a cell that the PNGs of `kitty` and `iterm` are made for. The terminal scales them to
/// the rows that they are to have.
const PNG_CELL: (usize, usize) = (8, 16);
/// Pixels of a cell that sixels are made for. They are not scaled, and must not need more rows than
/// were made free: cells are seldom smaller.
const SIXEL_CELL: (usize, usize) = (6, 12);
/// Rows that are left free: for a bar, and for the cursor.
const ROWS_BELOW: usize = 3;
/// The size of a terminal that does not tell.
const USUAL_SIZE: (usize, usize) = (80, 24);

/// Where pictures are shown.
pub struct Screen {
    way: Way,
    tonemap: Tonemap,
    exposure: f32,
    /// Rows of the last picture, and how many lines had been printed by then.
    drawn: Option<(usize, u64)>,
}

impl Screen {
    /// A screen without a picture; pictures look as the PNG does.
    pub fn new(way: Way, tonemap: Tonemap, exposure: f32) -> Self {
        Self { way, tonemap, exposure, drawn: None }
    }

    /// Shows a picture. That it cannot is no reason to stop.
    pub fn show(&mut self, picture: &Picture) {
        let Some((bytes, rows)) = self.encode(picture, terminal_size()) else { return };
        let lines = console::lines();
        let above = self.drawn == Some((rows, lines));
        if console::draw(place(&bytes, rows, above).as_bytes()).is_ok() {
            self.drawn = Some((rows, lines));
        }
    }

    /// The bytes of a picture, and the rows that they need, for a terminal of so many columns and
    /// rows.
    fn encode(&self, picture: &Picture, size: (usize, usize)) -> Option<(String, usize)> {
        let rows = size.1.saturating_sub(ROWS_BELOW).max(1);
        // The terminal chooses how wide a PNG of so many rows is: its cells may be narrow ones.
        let columns = if matches!(self.way, Way::Blocks) { size.0 } else { size.0 * 9 / 10 };
        let cell = match self.way {
            Way::Kitty | Way::Iterm => PNG_CELL,
            Way::Sixel => SIXEL_CELL,
            Way::Blocks => (1, 2),
        };
        let most = (columns * cell.0, rows * cell.1);
        let small = Thumbnail::new(picture, most, self.tonemap, self.exposure)?;
        let rows = small.height.div_ceil(cell.1);
        let png = || png::encode_rgb8(small.width, small.height, &small.pixels).ok();
        let bytes = match self.way {
            Way::Kitty => kitty::encode(&png()?, rows, std::process::id()),
            Way::Iterm => iterm::encode(&png()?, rows),
            Way::Sixel => sixel::encode(&small),
            Way::Blocks => blocks::encode(&small),
        };
        Some((bytes, rows))
    }
}

/// Puts a picture of so many rows over the one above, or below all that is there. The cursor is at
/// the start of a line, and ends at that below the picture.
fn place(picture: &str, rows: usize, above: bool) -> String {
    // Where the screen must scroll it does so first: then it keeps still, and the place of the
    // corner that the terminal remembers stays right.
    let room = if above { String::new() } else { "\r\n".repeat(rows) };
    format!("\r{room}\x1b[{rows}A\x1b7{picture}\x1b8\x1b[{rows}B\r")
}

fn terminal_size() -> (usize, usize) {
    terminal_size::terminal_size_of(stderr())
        .map_or(USUAL_SIZE, |(width, height)| (width.0.into(), height.0.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Window;

    fn picture() -> Picture {
        let window = Window::of_size(400, 100);
        let mut picture = Picture::new(window, window);
        picture.set_aov("", "RGB", &vec![[0.5, 0.25, 1.0]; 400 * 100]);
        picture
    }

    fn encoded(way: Way) -> (String, usize) {
        let screen = Screen::new(way, Tonemap::Srgb, 0.0);
        screen.encode(&picture(), (40, 24)).expect("colours")
    }

    #[test]
    fn every_way_shows_the_whole_width() {
        let (blocks, rows) = encoded(Way::Blocks);
        assert_eq!((blocks.matches('▀').count(), rows), (40 * 5, 5));
        let (sixels, rows) = encoded(Way::Sixel);
        assert!(sixels.starts_with("\x1bP0;1q\"1;1;216;54") && rows == 5, "{rows}");
        for way in [Way::Kitty, Way::Iterm] {
            let (text, rows) = encoded(way);
            assert_eq!(rows, 5, "{way:?}");
            let key = if way == Way::Kitty { ",r=5," } else { ";height=5;" };
            assert!(text.contains(key), "{way:?}");
        }
    }

    #[test]
    fn a_picture_takes_its_room_once() {
        assert_eq!(place("P", 2, false), "\r\r\n\r\n\x1b[2A\x1b7P\x1b8\x1b[2B\r");
        assert_eq!(place("P", 2, true), "\r\x1b[2A\x1b7P\x1b8\x1b[2B\r");
    }
}
