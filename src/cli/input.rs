//! Triangles to shoot at, and options that several commands share.

use std::path::Path;
use std::sync::Arc;

use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::progress;
use crate::formats::{self, LoadOptions, MissingTexture, npy};
use crate::geom::{Triangle, TriangleList, TriangleSource};
use crate::math::Vec3;
use crate::scene::Triangles;
use crate::scene::defaults::describe_empty_scene;

/// The triangles of a scene file, or those of an .npy of (N, 9) float32 in the file's order. What
/// there is to say of the scene is said, unless it is to be quiet.
pub fn load_triangles(path: &Path, quiet: Quiet) -> Result<Arc<dyn TriangleSource>, CliError> {
    if path.extension().is_some_and(|extension| extension == "npy") {
        return load_table(path);
    }
    // Textures shade; rays do not meet them.
    let options =
        LoadOptions { missing_texture: MissingTexture::Magenta, ..LoadOptions::default() };
    let scene = formats::load(path, &options)?;
    let file = path.display().to_string();
    if !quiet.quiet {
        scene.notices.iter().chain(&describe_empty_scene(&scene, &file)).for_each(progress::note);
    }
    let triangles = Triangles::new(Arc::new(scene))
        .map_err(|error| CliError::Input(format!("{file}: {error}")))?;
    Ok(Arc::new(triangles))
}

fn load_table(path: &Path) -> Result<Arc<dyn TriangleSource>, CliError> {
    let rows = npy::read_f32(path, 9)?;
    if let Some(bad) = rows.iter().position(|x| !x.is_finite()) {
        let message = format!("{}: row {}: a coordinate is not finite", path.display(), bad / 9);
        return Err(CliError::Input(message));
    }
    let point = |p: &[f32]| Vec3::new(p[0], p[1], p[2]);
    let triangle = |r: &[f32]| Triangle { a: point(r), b: point(&r[3..]), c: point(&r[6..]) };
    Ok(Arc::new(TriangleList(rows.chunks_exact(9).map(triangle).collect())))
}

/// Runs `work` on `threads` threads; zero: one per core.
pub fn run_on_threads<R: Send>(
    threads: usize,
    work: impl FnOnce() -> R + Send,
) -> Result<R, CliError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| CliError::Usage(format!("--threads {threads}: {error}")))?;
    Ok(pool.install(work))
}
