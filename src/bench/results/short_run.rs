//! What of a file is measured again: the smallest of its scenes that can be made on the spot, with
//! fewer rays or pictures.

use super::files::{Bench, read_resolution};
use super::member::{Malformed, Member};
use crate::generate::Generator;

/// Rays of a kind, at most: some tenths of a second a pass.
const RAYS: u64 = 200_000;
/// Triangles of a scene, at most: some seconds to build its trees.
const TRIANGLES: u64 = 400_000;
/// Pixels along the longer side of a render.
const SIDE: u32 = 128;
/// Samples a pixel of a render, at most.
const SPP: u64 = 64;
/// Pixels of the pictures of a flight: such as are larger are not repeated.
const PIXELS: u64 = 1 << 21;
/// Structures of a render, at most.
const STRUCTURES: usize = 100;
/// Pictures of a flight, if the file's can be thinned.
const PICTURES: usize = 4;

/// A scene that `dapple generate` makes from seed 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made {
    /// Its kind.
    pub generator: Generator,
    /// Its triangles.
    pub triangles: u64,
}

/// A run of one bench over one scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShortRun {
    /// The scene.
    pub scene: Made,
    /// Its place among the file's.
    pub place: usize,
    /// Whether just the file's rays are shot, so that their work can be compared.
    pub same_rays: bool,
    /// What is measured.
    pub what: What,
}

/// What is measured, by bench.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum What {
    /// `bench accels`.
    Accels {
        /// Rays of each kind: all, as the picture has so many pixels.
        rays: u64,
    },
    /// `bench kd`.
    Kd {
        /// Rays of each set.
        rays: u64,
    },
    /// `bench mbvh`.
    Mbvh {
        /// Rays of each kind.
        rays: u64,
        /// The builder.
        build: String,
        /// Whether trees are refined.
        refine: bool,
    },
    /// `bench coherent`.
    Coherent {
        /// Pixels.
        resolution: (u32, u32),
        /// Pictures of the flight.
        pictures: usize,
        /// Each stands for so many of the file's, and is the middle one of them.
        stride: usize,
        /// The builder.
        build: String,
    },
    /// `bench render`.
    Render {
        /// Pixels.
        resolution: (u32, u32),
        /// Samples a pixel.
        spp: u64,
        /// Threads.
        threads: usize,
        /// Structures.
        accels: Vec<String>,
    },
}

/// Rays of `bench accels` in files that do not tell.
const ACCELS_RAYS: u64 = 250_000;

/// What of a file is to be measured again, or why nothing can be.
///
/// # Errors
/// A member that is missing or of another kind.
pub fn plan(bench: Bench, root: &Member<'_>) -> Result<Result<ShortRun, String>, Malformed> {
    let scenes = match bench {
        Bench::Kd | Bench::Accels => vec![(root.clone(), "scene")],
        _ => root.get("scenes")?.items()?.into_iter().map(|scene| (scene, "name")).collect(),
    };
    let mut found: Option<(usize, Made)> = None;
    for (place, (member, key)) in scenes.iter().enumerate() {
        let (name, triangles) = (member.get(key)?.text()?, member.get("triangles")?.count()?);
        let made = find_made(name, triangles).filter(|made| made.triangles <= TRIANGLES);
        let smallest = |made: &Made| found.is_none_or(|(_, best)| made.triangles < best.triangles);
        if let Some(made) = made.filter(smallest) {
            found = Some((place, made));
        }
    }
    let Some((place, scene)) = found else {
        let why = format!(
            "none of its scenes is one that `dapple generate` makes of at most {TRIANGLES} \
             triangles"
        );
        return Ok(Err(why));
    };
    let planned = match bench {
        Bench::Accels => plan_accels(root)?,
        Bench::Kd => plan_kd(root)?,
        Bench::Mbvh => plan_mbvh(root)?,
        Bench::Coherent => plan_coherent(root, &scenes[place].0)?,
        Bench::Render => plan_render(root, &scenes[place].0)?,
    };
    Ok(planned.map(|(same_rays, what)| ShortRun { scene, place, same_rays, what }))
}

/// The scene of a name: `GENERATOR-TRIANGLES`, or that of a generator, perhaps as a file.
fn find_made(name: &str, triangles: u64) -> Option<Made> {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let all = [Generator::Assembly, Generator::City, Generator::Kitchen, Generator::Landscape];
    let is = |generator: &Generator| {
        stem == generator.name() || stem == format!("{}-{triangles}", generator.name())
    };
    let generator = all.into_iter().find(is)?;
    crate::generate::TRIANGLES.contains(&triangles).then_some(Made { generator, triangles })
}

/// Whether the rays are the file's, and what is measured; or why not.
type Planned = Result<(bool, What), String>;

fn plan_accels(root: &Member<'_>) -> Result<Planned, Malformed> {
    let rays = root.optional("rays").map_or(Ok(ACCELS_RAYS), |rays| rays.count())?;
    if rays == 0 || rays > 5 * RAYS {
        return Ok(Err(format!("{rays} rays are not a short run")));
    }
    Ok(Ok((true, What::Accels { rays })))
}

fn plan_kd(root: &Member<'_>) -> Result<Planned, Malformed> {
    let all = root.get("rays")?.count()?;
    let rays = all.clamp(1, RAYS);
    Ok(Ok((rays == all, What::Kd { rays })))
}

fn plan_mbvh(root: &Member<'_>) -> Result<Planned, Malformed> {
    let all = root.get("rays")?.count()?;
    let rays = all.clamp(1, RAYS);
    let build = root.get("build")?.text()?.to_owned();
    let refine = root.get("refine")?;
    let refine = refine.is_true()?;
    Ok(Ok((rays == all, What::Mbvh { rays, build, refine })))
}

