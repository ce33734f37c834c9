//! Pictures: textures as PNG, and a sky as Radiance HDR.

use std::f32::consts::{PI, TAU};
use std::io::Cursor;

use dapple::math::Vec3;
use image::codecs::hdr::HdrEncoder;
use image::{ImageFormat, Rgb, RgbImage, RgbaImage};

/// All pictures that the scenes use.
pub fn files() -> Vec<(String, Vec<u8>)> {
    let rgb = |name: &str, size: u32, texel: &dyn Fn(f32, f32) -> [u8; 3]| {
        let image = RgbImage::from_fn(size, size, |x, y| {
            let [u, v] = [x, y].map(|i| (i as f32 + 0.5) / size as f32);
            image::Rgb(texel(u, v))
        });
        (format!("textures/{name}.png"), png(&image.into()))
    };
    vec![
        rgb("checker", 2, &|u, v| if (u < 0.5) == (v < 0.5) { [205; 3] } else { [70; 3] }),
        rgb("bricks", 128, &brick_color),
        rgb("bricks_normal", 128, &brick_normal),
        rgb("bricks_roughness", 128, &|u, v| {
            let roughness = 0.95 - 0.5 * brick(u, v).height;
            [0, byte(roughness), 0]
        }),
        rgb("inlay", 128, &|u, v| if inlay(u, v) { [255, 196, 92] } else { [22, 30, 66] }),
        rgb("inlay_metal", 128, &|u, v| if inlay(u, v) { [0, 46, 255] } else { [0, 150, 0] }),
        rgb("arrow", 8, &arrow),
        ("textures/leaf.png".to_owned(), leaf()),
        ("sky.hdr".to_owned(), sky()),
    ]
}

fn png(image: &image::DynamicImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).expect("memory takes it");
    bytes
}

fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Noise in 0..1 without pattern, of whole numbers.
fn noise(x: i32, y: i32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    ((h ^ (h >> 15)) >> 8) as f32 / 16_777_216.0
}

struct Brick {
    /// 0 in the mortar, 1 on the brick.
    height: f32,
    column: i32,
    row: i32,
}

/// Two by four bricks that repeat.
fn brick(u: f32, v: f32) -> Brick {
    let row = (v * 4.0).floor() as i32;
    let x = u * 2.0 + if row.rem_euclid(2) == 1 { 0.5 } else { 0.0 };
    let column = x.floor() as i32;
    let (fx, fy) = (x - x.floor(), v * 4.0 - (v * 4.0).floor());
    // Distance to the mortar's middle in units of a brick's height.
    let edge = (fx.min(1.0 - fx) * 2.0).min(fy.min(1.0 - fy));
    let height = ((edge - 0.05) / 0.07).clamp(0.0, 1.0);
    Brick { height, column: column.rem_euclid(2), row: row.rem_euclid(4) }
}

fn grain(u: f32, v: f32) -> f32 {
    noise((u * 128.0).floor() as i32, (v * 128.0).floor() as i32) - 0.5
}

fn brick_color(u: f32, v: f32) -> [u8; 3] {
    let Brick { height, column, row } = brick(u, v);
    let shade = 0.8 + 0.4 * noise(column, 100 + row) + 0.12 * grain(u, v);
    let brick = Vec3::new(0.62, 0.3, 0.22) * shade;
    let mortar = Vec3::splat(0.66 + 0.08 * grain(u, v));
    mortar.lerp(brick, height).to_array().map(byte)
}

fn brick_normal(u: f32, v: f32) -> [u8; 3] {
    let step = 1.0 / 128.0;
    let height = |u: f32, v: f32| {
        let (wu, wv) = (u.rem_euclid(1.0), v.rem_euclid(1.0));
        0.02 * brick(wu, wv).height + 0.0015 * grain(wu, wv)
    };
    let du = (height(u + step, v) - height(u - step, v)) / (2.0 * step);
    // Rows count downwards, normals upwards.
    let dv = (height(u, v - step) - height(u, v + step)) / (2.0 * step);
    let normal = Vec3::new(-du, -dv, 1.0).normalize();
    (normal * 0.5 + 0.5).to_array().map(byte)
}

