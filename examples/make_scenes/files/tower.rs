//! A tower as Wavefront OBJ, with what that format can say: polygons of many corners, concave and
//! with holes, indices that count backwards, textures with options, glass and a lamp.

use std::f32::consts::TAU;
use std::fmt::Write;

const MATERIALS: &str = "\
# The materials of tower.obj.
newmtl meadow
Kd 0.22 0.3 0.1
illum 1

newmtl brick wall
Kd 1 1 1
Ks 0 0 0
map_Kd -s 12 6 1 textures/bricks.png
bump -s 12 6 1 -bm 0.02 -imfchan g textures/bricks_roughness.png
illum 2

newmtl stone
Kd 0.55 0.53 0.5
Ks 0.1 0.1 0.1
Ns 20
illum 2

newmtl tiles
Kd 0.28 0.06 0.05
Ks 0.4 0.4 0.4
Ns 120
illum 2

newmtl glass
Kd 0 0 0
Ks 1 1 1
Ni 1.5
Tf 0.9 0.97 0.95
d 0.1
illum 7

newmtl lamp
Kd 0 0 0
Ke 30 22 12

newmtl gold
Kd 1 0.71 0.29
Pm 1
Pr 0.2
";

/// The OBJ file and its library.
pub fn files() -> Vec<(String, Vec<u8>)> {
    let mut obj = Obj::default();
    obj.line("# A round tower with battlements, a lantern room and a cone on top.");
    obj.line("mtllib tower.mtl");
    meadow(&mut obj);
    walls(&mut obj);
    battlements(&mut obj);
    lantern(&mut obj);
    roof(&mut obj);
    vec![
        ("tower.obj".to_owned(), obj.text.into_bytes()),
        ("tower.mtl".to_owned(), MATERIALS.as_bytes().to_vec()),
    ]
}

#[derive(Default)]
struct Obj {
    text: String,
    vertices: usize,
}

impl Obj {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// Writes a vertex; its index.
    fn vertex(&mut self, [x, y, z]: [f32; 3]) -> usize {
        writeln!(self.text, "v {x:.4} {y:.4} {z:.4}").expect("strings grow");
        self.vertices += 1;
        self.vertices
    }

    /// A ring of vertices about the Y axis; their indices, counter-clockwise from above.
    fn ring(&mut self, count: usize, radius: f32, y: f32) -> Vec<usize> {
        (0..count)
            .map(|k| {
                let (sin, cos) = libm::sincosf(TAU * k as f32 / count as f32);
                self.vertex([radius * sin, y, radius * cos])
            })
            .collect()
    }

    fn face(&mut self, corners: impl IntoIterator<Item = String>) {
        let corners: Vec<String> = corners.into_iter().collect();
        self.line(&format!("f {}", corners.join(" ")));
    }

    fn polygon(&mut self, corners: &[usize]) {
        self.face(corners.iter().map(usize::to_string));
    }

    /// Quadrilaterals between two rings of equally many vertices, front outside.
    fn band(&mut self, below: &[usize], above: &[usize]) {
        for k in 0..below.len() {
            let next = (k + 1) % below.len();
            self.polygon(&[below[k], below[next], above[next], above[k]]);
        }
    }
}

fn meadow(obj: &mut Obj) {
    obj.line("o meadow\nusemtl meadow");
    let ground = obj.ring(48, 5.0, 0.0);
    obj.polygon(&ground);
}

/// A tapering cylinder with texture coordinates and normals, indexed from the end of the lists.
fn walls(obj: &mut Obj) {
    obj.line("o tower\ng walls\nusemtl brick wall\ns 1");
    let (count, tall) = (32, 5.0);
    for k in 0..=count {
        let turn = k as f32 / count as f32;
        // The seam's vertices are written twice, to the same digits.
        let (sin, cos) = libm::sincosf(TAU * (k % count) as f32 / count as f32);
        obj.vertex([1.25 * sin, 0.0, 1.25 * cos]);
        obj.vertex([sin, tall, cos]);
        obj.line(&format!("vt {turn:.5} 0\nvt {turn:.5} 1\nvn {sin:.5} 0.05 {cos:.5}"));
        if k > 0 {
            obj.line("f -4/-4/-2 -2/-2/-1 -1/-1/-1 -3/-3/-2");
        }
    }
}

