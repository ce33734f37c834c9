//! Radiance pictures (.hdr, .pic): three mantissas of eight bits under one exponent.
//!
//! The reader is our own. That of the crate `image` refuses files that begin with another
//! program's name than `#?RADIANCE`, knows one of the eight orders of axes, leaves exposures to
//! its caller and primaries to nobody, and does not say where a file is cut.
//!
//! - G. Ward, "Real Pixels", Graphics Gems II, 1991; the Radiance file formats, "Picture files".
//! - `EXPOSURE` and `COLORCORR` are divided out, however many there are, and `PRIMARIES` taken to
//!   Rec. 709; without them colours are those of Rec. 709.
//! - All eight orders of axes are put upright.
//! - A mantissa stands for its number over 256, not for the middle of its step, so that a written 1
//!   is read as 1.

mod error;
mod header;
mod scanline;

use std::io::{self, BufRead};

use crate::film::primaries;

pub use error::RadianceError;
pub use header::{Header, is_radiance};

/// The pixels after a header: linear Rec. 709 by rows from the top. Memory is taken as pixels come;
/// beforehand no more than a file of `length` bytes can fill. Callers limit the size of pictures.
///
/// # Errors
/// [`RadianceError`], which names the row where the file ends or is damaged.
pub fn read_pixels(
    source: &mut impl BufRead,
    header: &Header,
    length: u64,
) -> Result<Vec<[f32; 3]>, RadianceError> {
    let (count, width) = header.scanlines();
    let total = header.width * header.height;
    // A run of 127 equal values takes two bytes in each of four channels.
    let likely = length.saturating_mul(16).saturating_add(4096).min(total as u64);
    let mut pixels = Vec::with_capacity(likely as usize);
    let mut scanline = vec![[0_u8; 4]; width];
    let scales: Vec<f32> = (0..256).map(scale).collect();
    for number in 1..=count {
        scanline::read(source, &mut scanline).map_err(|problem| match problem {
            scanline::Problem::Read(error) if error.kind() != io::ErrorKind::UnexpectedEof => {
                RadianceError::Read(error)
            }
            problem => {
                let (problem, name) = (problem.describe(), header.scanline_name());
                RadianceError::Scanline { problem, name, number, count }
            }
        })?;
        pixels.extend(scanline.iter().map(|&[r, g, b, exponent]| {
            [r, g, b].map(|mantissa| f32::from(mantissa) * scales[usize::from(exponent)])
        }));
    }
    if header.exposure != [1.0; 3] {
        for (value, divisor) in pixels.iter_mut().flat_map(|it| it.iter_mut().zip(header.exposure))
        {
            *value = (f64::from(*value) / divisor) as f32;
        }
    }
    if let Some(matrix) = &header.to_rec_709 {
        primaries::transform(matrix, &mut pixels);
    }
    Ok(header.turn_upright(pixels))
}

