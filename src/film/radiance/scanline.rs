//! Scanlines of Radiance pictures: plain, or with runs in either of two ways.

use std::io::{self, BufRead};

/// Lengths of scanlines that may have the newer runs.
const NEWER: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// What is wrong with a scanline.
pub(super) enum Problem {
    /// It cannot be read, or ends.
    Read(io::Error),
    /// It is damaged.
    Damaged(&'static str),
}

impl Problem {
    /// In words, but for what the system says.
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Read(_) => "the file ends",
            Self::Damaged(what) => what,
        }
    }
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        Self::Read(error)
    }
}

const TOO_LONG: Problem = Problem::Damaged("a run goes beyond the end");

/// Reads all pixels of a scanline: three mantissas and an exponent each.
///
/// # Errors
/// [`Problem`].
pub(super) fn read(source: &mut impl BufRead, pixels: &mut [[u8; 4]]) -> Result<(), Problem> {
    let mut first = [0; 4];
    source.read_exact(&mut first)?;
    let [2, 2, high @ 0..=127, low] = first else { return older(source, first, pixels) };
    if !NEWER.contains(&pixels.len()) {
        return older(source, first, pixels);
    }
    if usize::from(high) << 8 | usize::from(low) != pixels.len() {
        return Err(Problem::Damaged("its length is another"));
    }
    (0..4).try_for_each(|channel| newer(source, channel, pixels))
}

/// One channel by itself: a count and so many values, or beyond 128 a count and one value.
fn newer(source: &mut impl BufRead, channel: usize, pixels: &mut [[u8; 4]]) -> Result<(), Problem> {
    let mut rest = pixels;
    while !rest.is_empty() {
        let code = usize::from(byte(source)?);
        let count = if code > 128 { code - 128 } else { code };
        let (run, after) = rest.split_at_mut_checked(count).ok_or(TOO_LONG)?;
        rest = after;
        if code > 128 {
            let value = byte(source)?;
            for pixel in run {
                pixel[channel] = value;
            }
        } else {
            let mut values = [0; 128];
            source.read_exact(&mut values[..count])?;
            run.iter_mut().zip(values).for_each(|(pixel, value)| pixel[channel] = value);
        }
    }
    Ok(())
}

/// Whole pixels, of which those with mantissas of 1 repeat the one before; several of them in a row
/// are the digits of a number to the base 256, the lowest first.
fn older(source: &mut impl BufRead, first: [u8; 4], pixels: &mut [[u8; 4]]) -> Result<(), Problem> {
    let (mut next, mut at, mut digit) = (first, 0_usize, 1_usize);
    loop {
        if let [1, 1, 1, count] = next {
            let count = usize::from(count).checked_mul(digit).ok_or(TOO_LONG)?;
            let before = at.checked_sub(1).map(|before| pixels[before]);
            let before = before.ok_or(Problem::Damaged("nothing is there to repeat"))?;
            let end = at.checked_add(count).ok_or(TOO_LONG)?;
            pixels.get_mut(at..end).ok_or(TOO_LONG)?.fill(before);
            digit = digit.saturating_mul(256);
            at = end;
        } else {
            pixels[at] = next;
            digit = 1;
            at += 1;
        }
        if at == pixels.len() {
            return Ok(());
        }
        source.read_exact(&mut next)?;
    }
}

fn byte(source: &mut impl BufRead) -> io::Result<u8> {
    let mut byte = [0];
    source.read_exact(&mut byte)?;
    Ok(byte[0])
}
