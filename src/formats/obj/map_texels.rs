//! The texels of an MTL file's pictures as their uses need them.

use std::borrow::Cow;
use std::sync::Arc;

use super::texture_statement::Channel;
use crate::files::memory::{self, TooMuch};
use crate::texture::{Depth, Image, Texels, TextureStore, Value, spread};

/// What a picture is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Use {
    /// An sRGB colour. Alpha is made one, because in MTL only `map_d` is about opacity.
    Color,
    /// Tangent-space normals.
    Normals,
    /// A scalar, put into all channels: what `-imfchan` names, else luminance.
    Scalar,
    /// The same, but alpha where the picture has any.
    Opacity,
}

/// Metalness and roughness, of the larger one's size: roughness in green, metalness in blue, one
/// where an image is absent. None without any image.
pub(super) fn merge_maps(
    [metallic, roughness]: &[Option<Arc<Image>>; 2],
) -> Option<Result<Image, TooMuch>> {
    let both = || [metallic, roughness].into_iter().flatten();
    let (width, height) = both().map(|image| (image.width(), image.height())).max()?;
    let count = u64::from(width) * u64::from(height);
    let [metallic, roughness] =
        [metallic, roughness].map(|image| image.as_ref().map(|image| (image, image.texels())));
    let value = |image: &Option<(&Arc<Image>, Cow<Texels>)>, x: u32, y: u32| {
        let Some((image, texels)) = image else { return 1.0 };
        let scaled = |at: u32, to: u32, of: u32| u64::from(at) * u64::from(to) / u64::from(of);
        let (x, y) = (scaled(x, image.width(), width), scaled(y, image.height(), height));
        let at = (y * u64::from(image.width()) + x) as usize;
        first_channel(texels, image.channels(), at)
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let texels = texels.flat_map(|(x, y)| [1.0, value(&roughness, x, y), value(&metallic, x, y)]);
    let texels = if both().all(|image| image.depth() == Depth::U8) {
        let of = |value: f32| (value * 255.0 + 0.5) as u8;
        memory::claim(count * 3).map(|()| Texels::U8(texels.map(of).collect()))
    } else {
        let of = |value: f32| (value * 65535.0 + 0.5) as u16;
        memory::claim(count * 6).map(|()| Texels::U16(texels.map(of).collect()))
    };
    Some(texels.map(|texels| Image::new(width, height, 3, texels)))
}

/// The image as its use needs it; the same one if it is so already.
pub(super) fn prepare_image(
    image: &Arc<Image>,
    usage: Use,
    channel: Option<Channel>,
    store: &TextureStore,
) -> Result<Arc<Image>, TooMuch> {
    let channel = match (usage, channel) {
        (Use::Normals, _) => return Ok(Arc::clone(image)),
        (Use::Color, _) if image.is_opaque() => return Ok(Arc::clone(image)),
        (Use::Color, _) => None,
        (_, Some(channel)) => Some(channel),
        (Use::Opacity, None) if !image.is_opaque() => Some(Channel::Component(3)),
        (Use::Opacity | Use::Scalar, None) => Some(Channel::Luminance),
    };
    if image.channels() == 1 && channel != Some(Channel::Component(3)) {
        return Ok(Arc::clone(image));
    }
    memory::claim(image.texel_bytes())?;
    let (kept, texels) = match &*image.texels() {
        Texels::U8(all) => pick_all(all, image.channels(), channel, |l| (l + 0.5) as u8),
        Texels::U16(all) => pick_all(all, image.channels(), channel, |l| (l + 0.5) as u16),
        Texels::F32(all) => pick_all(all, image.channels(), channel, |l| l),
    };
    Ok(store.keep(Image::new(image.width(), image.height(), kept, texels)))
}

/// Texels without alpha: their colours, or one channel; and how many channels that makes.
fn pick_all<T: Value>(
    values: &[T],
    channels: u8,
    channel: Option<Channel>,
    round: fn(f32) -> T,
) -> (u8, Texels) {
    let texels = values.chunks_exact(usize::from(channels));
    let Some(channel) = channel else {
        let colors = usize::from(channels - 1);
        let values = texels.flat_map(|texel| &texel[..colors]).copied().collect();
        return (channels - 1, T::wrap(values));
    };
    let pick = |texel: &[T]| {
        let [r, g, b, a] = spread(texel);
        match channel {
            Channel::Component(k) => [r, g, b, a][k],
            Channel::Luminance if r == g && g == b => r,
            // Rec. 709, of the stored values: what these pictures hold is no light.
            Channel::Luminance => round(0.2126 * r.into() + 0.7152 * g.into() + 0.0722 * b.into()),
        }
    };
    (1, T::wrap(texels.map(pick).collect()))
}

/// The first channel of a texel, 0 to 1.
fn first_channel(texels: &Texels, channels: u8, texel: usize) -> f32 {
    let at = texel * usize::from(channels);
    match texels {
        Texels::U8(all) => f32::from(all[at]) / 255.0,
        Texels::U16(all) => f32::from(all[at]) / 65535.0,
        Texels::F32(all) => all[at].clamp(0.0, 1.0),
    }
}
