//! Sixels: bands of six rows, a layer for each colour, as of DEC's VT340.

use std::fmt::Write;

use super::thumbnail::Thumbnail;

/// Steps of red, green and blue in the palette.
const STEPS: usize = 6;
/// Colours of the palette; a VT340's successors have 256.
const COLOURS: usize = STEPS * STEPS * STEPS;

/// B. E. Bayer's ordered dither: thresholds that are spread evenly over sixteen pixels. It does not
/// depend on neighbours, so a picture that changes little flickers little.
const BAYER: [[u16; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// The bytes that show a picture at the cursor.
pub fn encode(picture: &Thumbnail) -> String {
    let (width, height) = (picture.width, picture.height);
    let mut text = format!("\x1bP0;1q\"1;1;{width};{height}");
    let indices: Vec<usize> = (0..width * height)
        .map(|place| index_of(picture.pixels[place], place % width, place / width))
        .collect();
    for index in colours_of(&indices) {
        let [r, g, b] = percents_of(index);
        // Writing to a string cannot fail.
        let _ = write!(text, "#{index};2;{r};{g};{b}");
    }
    for (number, band) in indices.chunks(6 * width).enumerate() {
        if number > 0 {
            text.push('-');
        }
        push_band(&mut text, band, width);
    }
    text.push_str("\x1b\\");
    text
}

/// The layers of up to six rows.
fn push_band(text: &mut String, band: &[usize], width: usize) {
    for (number, colour) in colours_of(band).enumerate() {
        if number > 0 {
            text.push('$');
        }
        let _ = write!(text, "#{colour}");
        let sixels = (0..width).map(|x| {
            let rows = band.iter().skip(x).step_by(width).enumerate();
            rows.fold(0_u8, |bits, (row, &index)| bits | u8::from(index == colour) << row)
        });
        push_runs(text, sixels);
    }
}

/// The colours that pixels have, each once.
fn colours_of(indices: &[usize]) -> impl Iterator<Item = usize> + use<> {
    let mut used = [false; COLOURS];
    for &index in indices {
        used[index] = true;
    }
    (0..COLOURS).filter(move |&index| used[index])
}

/// Sixels as characters, with a count before those that repeat.
fn push_runs(text: &mut String, sixels: impl Iterator<Item = u8>) {
    let mut sixels = sixels.peekable();
    while let Some(bits) = sixels.next() {
        let mut count = 1;
        while sixels.next_if_eq(&bits).is_some() {
            count += 1;
        }
        let sixel = char::from(b'?' + bits);
        if count > 3 {
            let _ = write!(text, "!{count}{sixel}");
        } else {
            (0..count).for_each(|_| text.push(sixel));
        }
    }
}

/// The palette's colour for a pixel at a place.
fn index_of(pixel: [u8; 3], x: usize, y: usize) -> usize {
    let threshold = 2 * BAYER[y % 4][x % 4] + 1;
    let steps = pixel.map(|value| {
        // In steps times 255: what is beyond a whole step rounds up where it exceeds the threshold.
        let value = u16::from(value) * (STEPS as u16 - 1);
        let up = value % 255 * 32 > threshold * 255;
        usize::from(value / 255 + u16::from(up))
    });
    (steps[0] * STEPS + steps[1]) * STEPS + steps[2]
}

/// Red, green and blue of a colour of the palette, from 0 to 100.
fn percents_of(index: usize) -> [usize; 3] {
    [index / (STEPS * STEPS), index / STEPS % STEPS, index % STEPS].map(|it| it * 100 / (STEPS - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The colours, in percent, that a terminal has on its screen.
    fn shown(text: &str, width: usize, height: usize) -> Vec<[usize; 3]> {
        let body = text.strip_prefix(&format!("\x1bP0;1q\"1;1;{width};{height}")).expect("begins");
        let mut rest = body.strip_suffix("\x1b\\").expect("ends");
        let mut palette = vec![[0; 3]; COLOURS];
        let mut screen = vec![[999; 3]; width * height];
        let (mut colour, mut x, mut y) = (0, 0, 0);
        let number = |rest: &mut &str| -> usize {
            let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
            let (digits, after) = rest.split_at(end);
            *rest = after;
            digits.parse().expect("a number")
        };
        while let Some(c) = rest.chars().next() {
            rest = &rest[1..];
            match c {
                '#' => {
                    colour = number(&mut rest);
                    if let Some(after) = rest.strip_prefix(";2") {
                        rest = after;
                        palette[colour] = std::array::from_fn(|_| {
                            rest = rest.strip_prefix(';').expect("three of them");
                            number(&mut rest)
                        });
                    }
                }
                '$' => x = 0,
                '-' => (x, y) = (0, y + 6),
                c => {
                    let count = if c == '!' { number(&mut rest) } else { 1 };
                    let sixel = if c == '!' { rest.as_bytes()[0] } else { c as u8 };
                    rest = &rest[usize::from(c == '!')..];
                    for x in x..x + count {
                        for row in (0..6).filter(|row| (sixel - b'?') >> row & 1 == 1) {
                            screen[(y + row) * width + x] = palette[colour];
                        }
                    }
                    x += count;
                }
            }
        }
        screen
    }

    #[test]
    fn colours_of_the_palette_are_shown_as_they_are() {
        let (width, height) = (11, 14);
        let steps = [0, 51, 102, 153, 204, 255];
        let pixels: Vec<[u8; 3]> = (0..width * height)
            .map(|place| [place, place / 6, place / 36].map(|it| steps[it / 5 % 6]))
            .collect();
        let text = encode(&Thumbnail { width, height, pixels: pixels.clone() });
        let expected: Vec<[usize; 3]> =
            pixels.iter().map(|pixel| pixel.map(|it| usize::from(it) * 20 / 51)).collect();
        assert_eq!(shown(&text, width, height), expected);
        assert!(text.contains('!'), "runs are counted");
    }

    #[test]
    fn colours_between_are_dithered_to_their_mean() {
        let (width, height) = (32, 32);
        for value in [10_u8, 60, 128, 250] {
            let pixels = vec![[value; 3]; width * height];
            let screen = shown(&encode(&Thumbnail { width, height, pixels }), width, height);
            let sum: usize = screen.iter().map(|pixel| pixel[0]).sum();
            let mean = sum as f64 / (width * height) as f64;
            let expected = f64::from(value) / 2.55;
            assert!((mean - expected).abs() < 1.0, "{value}: {mean} {expected}");
        }
    }
}
