//! Half blocks in true colour: two pixels to a cell.

use std::fmt::Write;

use super::thumbnail::Thumbnail;

/// The bytes that show a picture at the cursor, a line for two rows of pixels. The lower half of
/// the last line is black if there is no row for it.
pub fn encode(picture: &Thumbnail) -> String {
    let mut text = String::new();
    for y in (0..picture.height).step_by(2) {
        if y > 0 {
            text.push_str("\r\n");
        }
        let mut last = None;
        for x in 0..picture.width {
            let below = if y + 1 < picture.height { picture.at(x, y + 1) } else { [0; 3] };
            let colours = (picture.at(x, y), below);
            if last != Some(colours) {
                let ([r, g, b], [below_r, below_g, below_b]) = colours;
                let below = format_args!("{below_r};{below_g};{below_b}");
                // Writing to a string cannot fail.
                let _ = write!(text, "\x1b[38;2;{r};{g};{b};48;2;{below}m");
                last = Some(colours);
            }
            text.push('▀');
        }
        text.push_str("\x1b[0m");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_has_two_pixels_and_colours_are_said_once() {
        let pixels = vec![[1, 2, 3], [1, 2, 3], [4, 5, 6], [4, 5, 6], [7, 8, 9], [0, 0, 0]];
        let text = encode(&Thumbnail { width: 2, height: 3, pixels });
        let first = "\x1b[38;2;1;2;3;48;2;4;5;6m▀▀\x1b[0m";
        let second = "\x1b[38;2;7;8;9;48;2;0;0;0m▀\x1b[38;2;0;0;0;48;2;0;0;0m▀\x1b[0m";
        assert_eq!(text, format!("{first}\r\n{second}"));
    }
}
