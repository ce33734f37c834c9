//! Refuses work that needs more memory than there is, before it begins.

use crate::cli::error::CliError;
use crate::cli::text::format_bytes;
use crate::files::memory::limit;
use crate::scene::SceneMemory;

/// Refuses work that needs more memory than there is; `what` names it in the message, as in
/// `a frame of 8x8`.
///
/// # Errors
/// [`CliError::Limit`] with both figures.
pub fn require(what: &str, needed: u64) -> Result<(), CliError> {
    let limit = limit();
    if needed <= limit {
        return Ok(());
    }
    let giga = |bytes: u64| bytes as f64 * 1e-9;
    let (needed, limit) = (giga(needed), giga(limit));
    Err(CliError::Limit(format!("{what} needs {needed:.1} GB of memory, there are {limit:.1} GB")))
}

/// The parts of a scene and of its picture by their names, with their bytes.
pub fn parts(scene: &SceneMemory, picture: u64) -> Vec<(&'static str, u64)> {
    scene.parts().into_iter().chain([("picture", picture)]).collect()
}

/// Refuses a scene whose parts take more than `allowed`, by `--memory`, or else than there is;
/// `what` names it.
///
/// # Errors
/// [`CliError::Limit`] with all parts.
pub fn require_parts(
    what: &str,
    parts: &[(&'static str, u64)],
    allowed: Option<u64>,
) -> Result<(), CliError> {
    let needed = parts.iter().fold(0_u64, |sum, (_, bytes)| sum.saturating_add(*bytes));
    let (most, whose) = match allowed {
        Some(allowed) => (allowed, "--memory allows"),
        None => (limit(), "there are"),
    };
    if needed <= most {
        return Ok(());
    }
    let parts: Vec<String> =
        parts.iter().map(|&(name, bytes)| format!("{name} {}", format_bytes(bytes))).collect();
    Err(CliError::Limit(format!(
        "{what} needs about {} of memory, {whose} {}: {}",
        format_bytes(needed),
        format_bytes(most),
        parts.join(", ")
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_that_is_too_large_is_refused_with_its_parts() {
        let memory = SceneMemory { mesh_bytes: 1500, ..SceneMemory::default() };
        let parts = parts(&memory, 500);
        assert!(require_parts("a.glb", &parts, Some(2000)).is_ok());
        let error = require_parts("a.glb", &parts, Some(1999)).expect_err("too little");
        assert_eq!(error.exit_code(), 5);
        assert_eq!(
            error.to_string(),
            "a.glb needs about 2.0 kB of memory, --memory allows 2.0 kB: meshes 1.5 kB, \
             placements 0 B, textures 0 B, structure of meshes 0 B, structure of placements 0 B, \
             picture 500 B"
        );
        let huge = SceneMemory { placement_bytes: 1 << 60, ..SceneMemory::default() };
        let error = require_parts("a.glb", &super::parts(&huge, 0), None).expect_err("too large");
        assert!(error.to_string().contains(" of memory, there are "), "{error}");
    }

    #[test]
    fn what_does_not_fit_is_refused_with_the_figure() {
        assert!(require("a pixel", 400).is_ok());
        let error = require("a frame of 9x9", 1 << 60).expect_err("there is no such machine");
        assert_eq!(error.exit_code(), 5);
        let start = "a frame of 9x9 needs 1152921504.6 GB of memory, there are ";
        assert!(error.to_string().starts_with(start), "{error}");
    }
}