/// Whether a ring or a star of the inlay covers the point.
fn inlay(u: f32, v: f32) -> bool {
    let (x, y) = (u * 2.0 - 1.0, v * 2.0 - 1.0);
    let radius = (x * x + y * y).sqrt();
    let angle = libm::atan2f(y, x);
    let star = 0.42 + 0.16 * libm::cosf(6.0 * angle);
    radius < star || (0.72..0.82).contains(&radius)
}

/// An arrow to the upper right in four colours: shows turns, flips and wraps.
fn arrow(u: f32, v: f32) -> [u8; 3] {
    const ROWS: [&[u8; 8]; 8] = [
        b"rrrrrrrr",
        b"r..oooor",
        b"r...ooog",
        b"r..ooo.g",
        b"r.ooo..g",
        b"rooo...g",
        b"r.o....g",
        b"bbbbbbgg",
    ];
    match ROWS[(v * 8.0) as usize][(u * 8.0) as usize] {
        b'r' => [200, 60, 50],
        b'g' => [60, 150, 80],
        b'b' => [50, 90, 190],
        b'o' => [245, 190, 60],
        _ => [235, 230, 220],
    }
}

/// A leaf with its stem below, transparent around.
fn leaf() -> Vec<u8> {
    let image = RgbaImage::from_fn(128, 128, |x, y| {
        let (u, v) = ((x as f32 + 0.5) / 64.0 - 1.0, 1.0 - (y as f32 + 0.5) / 128.0);
        let width = 0.86 * libm::powf(libm::sinf(PI * libm::powf(v, 0.8)).max(0.0), 0.9);
        let edge = width * (1.0 - 0.06 * (libm::sinf(v * 60.0) * 0.5 + 0.5)) - u.abs();
        let stem = (0.03 - u.abs()).min(0.5 - v);
        let alpha = (edge.max(stem) * 40.0 + 0.5).clamp(0.0, 1.0);
        // Veins: the middle, and twelve that branch off upwards.
        let branch = (v - 0.35 * u.abs()) * 12.0;
        let branch = (branch - branch.floor() - 0.5).abs();
        let vein = (1.0 - u.abs() * 40.0).max(1.0 - branch * 9.0).clamp(0.0, 1.0);
        let green = Vec3::new(0.25, 0.5, 0.16).lerp(Vec3::new(0.55, 0.72, 0.36), 0.7 * vein);
        let [r, g, b] = (green * (0.85 + 0.3 * v)).to_array().map(byte);
        image::Rgba([r, g, b, byte(alpha)])
    });
    png(&image.into())
}

/// A clear evening: 160 by 80, the sun to the right of the centre, which is towards -Z.
fn sky() -> Vec<u8> {
    let (width, height) = (160_usize, 80_usize);
    let direction = |longitude: f32, latitude: f32| {
        let ((sin, cos), (y, out)) = (libm::sincosf(longitude), libm::sincosf(latitude));
        Vec3::new(out * sin, y, -out * cos)
    };
    let sun = direction(2.2, 0.5);
    let radiance = |toward: Vec3| {
        let up = toward.y;
        let zenith = Vec3::new(0.07, 0.19, 0.52);
        let horizon = Vec3::new(0.6, 0.47, 0.4);
        let ground = Vec3::new(0.14, 0.11, 0.08);
        let clear = horizon.lerp(zenith, libm::powf(up.max(0.0), 0.45));
        let base = if up >= 0.0 { clear } else { ground.lerp(horizon, libm::expf(40.0 * up)) };
        let towards_sun = toward.dot(sun).max(0.0);
        let glow = 2.0 * libm::powf(towards_sun, 60.0) + 0.4 * libm::powf(towards_sun, 6.0);
        let disc = if towards_sun > libm::cosf(0.04) { 420.0 } else { 0.0 };
        base + Vec3::new(1.0, 0.78, 0.5) * (glow + disc)
    };
    let texels: Vec<Rgb<f32>> = (0..width * height)
        .map(|i| {
            let u = ((i % width) as f32 + 0.5) / width as f32;
            let v = ((i / width) as f32 + 0.5) / height as f32;
            Rgb(radiance(direction((u - 0.5) * TAU, (0.5 - v) * PI)).to_array())
        })
        .collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes).encode(&texels, width, height).expect("memory takes it");
    bytes
}
