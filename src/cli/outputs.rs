//! Outputs, checked before the work: they destroy nothing, and can be written.

use std::path::Path;

use crate::cli::error::CliError;
use crate::files;
use crate::film::{Picture, Tonemap, exr, png};

/// A file that a command is to write.
#[derive(Clone, Copy, Debug)]
pub struct Output<'a> {
    /// The flag that names it.
    pub flag: &'static str,
    /// Where it goes.
    pub path: &'a Path,
    /// The ending of what is written.
    pub ending: &'static str,
}

impl Output<'_> {
    /// The ending of a file that is appended to. Whoever opens it finds out whether that can be
    /// done: it takes no new file in its folder.
    pub const APPENDED: &'static str = "log";
}

/// Endings that say what a file holds. Any other ending, or none, says nothing.
const ENDINGS: [&str; 20] = [
    "exr", "png", "npy", "jpg", "jpeg", "hdr", "tif", "tiff", "bmp", "tga", "webp", "gif", "ktx2",
    "gltf", "glb", "obj", "mtl", "toml", "json", "pdf",
];

/// Makes sure of the outputs of a command that reads `inputs`.
///
/// # Errors
/// [`CliError::Usage`] if an ending belongs to another format, or an output is another output or
/// an input; [`CliError::Output`] for each that cannot be written.
pub fn check(outputs: &[Output<'_>], inputs: &[&Path]) -> Result<(), CliError> {
    for (i, output) in outputs.iter().enumerate() {
        let Output { flag, path, ending } = *output;
        let shown = path.display();
        let found = path.extension().map(|found| found.to_string_lossy().to_ascii_lowercase());
        if let Some(found) = found.filter(|found| found != ending)
            && ENDINGS.contains(&&*found)
        {
            let advice = if flag == "-o" && found == "png" {
                "; --png writes a PNG".to_owned()
            } else {
                format!("; name it {}", path.with_extension(ending).display())
            };
            let kind = ending.to_ascii_uppercase();
            return Err(CliError::Usage(format!("{flag} {shown}: writes {kind}{advice}")));
        }
        if let Some(other) = outputs[..i].iter().find(|other| files::same(other.path, path)) {
            let other = other.flag;
            return Err(CliError::Usage(format!("{other} and {flag} are the same file: {shown}")));
        }
        if inputs.iter().any(|input| files::same(input, path)) {
            let message = format!("{flag} {shown}: is an input, which it would replace");
            return Err(CliError::Usage(message));
        }
    }
    let replaced = outputs.iter().filter(|output| output.ending != Output::APPENDED);
    try_all(replaced.map(|output| {
        files::probe(output.path).map_err(|source| CliError::not_written(output.path, &source))
    }))
}

/// The outputs of a command that writes a picture: an EXR, a PNG, or both.
pub fn of_picture<'a>(exr: Option<&'a Path>, png: Option<&'a Path>) -> Vec<Output<'a>> {
    let exr = exr.map(|path| Output { flag: "-o", path, ending: "exr" });
    let png = png.map(|path| Output { flag: "--png", path, ending: "png" });
    exr.into_iter().chain(png).collect()
}

/// Makes sure of the outputs of a command that writes a picture, as [`check`] does.
///
/// # Errors
/// Those of [`check`], and [`CliError::Usage`] if there are none.
pub fn check_picture(outputs: &[Output<'_>], inputs: &[&Path]) -> Result<(), CliError> {
    if outputs.is_empty() {
        return Err(CliError::Usage("nowhere to put the picture: give -o FILE.exr".to_owned()));
    }
    check(outputs, inputs)
}

/// Writes a picture; where one output fails the other is there still. A PNG gets a label.
///
/// # Errors
/// Each that could not be written.
pub fn write_picture(
    outputs: &[Output<'_>],
    picture: &Picture,
    tonemap: Tonemap,
    exposure: f32,
    label: Option<&str>,
) -> Result<(), CliError> {
    try_all(outputs.iter().map(|output| {
        let written = match output.ending {
            "png" => png::write(output.path, picture, tonemap, exposure, label),
            _ => exr::write(output.path, picture),
        };
        written.map_err(CliError::from)
    }))
}

/// Does every step, whatever fails on the way.
///
/// # Errors
/// Every error, if there are any.
pub fn try_all(steps: impl IntoIterator<Item = Result<(), CliError>>) -> Result<(), CliError> {
    let mut errors: Vec<CliError> = steps.into_iter().filter_map(Result::err).collect();
    match errors.len() {
        0 => Ok(()),
        1 => Err(errors.remove(0)),
        _ => Err(CliError::Several(errors)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn output<'a>(flag: &'static str, path: &'a Path, ending: &'static str) -> Output<'a> {
        Output { flag, path, ending }
    }

    #[test]
    fn outputs_destroy_neither_each_other_nor_an_input() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        let (a, b, input) = (place("a"), place("b"), place("in.npy"));
        std::fs::write(&input, []).expect("written");
        let (first, second) = (output("-o", &a, "exr"), output("--png", &b, "png"));
        assert!(check(&[first, second], &[&input]).is_ok());
        let twice = check(&[first, output("--png", &a, "png")], &[]).expect_err("one file");
        assert_eq!(twice.exit_code(), 2);
        assert!(twice.to_string().starts_with("-o and --png are the same file"), "{twice}");
        let over = check(&[output("--hits", &input, "npy")], &[&input]).expect_err("an input");
        assert!(over.exit_code() == 2 && over.to_string().contains("is an input"), "{over}");
    }

    #[test]
    fn an_ending_of_another_format_is_told_with_what_to_do() {
        let message = |flag, name: &str, ending| {
            let error = check(&[output(flag, Path::new(name), ending)], &[]).expect_err("another");
            assert_eq!(error.exit_code(), 2);
            error.to_string()
        };
        assert_eq!(message("-o", "x.png", "exr"), "-o x.png: writes EXR; --png writes a PNG");
        assert_eq!(message("-o", "x.tiff", "exr"), "-o x.tiff: writes EXR; name it x.exr");
        assert_eq!(message("--png", "x.JPG", "png"), "--png x.JPG: writes PNG; name it x.png");
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["x.EXR", "x", "x.2"] {
            assert!(check(&[output("-o", &folder.path().join(name), "exr")], &[]).is_ok());
        }
    }

    #[test]
    fn every_output_that_cannot_be_written_is_told() {
        let (a, b) = (Path::new("no/such/a.exr"), Path::new("no/such/b.png"));
        let error = check(&[output("-o", a, "exr"), output("--png", b, "png")], &[]);
        let error = error.expect_err("no such folder");
        assert_eq!(error.exit_code(), 4);
        let text = error.to_string();
        assert!(text.contains("a.exr: cannot be") && text.contains("\nno/such/b.png"), "{text}");
    }
}
