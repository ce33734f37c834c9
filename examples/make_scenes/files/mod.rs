//! The files of `scenes/`: small scenes that each show something, and test it.

mod colors;
mod finishes;
mod gltf;
mod materials;
mod media;
mod motion;
mod painted;
mod pictures;
mod placements;
mod rooms;
mod shapes;
mod surfaces;
mod tower;

/// Names and contents of all files.
pub fn all() -> Vec<(String, Vec<u8>)> {
    let scenes = [
        rooms::cornell(),
        rooms::furnace(),
        rooms::metals(),
        rooms::glass(),
        finishes::finishes(),
        colors::films(),
        colors::gems(),
        media::media(),
        media::leaves(),
        surfaces::textured(),
        surfaces::alpha(),
        surfaces::sky(),
        placements::instanced(),
        placements::many_lights(),
        placements::orthographic(),
        painted::painted(),
        motion::motion(),
    ];
    let mut files: Vec<(String, Vec<u8>)> = scenes.into_iter().flatten().collect();
    files.extend(tower::files());
    files.extend(pictures::files());
    files
}
