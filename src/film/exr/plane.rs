//! The values of a channel that has fewer of them than there are pixels.

use ::exr::meta::attribute::{ChannelDescription, SampleType};
use ::exr::prelude::f16;

use crate::film::Window;

/// A channel's values, which stand at the pixels whose coordinates are multiples of its sampling.
pub(super) struct Plane {
    /// What they are.
    pub kind: SampleType,
    /// Along x and y.
    sampling: [i64; 2],
    /// The first multiples in the data window.
    first: [i64; 2],
    /// How many there are.
    pub size: [usize; 2],
    /// None if nobody wants them.
    values: Option<Vec<f32>>,
}

impl Plane {
    /// None of it yet, for the pixels of a data window.
    ///
    /// # Errors
    /// If it has no value there.
    pub fn new(
        channel: &ChannelDescription,
        crop: Window,
        is_wanted: bool,
    ) -> Result<Self, String> {
        let sampling = [channel.sampling.x() as i64, channel.sampling.y() as i64];
        let bounds = [(crop.x0, crop.x1), (crop.y0, crop.y1)];
        let (mut first, mut size) = ([0; 2], [0; 2]);
        for axis in 0..2 {
            let (low, high) = (i64::from(bounds[axis].0), i64::from(bounds[axis].1));
            let step = sampling[axis];
            if step < 1 {
                return Err(format!("channel {} has a sampling of 0", channel.name));
            }
            first[axis] = (low + step - 1).div_euclid(step);
            let count = (high - 1).div_euclid(step) - first[axis] + 1;
            size[axis] =
                usize::try_from(count).ok().filter(|&count| count > 0).ok_or_else(|| {
                    format!("channel {} has no value in the data window", channel.name)
                })?;
        }
        let values = is_wanted.then(|| Vec::with_capacity(size[0] * size[1]));
        Ok(Self { kind: channel.sample_type, sampling, first, size, values })
    }

    /// Bytes of its values in a line of pixels.
    pub fn line_bytes(&self, y: i64) -> usize {
        if y.rem_euclid(self.sampling[1]) == 0 {
            self.size[0] * self.kind.bytes_per_sample()
        } else {
            0
        }
    }

    /// The values of the next line.
    pub fn push(&mut self, line: &[u8]) {
        let Some(values) = &mut self.values else { return };
        match self.kind {
            SampleType::F16 => {
                values.extend(line.as_chunks().0.iter().map(|it| f16::from_le_bytes(*it).to_f32()));
            }
            SampleType::F32 => {
                values.extend(line.as_chunks().0.iter().map(|it| f32::from_le_bytes(*it)));
            }
            SampleType::U32 => {
                values.extend(line.as_chunks().0.iter().map(|it| u32::from_le_bytes(*it) as f32));
            }
        }
    }

    /// A value for every pixel.
    pub fn enlarge(self, crop: Window) -> Option<Vec<f32>> {
        let Self { sampling, first, size, values, .. } = self;
        let values = values?;
        if sampling == [1, 1] {
            return Some(values);
        }
        // Before and after a pixel, and how far it is from the first of them.
        let around = |at: i32, axis: usize| {
            let (at, step) = (i64::from(at), sampling[axis]);
            let before = at.div_euclid(step) - first[axis];
            let clamp = |index: i64| index.clamp(0, size[axis] as i64 - 1) as usize;
            let share = at.rem_euclid(step) as f32 / step as f32;
            (clamp(before), clamp(before + 1), share)
        };
        let columns: Vec<_> = (crop.x0..crop.x1).map(|x| around(x, 0)).collect();
        let mut all = Vec::with_capacity(crop.area());
        for y in crop.y0..crop.y1 {
            let (above, below, down) = around(y, 1);
            let [above, below] = [above, below].map(|row| &values[row * size[0]..][..size[0]]);
            let mix =
                |a: f32, b: f32, share: f32| if share == 0.0 { a } else { a + (b - a) * share };
            all.extend(columns.iter().map(|&(left, right, across)| {
                let [a, b] = [above, below].map(|row| mix(row[left], row[right], across));
                mix(a, b, down)
            }));
        }
        Some(all)
    }
}
