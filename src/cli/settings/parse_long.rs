//! Values of the settings of long renders: times, ranges of samples and shares of them.

use std::fmt;
use std::ops::Range;
use std::time::Duration;

use clap::ValueEnum;

use crate::sampling::BLOCK;

/// How often something is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Every {
    /// After such a time.
    Time(Duration),
    /// After so many samples of each pixel.
    Samples(u64),
}

/// Whether a render goes on from its checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Resume {
    /// It does; that there is none is an error.
    Must,
    /// If it is there.
    Auto,
}

/// One of several equal parts of a render's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// From 0.
    pub index: u64,
    /// How many there are, at least 1.
    pub count: u64,
}

impl Share {
    /// Into how many shares so many samples can be cut, each with at least one.
    pub fn most(spp: u64) -> u64 {
        spp.div_ceil(BLOCK)
    }

    /// The samples of a share of the samples `0..spp`, cut at blocks: as even as whole subtrees of
    /// their sums allow if there is room for that, else as blocks do. Some are empty if there are
    /// more than [`Share::most`].
    pub fn range(self, spp: u64) -> Range<u64> {
        let blocks = Self::most(spp);
        // Cuts at multiples of a power of two leave few nodes to keep; at least eight such pieces a
        // share keep the shares within an eighth of each other.
        let mut piece = 1_u64;
        while blocks / (piece * 2) >= self.count.saturating_mul(8) {
            piece *= 2;
        }
        let pieces = u128::from(blocks.div_ceil(piece));
        let cut = |index: u64| {
            let at = pieces * u128::from(index) / u128::from(self.count);
            (at as u64 * piece * BLOCK).min(spp)
        };
        cut(self.index)..cut(self.index + 1)
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// A share, as in `3/64`.
pub(super) fn share(text: &str) -> Result<Share, String> {
    let form =
        || "expected the part's number, from 0, and how many there are, as in 3/64".to_owned();
    let (index, count) = text.split_once('/').ok_or_else(form)?;
    let number = |text: &str| text.parse::<u64>().map_err(|_| form());
    let (index, count) = (number(index)?, number(count)?);
    if index < count {
        Ok(Share { index, count })
    } else {
        Err(format!("parts count from 0: the last of {count} is {}", count.saturating_sub(1)))
    }
}

/// A range of samples, as in `64..128`.
pub(super) fn samples(text: &str) -> Result<Range<u64>, String> {
    let form = || "expected the first sample and the one after the last, as in 64..128".to_owned();
    let (first, end) = text.split_once("..").ok_or_else(form)?;
    let number = |text: &str| text.parse::<u64>().map_err(|_| form());
    let (first, end) = (number(first)?, number(end)?);
    if !first.is_multiple_of(BLOCK) {
        return Err(format!("the first sample must be a multiple of {BLOCK}"));
    }
    if first >= end || end > 1 << 32 {
        return Err("the second number must be above the first, 4294967296 at most".to_owned());
    }
    Ok(first..end)
}

/// A time above zero: seconds, or with units, as in `90s`, `5m` or `1h30m`.
pub(super) fn duration(text: &str) -> Result<Duration, String> {
    let form = || format!("`{text}` is no time: expected seconds, or units as in 90s, 5m or 1h30m");
    let (mut seconds, mut rest) = (0.0, text);
    while !rest.is_empty() {
        let end = rest.find(|c: char| c != '.' && !c.is_ascii_digit()).unwrap_or(rest.len());
        let number: f64 = rest[..end].parse().map_err(|_| form())?;
        rest = &rest[end..];
        let end = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
        seconds += number
            * match &rest[..end] {
                "" | "s" => 1.0,
                "ms" => 1e-3,
                "m" | "min" => 60.0,
                "h" => 3600.0,
                "d" => 86_400.0,
                _ => return Err(form()),
            };
        rest = &rest[end..];
    }
    match Duration::try_from_secs_f64(seconds) {
        Ok(time) if !time.is_zero() => Ok(time),
        _ => Err(form()),
    }
}

/// A time, or a number of samples as in `100spp`.
pub(super) fn every(text: &str) -> Result<Every, String> {
    match text.strip_suffix("spp") {
        Some(samples) => match samples.trim().parse() {
            Ok(samples) if samples > 0 => Ok(Every::Samples(samples)),
            _ => Err(format!("`{text}`: expected a number of samples, as in 100spp")),
        },
        None => duration(text)
            .map(Every::Time)
            .map_err(|error| format!("{error}, or samples as in 100spp")),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn times_have_units() {
        let seconds = |text| duration(text).map(|time| time.as_secs_f64());
        assert_eq!(seconds("5m"), Ok(300.0));
        assert_eq!(seconds("1h30m"), Ok(5400.0));
        assert_eq!(seconds("1.5"), Ok(1.5));
        assert_eq!(seconds("250ms"), Ok(0.25));
        for wrong in ["", "0", "m", "5x", "-1s", "1..2s", "1e3", "inf"] {
            assert!(duration(wrong).is_err(), "{wrong}");
        }
        assert_eq!(every("100spp"), Ok(Every::Samples(100)));
        assert_eq!(every("30s"), Ok(Every::Time(Duration::from_secs(30))));
        assert_eq!(every("5"), Ok(Every::Time(Duration::from_secs(5))));
        assert!(every("0spp").is_err() && every("spp").is_err());
        let said = every("5x").expect_err("no such unit");
        assert!(said.contains("expected seconds, or units") && said.ends_with("100spp"), "{said}");
    }

    #[test]
    fn ranges_begin_at_blocks() {
        assert_eq!(samples("64..100"), Ok(64..100));
        for wrong in ["64", "8..32", "64..64", "64..32", "0..4294967297", "a..b", "0-16"] {
            assert!(samples(wrong).is_err(), "{wrong}");
        }
        assert_eq!(share("3/64"), Ok(Share { index: 3, count: 64 }));
        assert!(share("64/64").is_err() && share("0/0").is_err() && share("3").is_err());
    }

    proptest! {
        #[test]
        fn shares_follow_one_another(spp in 1_u64..100_000, count in 1_u64..300) {
            let ranges: Vec<_> =
                (0..count).map(|index| Share { index, count }.range(spp)).collect();
            prop_assert_eq!((ranges[0].start, ranges[count as usize - 1].end), (0, spp));
            for pair in ranges.windows(2) {
                prop_assert_eq!(pair[0].end, pair[1].start);
                prop_assert!(pair[0].end == spp || pair[0].end % BLOCK == 0);
            }
            let has_empty = ranges.iter().any(std::ops::Range::is_empty);
            prop_assert_eq!(has_empty, count > Share::most(spp));
            let blocks = ranges.iter().map(|it| (it.end - it.start).div_ceil(BLOCK));
            let most = blocks.max().unwrap_or(0);
            prop_assert!(most <= spp.div_ceil(BLOCK).div_ceil(count) * 9 / 8 + 1);
        }
    }
}
