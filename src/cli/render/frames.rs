//! The frames of an animation, a render each.

use std::path::PathBuf;

use crate::cli::error::CliError;
use crate::cli::settings::RenderArgs;
use crate::cli::settings::frames::{Frames, number};
use crate::cli::settings::pose::require_numbers;

/// What is to be rendered, one after the other: each frame that is asked for, or the one picture.
///
/// # Errors
/// [`CliError::Usage`] if frames would replace each other, for a name has no place for a number.
pub fn split(
    args: RenderArgs,
) -> Result<impl Iterator<Item = Result<RenderArgs, CliError>>, CliError> {
    require_numbers(&args)?;
    let wanted = args.frames.map_or(0..=0, Frames::each);
    Ok(wanted.map(move |frame| match args.frames {
        Some(_) => of_frame(&args, frame),
        None => Ok(args.clone()),
    }))
}

/// One frame: its time, and its files.
fn of_frame(args: &RenderArgs, frame: u32) -> Result<RenderArgs, CliError> {
    let numbered = |path: &Option<PathBuf>| path.as_deref().map(|it| number(it, frame)).transpose();
    Ok(RenderArgs {
        time: Some(args.time_of(frame)),
        output: numbered(&args.output)?,
        png: numbered(&args.png)?,
        partial: numbered(&args.partial)?,
        checkpoint: numbered(&args.checkpoint)?,
        ..args.clone()
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::cli::settings::resolve_words;

    fn split_words(words: &str) -> Result<Vec<RenderArgs>, CliError> {
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        split(resolve_words(Path::new("a.gltf"), &words)?.args)?.collect()
    }

    #[test]
    fn each_frame_has_its_time_and_its_files() {
        let all = split_words("--frames 23..25 -o a.##.exr --png b#.png --checkpoint").expect("ok");
        let times: Vec<_> = all.iter().map(|args| args.time).collect();
        assert_eq!(times, [Some(23.0 / 24.0), Some(1.0), Some(25.0 / 24.0)]);
        assert_eq!(all[1].output.as_deref(), Some(Path::new("a.24.exr")));
        assert_eq!(all[1].png.as_deref(), Some(Path::new("b24.png")));
        assert_eq!(all[1].checkpoint.as_deref(), Some(Path::new("")), "beside the output");
        let one = split_words("-o a.##.exr").expect("ok");
        assert_eq!((one.len(), one[0].time), (1, None));
        assert_eq!(one[0].output.as_deref(), Some(Path::new("a.##.exr")));
    }

    #[test]
    fn frames_do_not_replace_each_other() {
        let error = split_words("--frames 1..2 -o a.##.exr --png b.png").expect_err("one file");
        assert!(error.exit_code() == 2 && error.to_string().starts_with("--png b.png: --frames"));
        assert_eq!(split_words("--frames 2..2 -o a.exr").expect("one frame").len(), 1);
    }
}