/// What mantissas under an exponent are multiplied by; 0 stands for black.
fn scale(exponent: i32) -> f32 {
    if exponent == 0 { 0.0 } else { libm::ldexpf(1.0, exponent - 136) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mantissas and exponent of 1, of 2 and of 0.5.
    const ONE: [u8; 4] = [128, 128, 128, 129];
    const TWO: [u8; 4] = [128, 128, 128, 130];
    const HALF: [u8; 4] = [128, 128, 128, 128];

    fn read(bytes: &[u8]) -> Result<(usize, usize, Vec<[f32; 3]>), RadianceError> {
        let mut source = bytes;
        let header = Header::read(&mut source)?;
        let pixels = read_pixels(&mut source, &header, bytes.len() as u64)?;
        Ok((header.width, header.height, pixels))
    }

    fn file(header: &str, pixels: &[[u8; 4]]) -> Vec<u8> {
        [header.as_bytes(), pixels.as_flattened()].concat()
    }

    fn message(bytes: &[u8]) -> String {
        read(bytes).expect_err("it is broken").to_string()
    }

    #[test]
    fn any_program_may_have_written_it() {
        for name in ["RADIANCE", "RGBE", "pfstools", ""] {
            let header = format!("#?{name}\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 1\n");
            let pixels = read(&file(&header, &[ONE, TWO])).expect("it is well-formed");
            assert_eq!(pixels, (1, 2, vec![[1.0; 3], [2.0; 3]]), "{name}");
        }
        assert!(!is_radiance(b"#RADIANCE"));
    }

    #[test]
    fn exposures_and_corrections_are_divided_out() {
        let pixels = |lines: &str| {
            let header = format!("#?RADIANCE\n{lines}\n-Y 1 +X 2\n");
            read(&file(&header, &[ONE, ONE])).expect("it is well-formed").2
        };
        assert_eq!(pixels("EXPOSURE=4\n"), [[0.25; 3]; 2]);
        assert_eq!(pixels("EXPOSURE=4\nEXPOSURE= .5\n"), [[0.5; 3]; 2]);
        assert_eq!(pixels("COLORCORR= 1 2 4\nEXPOSURE=2\n"), [[0.5, 0.25, 0.125]; 2]);
        // Those of pictures that it was made of are indented, and are in it already.
        assert_eq!(pixels("\tEXPOSURE=4\n# EXPOSURE=2\n"), [[1.0; 3]; 2]);
        for wrong in ["EXPOSURE=0", "EXPOSURE=x", "EXPOSURE=nan", "COLORCORR=1 2", "EXPOSURE=-1"] {
            let header = format!("#?RADIANCE\n{wrong}\n\n-Y 1 +X 1\n");
            let said = message(&file(&header, &[ONE]));
            assert!(said.starts_with("line 2: "), "{said}");
        }
    }

    #[test]
    fn pixels_that_are_not_square_are_said() {
        let notes = |lines: &str| {
            let header = format!("#?RADIANCE\n{lines}\n-Y 1 +X 1\n");
            Header::read(&mut header.as_bytes()).expect("it is well-formed").notes()
        };
        let said = "PIXASPECT is 2 and is not honoured: pixels count as square";
        assert_eq!(notes("PIXASPECT=2\n"), [said]);
        assert_eq!(notes("PIXASPECT=4\nPIXASPECT= .5\n"), [said]);
        assert_eq!(notes("PIXASPECT=x\n").len(), 1);
        assert!(notes("").is_empty() && notes("PIXASPECT=1.0\n\tPIXASPECT=2\n").is_empty());
    }

    #[test]
    fn primaries_are_taken_to_rec_709() {
        let pixel = |line: &str| {
            let header = format!("#?RADIANCE\nPRIMARIES={line}\n\n-Y 1 +X 1\n");
            read(&file(&header, &[[128, 0, 0, 129]])).expect("it is well-formed").2[0]
        };
        assert_eq!(pixel(" .64 .33 .30 .60 .15 .06 .3127 .3290"), [1.0, 0.0, 0.0]);
        let [r, g, b] = pixel(".708 .292 .170 .797 .131 .046 .3127 .3290");
        let near = |a: f32, b: f32| (a - b).abs() < 1e-3;
        assert!(near(r, 1.6605) && near(g, -0.1246) && near(b, -0.0182), "{r} {g} {b}");
        for wrong in ["1 2 3", ".3 .3 .3 .3 .3 .3 .3 .3"] {
            let header = format!("#?RADIANCE\nPRIMARIES={wrong}\n\n-Y 1 +X 1\n");
            assert!(message(&file(&header, &[ONE])).starts_with("line 2: PRIMARIES"));
        }
    }

    /// In the file 1, 2 and 0.5 are the first scanline, then black.
    #[test]
    fn all_eight_orders_of_axes_are_put_upright() {
        let dark = [0; 4];
        let stored = [ONE, TWO, HALF, dark, dark, dark];
        let value = |pixels: &[[f32; 3]]| pixels.iter().map(|it| it[0]).collect::<Vec<_>>();
        let rows: [(&str, [f32; 6]); 4] = [
            ("-Y 2 +X 3", [1.0, 2.0, 0.5, 0.0, 0.0, 0.0]),
            ("-Y 2 -X 3", [0.5, 2.0, 1.0, 0.0, 0.0, 0.0]),
            ("+Y 2 +X 3", [0.0, 0.0, 0.0, 1.0, 2.0, 0.5]),
            ("+Y 2 -X 3", [0.0, 0.0, 0.0, 0.5, 2.0, 1.0]),
        ];
        let columns: [(&str, [f32; 6]); 4] = [
            ("+X 2 -Y 3", [1.0, 0.0, 2.0, 0.0, 0.5, 0.0]),
            ("+X 2 +Y 3", [0.5, 0.0, 2.0, 0.0, 1.0, 0.0]),
            ("-X 2 -Y 3", [0.0, 1.0, 0.0, 2.0, 0.0, 0.5]),
            ("-X 2 +Y 3", [0.0, 0.5, 0.0, 2.0, 0.0, 1.0]),
        ];
        for ((axes, expected), size) in
            rows.into_iter().map(|it| (it, (3, 2))).chain(columns.map(|it| (it, (2, 3))))
        {
            let bytes = file(&format!("#?RADIANCE\n\n{axes}\n"), &stored);
            let (width, height, pixels) = read(&bytes).expect("it is well-formed");
            assert_eq!((width, height), size, "{axes}");
            assert_eq!(value(&pixels), expected, "{axes}");
        }
    }

    #[test]
    fn both_ways_of_runs_are_read() {
        let header = "#?RADIANCE\n\n-Y 2 +X 300\n";
        // The old way: a pixel and 255 more of it, then another and 43 more.
        let old = [ONE, [1, 1, 1, 255], TWO, [1, 1, 1, 43]];
        let all = [old, old].concat();
        let (.., pixels) = read(&file(header, &all)).expect("it is well-formed");
        assert_eq!((pixels[255][0], pixels[256][0], pixels[599][0]), (1.0, 2.0, 2.0));
        // Consecutive markers are digits: 43 + 1 * 256 more pixels than the first.
        let long = [ONE, [1, 1, 1, 43], [1, 1, 1, 1]];
        let (.., pixels) = read(&file(header, &[long, long].concat())).expect("it is well-formed");
        assert_eq!(pixels, [[1.0; 3]; 600]);
        // The new way: each channel by itself.
        let mut bytes = header.as_bytes().to_vec();
        for _ in 0..2 {
            bytes.extend([2, 2, 1, 44]);
            for value in ONE {
                bytes.extend([128 + 127, value, 128 + 127, value, 128 + 45, value, 1, value]);
            }
        }
        let (.., pixels) = read(&bytes).expect("it is well-formed");
        assert_eq!(pixels, [[1.0; 3]; 600]);
    }

    #[test]
    fn what_is_cut_or_damaged_says_where() {
        let whole = file("#?RADIANCE\n\n-Y 3 +X 2\n", &[ONE; 6]);
        assert_eq!(message(&whole[..whole.len() - 1]), "the file ends in row 3 of 3");
        assert_eq!(message(&whole[..whole.len() - 9]), "the file ends in row 2 of 3");
        let turned = file("#?RADIANCE\n\n+X 3 -Y 2\n", &[ONE; 5]);
        assert_eq!(message(&turned), "the file ends in column 3 of 3");
        let header = "#?RADIANCE\n\n-Y 1 +X 2\n";
        let first = message(&file(header, &[[1, 1, 1, 2]]));
        assert_eq!(first, "nothing is there to repeat in row 1 of 1");
        let long = message(&file(header, &[ONE, [1, 1, 1, 2]]));
        assert_eq!(long, "a run goes beyond the end in row 1 of 1");
        let other = [b"#?RADIANCE\n\n-Y 1 +X 8\n".as_slice(), &[2, 2, 0, 9]].concat();
        assert_eq!(message(&other), "its length is another in row 1 of 1");
        // A claim alone takes no memory.
        let huge = message(b"#?RADIANCE\n\n-Y 30000 +X 30000\n");
        assert_eq!(huge, "the file ends in row 1 of 30000");
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length}");
        }
    }
}