/// Merlons as one concave polygon, front and back: a wall of teeth around the top.
fn battlements(obj: &mut Obj) {
    obj.line("g battlements\nusemtl stone\ns off");
    let bottom = obj.ring(32, 1.0, 5.0);
    let ledge = obj.ring(32, 1.38, 5.35);
    obj.band(&bottom, &ledge);
    // The walkway: a ring as one polygon with a hole, joined by a doubled edge.
    let floor = obj.ring(32, 1.38, 5.35);
    let hole = obj.ring(32, 0.7, 5.35);
    let mut ring = floor.clone();
    ring.push(floor[0]);
    ring.push(hole[0]);
    ring.extend(hole[1..].iter().rev());
    ring.push(hole[0]);
    obj.polygon(&ring);
    // Eight sides of an octagon, each with two teeth.
    for side in 0..8 {
        let at = |t: f32, y: f32, radius: f32| {
            let corner = |k: i32| libm::sincosf(TAU * k as f32 / 8.0);
            let ((ax, az), (bx, bz)) = (corner(side), corner(side + 1));
            [radius * (ax + t * (bx - ax)), y, radius * (az + t * (bz - az))]
        };
        let outline = [
            (0.0, 5.35),
            (1.0, 5.35),
            (1.0, 5.9),
            (0.8, 5.9),
            (0.8, 5.6),
            (0.65, 5.6),
            (0.65, 5.9),
            (0.35, 5.9),
            (0.35, 5.6),
            (0.2, 5.6),
            (0.2, 5.9),
            (0.0, 5.9),
        ];
        let outside: Vec<usize> = outline.map(|(t, y)| obj.vertex(at(t, y, 1.36))).to_vec();
        let inside: Vec<usize> = outline.map(|(t, y)| obj.vertex(at(t, y, 1.2))).to_vec();
        obj.polygon(&outside);
        obj.polygon(&inside.iter().rev().copied().collect::<Vec<_>>());
        for k in 1..outline.len() - 1 {
            obj.polygon(&[outside[k], inside[k], inside[k + 1], outside[k + 1]]);
        }
    }
}

/// A room of glass about a lamp, between two slabs.
fn lantern(obj: &mut Obj) {
    obj.line("g lantern\nusemtl glass");
    let outer = [obj.ring(8, 0.62, 5.51), obj.ring(8, 0.62, 6.49)];
    let inner = [obj.ring(8, 0.57, 5.51), obj.ring(8, 0.57, 6.49)];
    // Panes have thickness: the front of each side points out of the glass.
    obj.band(&outer[0], &outer[1]);
    obj.band(&inner[1], &inner[0]);
    for (k, up) in [(0, false), (1, true)] {
        for side in 0..8 {
            let next = (side + 1) % 8;
            let (a, b) = if up { (side, next) } else { (next, side) };
            obj.polygon(&[outer[k][a], outer[k][b], inner[k][b], inner[k][a]]);
        }
    }
    obj.line("usemtl stone");
    for (low, high) in [(5.36, 5.5), (6.5, 6.59)] {
        let (below, above) = (obj.ring(8, 0.75, low), obj.ring(8, 0.75, high));
        obj.band(&below, &above);
        obj.polygon(&above);
        obj.polygon(&below.into_iter().rev().collect::<Vec<_>>());
    }
    obj.line("usemtl lamp");
    let (below, above) = (obj.ring(6, 0.14, 5.7), obj.ring(6, 0.14, 6.2));
    obj.band(&below, &above);
    obj.polygon(&above);
    obj.polygon(&below.into_iter().rev().collect::<Vec<_>>());
}

/// A cone of tiles, and a golden ball on it.
fn roof(obj: &mut Obj) {
    obj.line("g roof\nusemtl tiles");
    let eaves = obj.ring(16, 0.95, 6.6);
    let tip = obj.vertex([0.0, 8.2, 0.0]);
    for k in 0..16 {
        obj.polygon(&[eaves[k], eaves[(k + 1) % 16], tip]);
    }
    obj.polygon(&eaves.into_iter().rev().collect::<Vec<_>>());
    obj.line("g ball\nusemtl gold");
    let rings: Vec<Vec<usize>> = (1..8)
        .map(|k| {
            let (sin, cos) = libm::sincosf(TAU / 2.0 * k as f32 / 8.0);
            obj.ring(16, 0.16 * sin, 8.3 - 0.16 * cos)
        })
        .collect();
    for pair in rings.windows(2) {
        obj.band(&pair[0], &pair[1]);
    }
    obj.polygon(&rings[0].iter().rev().copied().collect::<Vec<_>>());
    obj.polygon(&rings[6]);
}
