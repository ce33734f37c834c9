//! Flags that several commands have, and values of flags.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use crate::accel::{AccelSpec, VARIANTS};
use crate::cli::error::CliError;
use crate::cli::progress::say;
use crate::cli::settings::parse;

/// A flag of commands that print little besides their results.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct Quiet {
    /// Prints nothing but errors and results
    #[arg(short, long)]
    pub quiet: bool,
}

impl Quiet {
    /// Prints a line on standard error, unless it is to be quiet.
    pub fn tell(self, line: &str) {
        if !self.quiet {
            say(line);
        }
    }
}

/// Whole numbers within a range, for flags.
pub fn whole<T>(
    range: RangeInclusive<T>,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    move |text| parse::whole(text, range.clone())
}

/// Any number that a generator of random numbers may begin with.
pub fn seed(text: &str) -> Result<u64, String> {
    parse::whole(text, 0..=u64::MAX)
}

/// Reads a list of structures. Options of one may hold commas, so a part without an id joins the
/// one before.
///
/// # Errors
/// [`CliError::Usage`] for a structure that there is none of.
pub fn parse_accels(list: &str) -> Result<Vec<AccelSpec>, CliError> {
    if list == "all" {
        let ids = VARIANTS.iter().filter(|variant| variant.id != "brute");
        return Ok(ids.map(|variant| variant.id.parse().expect("in the table")).collect());
    }
    let mut texts: Vec<String> = Vec::new();
    for part in list.split(',') {
        match texts.last_mut() {
            Some(last) if part.contains('=') && !part.contains(':') => {
                *last = format!("{last},{part}");
            }
            _ => texts.push(part.to_owned()),
        }
    }
    let parse = |text: String| {
        text.parse().map_err(|error| CliError::Usage(format!("--accel {text}: {error}")))
    };
    texts.into_iter().map(parse).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_may_hold_commas() {
        let list = "bvh2:build=sweep,kd-stack-direction:build=binned,layout=compact";
        assert_eq!(parse_accels(list).expect("rows").len(), 2);
    }
}