fn plan_coherent(root: &Member<'_>, scene: &Member<'_>) -> Result<Planned, Malformed> {
    let resolution = read_resolution(&root.get("resolution")?)?;
    let pixels = u64::from(resolution.0) * u64::from(resolution.1);
    if pixels > PIXELS {
        return Ok(Err(format!("pictures of {pixels} pixels are not a short run")));
    }
    let columns = scene.get("columns")?.items()?;
    let Some(first) = columns.first() else { return Ok(Err("it has no columns".to_owned())) };
    let pictures = first.get("seconds")?.items()?.len();
    if pictures == 0 {
        return Ok(Err("it has no pictures".to_owned()));
    }
    // Only the middle ones of odd groups are among the pictures of a shorter flight.
    let odd = (1..=pictures).step_by(2).filter(|stride| pictures.is_multiple_of(*stride));
    let stride = odd.clone().find(|stride| pictures / stride <= PICTURES);
    let Some(stride) = stride.or(odd.last()).filter(|stride| pictures / stride <= 3 * PICTURES)
    else {
        return Ok(Err(format!("{pictures} pictures are not a short run")));
    };
    let build = root.get("build")?.text()?.to_owned();
    let pictures = pictures / stride;
    Ok(Ok((stride == 1, What::Coherent { resolution, pictures, stride, build })))
}

fn plan_render(root: &Member<'_>, scene: &Member<'_>) -> Result<Planned, Malformed> {
    let all = read_resolution(&root.get("resolution")?)?;
    let part = all.0.max(all.1).div_ceil(SIDE);
    let resolution = (all.0.div_ceil(part), all.1.div_ceil(part));
    let samples = root.get("spp")?.count()?;
    let spp = samples.clamp(1, SPP);
    let threads = root.get("threads")?.count()? as usize;
    let structures = scene.get("structures")?.items()?;
    let accel = |structure: &Member<'_>| Ok(structure.get("accel")?.text()?.to_owned());
    let accels = structures.iter().map(accel).collect::<Result<Vec<_>, Malformed>>()?;
    if accels.is_empty() || accels.len() > STRUCTURES {
        return Ok(Err(format!("it has {} structures", accels.len())));
    }
    let same = (resolution, spp) == (all, samples);
    Ok(Ok((same, What::Render { resolution, spp, threads, accels })))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn planned(bench: Bench, file: &Value) -> Result<ShortRun, String> {
        plan(bench, &Member::root(file)).expect("is well formed")
    }

    #[test]
    fn scenes_are_known_by_name_and_size() {
        let made = |name, triangles| find_made(name, triangles).map(|made| made.generator);
        assert_eq!(made("kitchen.glb", 103_000), Some(Generator::Kitchen));
        assert_eq!(made("assembly-69451", 69_451), Some(Generator::Assembly));
        assert_eq!(made("city", 9200), Some(Generator::City));
        assert_eq!(made("assembly-69451", 70_000), None);
        assert_eq!(made("bunny.obj", 69_451), None);
        assert_eq!(made("city", 0), None);
    }

    #[test]
    fn the_smallest_scene_is_measured_with_few_rays() {
        let scene = |name: &str, triangles: u64| json!({ "name": name, "triangles": triangles });
        let scenes = [
            scene("assembly-334080", 334_080),
            scene("assembly-69451", 69_451),
            scene("bunny", 50),
        ];
        let file = json!({
            "rays": 10_000_000, "build": "binned", "refine": false, "scenes": scenes,
        });
        let run = planned(Bench::Mbvh, &file).expect("has a scene");
        assert_eq!((run.place, run.scene.triangles, run.same_rays), (1, 69_451, false));
        let build = "binned".to_owned();
        assert_eq!(run.what, What::Mbvh { rays: 200_000, build, refine: false });
        let file = json!({ "rays": 1, "build": "", "refine": true, "scenes": [scene("x", 5)] });
        assert!(planned(Bench::Mbvh, &file).expect_err("no such scene").contains("generate"));
        let file = json!({ "rays": 1, "build": "", "refine": "no", "scenes": [scene("city", 5)] });
        let error = plan(Bench::Mbvh, &Member::root(&file)).expect_err("no truth value");
        assert_eq!(error.to_string(), "refine is neither true nor false");
    }

    #[test]
    fn every_third_of_twelve_pictures_is_one_of_four() {
        let flight = |pictures: usize, side: u32| {
            let columns = json!([{ "seconds": vec![1.0; pictures] }]);
            let scene = json!({ "name": "city", "triangles": 9200, "columns": columns });
            json!({ "resolution": [side, side], "build": "binned", "scenes": [scene] })
        };
        let of = |pictures| match planned(Bench::Coherent, &flight(pictures, 1024)) {
            Ok(ShortRun { what: What::Coherent { pictures, stride, .. }, same_rays, .. }) => {
                Some((pictures, stride, same_rays))
            }
            _ => None,
        };
        assert_eq!(of(12), Some((4, 3, false)));
        assert_eq!(of(3), Some((3, 1, true)));
        assert_eq!(of(8), Some((8, 1, true)));
        assert_eq!((of(64), of(0)), (None, None));
        assert!(planned(Bench::Coherent, &flight(4, 4096)).is_err());
    }

    #[test]
    fn renders_are_scaled_down() {
        let scene = json!({
            "name": "assembly-69451", "triangles": 69_451, "structures": [{ "accel": "bvh2" }],
        });
        let file = json!({ "resolution": "500x250", "spp": 16, "threads": 1, "scenes": [scene] });
        let run = planned(Bench::Render, &file).expect("has a scene");
        let accels = vec!["bvh2".to_owned()];
        assert_eq!(run.what, What::Render { resolution: (125, 63), spp: 16, threads: 1, accels });
        assert!(!run.same_rays);
    }
}
