//! The scene as it is posed, with its environment light.

use std::sync::Arc;

use crate::cli::error::CliError;
use crate::cli::memory;
use crate::cli::settings::RenderArgs;
use crate::cli::settings::parse::{MissingTextureArg, MtlTransparencyArg, TextureLod};
use crate::cli::status::Phase;
use crate::cli::watch::Watch;
use crate::files;
use crate::formats::{self, LoadError, LoadOptions, NotFinite};
use crate::scene::{Notice, Scene, SceneMemory};
use crate::texture::TextureStore;
use crate::world::World;

/// What decodes and keeps the scene's textures, and those of other scenes of the same job.
pub fn texture_store(args: &RenderArgs, watch: &Watch) -> TextureStore {
    let memory = args.texture_memory.unwrap_or_else(|| files::memory::limit() / 2);
    let store = TextureStore::new(memory).metered(Arc::clone(watch.meter()));
    if args.texture_lod == TextureLod::On { store.with_levels() } else { store }
}

/// Loads the scene, posed as the settings tell, with the environment light that was asked for; and
/// what there is to say of both. `textures` keeps its images.
///
/// # Errors
/// What is wrong with either; with `--strict` also if there is anything to say.
pub fn load(
    args: &RenderArgs,
    textures: &Arc<TextureStore>,
    watch: &Watch,
) -> Result<(Scene, Vec<Notice>), CliError> {
    watch.enter(Phase::Read);
    let options = LoadOptions {
        // It is seen to below, for the scene and its environment light together.
        strict: false,
        missing_texture: MissingTextureArg::option(args.missing_texture),
        mtl_transparency: args.mtl_transparency.map(MtlTransparencyArg::option),
        scene: args.scene.clone(),
        variant: args.variant.clone(),
        animation: args.animation.clone(),
        time: args.time,
        shutter: args.shutter,
        textures: Arc::clone(textures),
        meter: Arc::clone(watch.meter()),
    };
    let mut scene = formats::load(&args.scene_file, &options)?;
    let mut notices = std::mem::take(&mut scene.notices);
    if let Some(source) = &args.env {
        let not_finite = if args.env_repair { NotFinite::Repair } else { NotFinite::Refuse };
        let (environment, remarks) = source.load(args.env_scale, args.env_rotate, not_finite)?;
        scene.environment = Some(environment);
        notices.extend(remarks);
    } else if let Some(sky) = args.clear_sky() {
        if sky.sun.is_nan() || sky.sun.y < 0.0 {
            let message = "--sun-direction must lead to where the sky is, above the horizon";
            return Err(CliError::Usage(message.to_owned()));
        }
        scene.environment = Some(sky.environment(args.env_scale));
    }
    if args.strict && notices.iter().any(Notice::is_refused) {
        return Err(LoadError::Strict { notices }.into());
    }
    Ok((scene, notices))
}

/// Refuses a scene and a picture of so many bytes that take more memory than there is, or than
/// `--memory` allows.
///
/// # Errors
/// [`CliError::Limit`].
pub fn require_memory(
    args: &RenderArgs,
    scene: &Scene,
    textures: &TextureStore,
    picture: u64,
) -> Result<(), CliError> {
    let memory = SceneMemory::of(scene).with_texture_limit(textures.limit());
    let file = args.scene_file.display().to_string();
    memory::require_parts(&file, &memory::parts(&memory, picture), args.memory)
}

/// Makes a scene ready to be shaded.
///
/// # Errors
/// If it has too many triangles.
pub fn build_world(scene: Scene, args: &RenderArgs) -> Result<World, CliError> {
    let world = World::with_lights(Arc::new(scene), args.bsdf, args.lights);
    let world = world.map(|world| world.with_shading_normals(args.shading_normals));
    world.map_err(|error| {
        let file = args.scene_file.display();
        CliError::Input(format!("{file}: {error}"))
    })
}
