//! What frames ask of the other settings.

use super::args::RenderArgs;
use super::command::Typed;
use super::frames::find_number;
use crate::cli::error::CliError;

/// Poses the scene at the first frame, if frames are asked for: what needs `--time` has it then.
///
/// # Errors
/// [`CliError::Usage`] if the time is typed, too, or frames a second without frames.
pub(super) fn pose_first(args: &mut RenderArgs, typed: &Typed) -> Result<(), CliError> {
    let Some(frames) = args.frames else {
        return match args.fps {
            Some(_) => Err(CliError::Usage("--fps is of no use without --frames".to_owned())),
            None => Ok(()),
        };
    };
    if typed.given.iter().any(|(setting, _)| setting.name == "time") {
        let message = "the argument '--frames <A..B>' cannot be used with '--time <SECONDS>'";
        return Err(CliError::Usage(message.to_owned()));
    }
    args.time = Some(args.time_of(frames.first));
    Ok(())
}

/// Makes sure that frames do not replace each other.
///
/// # Errors
/// [`CliError::Usage`] for a file of several frames whose name has no place for a number.
pub fn require_numbers(args: &RenderArgs) -> Result<(), CliError> {
    if args.frames.is_none_or(|frames| frames.count() == 1) {
        return Ok(());
    }
    let files = [
        ("-o", &args.output),
        ("--png", &args.png),
        ("--partial", &args.partial),
        ("--checkpoint", &args.checkpoint),
    ];
    for (flag, path) in files {
        let named = path.as_ref().filter(|path| !path.as_os_str().is_empty());
        let Some(path) = named else { continue };
        if find_number(&path.to_string_lossy()).is_none() {
            let file = path.display();
            return Err(CliError::Usage(format!(
                "{flag} {file}: --frames needs a place for the number, as in out.####.exr"
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::cli::settings::resolve_words;

    fn args(words: &str) -> Result<RenderArgs, CliError> {
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        resolve_words(Path::new("a.gltf"), &words).map(|request| request.args)
    }

    #[test]
    fn a_frame_is_a_time() {
        let at_24 = args("--frames 12..48 --shutter 0.02 --animation walk").expect("good words");
        assert_eq!((at_24.time, at_24.time_of(48)), (Some(0.5), 2.0));
        assert_eq!(args("--frames 1..50 --fps 25").expect("good words").time, Some(0.04));
    }

    #[test]
    fn what_does_not_go_with_frames_is_refused() {
        for (words, message) in [
            ("--fps 25", "--fps is of no use without --frames"),
            ("--frames 1 --time 2", "cannot be used with '--time"),
            ("--frames 1 --debug-sample 0,0,0", "cannot be used with"),
        ] {
            let error = args(words).expect_err(words);
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains(message), "{error}");
        }
    }
}
