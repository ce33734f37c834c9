//! The head of a part: what its samples belong to.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::{Difference, PartError};
use crate::film::Window;

/// What the samples of a part belong to, and how they were made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// The version of dapple.
    pub version: String,
    /// Digest of the scene: meshes, textures, materials, lights, motion.
    pub scene_digest: String,
    /// The settings that samples depend on, by their flags, as TOML has them.
    pub identity: BTreeMap<String, String>,
    /// All settings as TOML, for the header of a picture and for commands that repeat it.
    pub settings: String,
    /// The scene's file.
    pub scene: String,
    /// Width and height of the frame, pixels.
    pub resolution: (u32, u32),
    /// The pixels: x0, y0, x1, y1.
    crop: [i32; 4],
    /// The first sample of each pixel, and the one after the last that was asked for.
    samples: [u64; 2],
    /// The samples a pixel of the whole picture.
    pub spp: u64,
    /// The time that rendering took, seconds.
    pub render_s: f64,
}

impl Head {
    /// The part of the frame that has pixels.
    pub fn crop(&self) -> Window {
        let [x0, y0, x1, y1] = self.crop;
        Window { x0, y0, x1, y1 }
    }

    /// Tells which pixels there are.
    pub fn set_crop(&mut self, crop: Window) {
        self.crop = [crop.x0, crop.y0, crop.x1, crop.y1];
    }

    /// The samples that were asked for.
    pub fn samples(&self) -> Range<u64> {
        self.samples[0]..self.samples[1]
    }

    /// Tells which samples were asked for.
    pub fn set_samples(&mut self, samples: &Range<u64>) {
        self.samples = [samples.start, samples.end];
    }

    /// A head about pixels and samples, with all else still to be told.
    pub fn new(resolution: (u32, u32), crop: Window, samples: &Range<u64>, spp: u64) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene_digest: String::new(),
            identity: BTreeMap::new(),
            settings: String::new(),
            scene: String::new(),
            resolution,
            crop: [crop.x0, crop.y0, crop.x1, crop.y1],
            samples: [samples.start, samples.end],
            spp,
            render_s: 0.0,
        }
    }

    /// What makes the pictures of two heads different ones.
    pub fn differences(&self, other: &Self) -> Vec<Difference> {
        let pair = |key: &str, a: Option<&String>, b: Option<&String>| {
            let values = [a.cloned(), b.cloned()];
            (a != b).then(|| Difference { key: key.to_owned(), values })
        };
        let mut found: Vec<Difference> = Vec::new();
        found.extend(pair("version", Some(&self.version), Some(&other.version)));
        let keys: std::collections::BTreeSet<&String> =
            self.identity.keys().chain(other.identity.keys()).collect();
        found.extend(keys.into_iter().filter_map(|key| {
            pair(&format!("--{key}"), self.identity.get(key), other.identity.get(key))
        }));
        found.extend(pair("scene", Some(&self.scene_digest), Some(&other.scene_digest)));
        found
    }

    /// Makes sure that the samples of another head belong to the same picture.
    ///
    /// # Errors
    /// [`PartError::OtherPicture`], with all that differs.
    pub fn require_same(
        &self,
        other: &Self,
        (own_file, other_file): (&Path, &Path),
    ) -> Result<(), PartError> {
        let differences = self.differences(other);
        if differences.is_empty() {
            return Ok(());
        }
        Err(PartError::OtherPicture {
            a: own_file.to_owned(),
            b: other_file.to_owned(),
            differences,
        })
    }

    /// Reads a head from its JSON.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn from_json(json: &[u8]) -> Result<Self, String> {
        let head: Self = serde_json::from_slice(json).map_err(|error| error.to_string())?;
        let (width, height) = head.resolution;
        let crop = head.crop();
        let fits = crop.x0 >= 0
            && crop.y0 >= 0
            && crop.area() > 0
            && crop.x1 as u32 <= width
            && crop.y1 as u32 <= height;
        if width > 65_536 || height > 65_536 || !fits {
            return Err(format!("the pixels {crop} are not in a frame of {width}x{height}"));
        }
        let samples = head.samples();
        if samples.start > samples.end || samples.end > 1 << 32 || !samples.start.is_multiple_of(16)
        {
            return Err(format!("there are no samples {}..{}", samples.start, samples.end));
        }
        Ok(head)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head() -> Head {
        let mut head = Head::new((64, 32), Window::of_size(64, 32), &(0..16), 64);
        head.identity.insert("seed".to_owned(), "1".to_owned());
        head
    }

    #[test]
    fn what_differs_is_named_with_both_values() {
        let (a, mut b) = (head(), head());
        assert_eq!(a.differences(&b), []);
        b.settings = "threads = 4".to_owned();
        b.set_samples(&(16..32));
        assert_eq!(a.differences(&b), [], "not what a sample depends on");
        b.identity = [("fov".to_owned(), "30.0".to_owned())].into();
        b.scene_digest = "1f".to_owned();
        let error = a.require_same(&b, (Path::new("a"), Path::new("b"))).expect_err("others");
        assert_eq!(
            error.to_string(),
            "a and b are not parts of one picture:\n  --fov: not set and 30.0\n  \
             --seed: 1 and not set\n  scene:  and 1f"
        );
        assert_eq!(error.exit_code(), 3);
    }

    #[test]
    fn a_head_that_makes_no_sense_is_refused() {
        let json = |head: &Head| serde_json::to_vec(head).expect("plain values");
        assert_eq!(Head::from_json(&json(&head())), Ok(head()));
        let mut wide = head();
        wide.set_crop(Window { x0: 0, y0: 0, x1: 65, y1: 1 });
        assert!(Head::from_json(&json(&wide)).is_err());
        let mut odd = head();
        odd.set_samples(&(8..16));
        assert!(Head::from_json(&json(&odd)).is_err());
        assert!(Head::from_json(b"{}").is_err() && Head::from_json(b"\xff").is_err());
    }
}
