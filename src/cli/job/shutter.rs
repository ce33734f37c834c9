//! Motion blur: what is animated, posed anew at moments while the shutter is open.
//!
//! Each moment is a scene of its own, with a structure of its own, and gets an equal share of each
//! pixel's samples; so every structure renders motion, and all of them the same. Moments are taken
//! in the order of their reversed bits: the first few are spread over all of the time, and a
//! picture that is interrupted after them is blurred throughout.

use crate::cli::settings::RenderArgs;

/// How many moments there are if no one says.
const MOMENTS: u32 = 32;

/// When which samples of a pixel are taken.
pub struct Shutter {
    /// The middle of each moment, seconds, in the order in which they are taken; none: the scene is
    /// as it is.
    times: Vec<Option<f32>>,
    spp: u64,
}

impl Shutter {
    /// The shutter that the settings ask for.
    pub fn new(args: &RenderArgs) -> Self {
        let spp = args.spp;
        let (Some(opens), Some(open)) = (args.time, args.shutter) else {
            return Self { times: vec![args.time], spp };
        };
        let count = u64::from(args.moments.unwrap_or(MOMENTS)).min(spp) as u32;
        let mut order: Vec<u32> = (0..count).collect();
        order.sort_by_key(|moment| moment.reverse_bits());
        let middle = |moment: u32| opens + open * ((moment as f32 + 0.5) / count as f32);
        Self { times: order.into_iter().map(|moment| Some(middle(moment))).collect(), spp }
    }

    /// How many moments there are, at least 1.
    pub fn moments(&self) -> usize {
        self.times.len()
    }

    /// The time of a moment; none: the scene is as it is.
    pub fn time(&self, moment: usize) -> Option<f32> {
        self.times[moment]
    }

    /// The sample of each pixel at which a moment ends, exclusively.
    pub fn end(&self, moment: usize) -> u64 {
        self.spp * (moment as u64 + 1) / self.times.len() as u64
    }

    /// The moment that a sample belongs to; the last one for samples beyond the last.
    pub fn moment_of(&self, sample: u64) -> usize {
        let last = self.times.len() - 1;
        (0..last).find(|&moment| sample < self.end(moment)).unwrap_or(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::settings::resolve_words;

    fn shutter(words: &str) -> Shutter {
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        let request = resolve_words(std::path::Path::new("a.gltf"), &words);
        Shutter::new(&request.expect("good words").args)
    }

    #[test]
    fn moments_share_the_samples_and_cover_the_time_from_the_start() {
        let shutter = shutter("--time 2 --shutter 0.8 --moments 4 --spp 10");
        let times: Vec<f32> = shutter.times.iter().flatten().copied().collect();
        assert_eq!(times, [2.1, 2.5, 2.3, 2.7]);
        assert_eq!([0, 1, 2, 3].map(|moment| shutter.end(moment)), [2, 5, 7, 10]);
        let of = [0, 1, 2, 4, 5, 6, 7, 9, 99].map(|sample| shutter.moment_of(sample));
        assert_eq!(of, [0, 0, 1, 1, 2, 2, 3, 3, 3]);
    }

    #[test]
    fn each_moment_has_a_sample() {
        assert_eq!(shutter("--time 0 --shutter 1 --spp 3").moments(), 3);
        assert_eq!(shutter("--time 0 --shutter 1 --spp 64").moments(), 32);
        let still = shutter("--time 7 --spp 3");
        assert_eq!((still.times.clone(), still.end(0)), (vec![Some(7.0)], 3));
    }
}
