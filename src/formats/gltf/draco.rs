//! Meshes that are packed by Draco, unpacked: triangles, and attributes as packed arrays.
//!
//! The decoder is a crate without unsafe code that returns errors and keeps to limits. What it may
//! take is told to it by what the document declares, and asked of memory before it begins.

use draco_core::decode_limits::DecodeLimits;
use draco_core::draco_types::DataType;
use draco_core::geometry_attribute::PointAttribute;
use draco_core::geometry_indices::PointIndex;
use draco_core::{DecoderBuffer, Mesh, MeshDecoder};

use super::accessor::{Component, Shape};
use crate::files::{guard, memory};

/// What the decoder holds for each triangle while it works: corners, their opposites, the order of
/// the walk, and seams of attributes.
const WORK_PER_TRIANGLE: u64 = 200;

/// Bytes that a vertex may have beyond those of the attributes that are asked for, and what the
/// decoder holds for it while it works.
const WORK_PER_VERTEX: u64 = 128;

/// The newest version of the packing: major, minor.
const NEWEST: &[u8] = &[2, 2];

/// How much a packed mesh may hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Declared {
    /// Triangles.
    pub triangles: u64,
    /// Vertices.
    pub vertices: u64,
    /// Bytes of all attributes of a vertex.
    pub vertex_bytes: u64,
}

impl Declared {
    /// Bytes of what comes out.
    pub fn bytes(self) -> u64 {
        let vertices = self.vertices.saturating_mul(self.vertex_bytes);
        self.triangles.saturating_mul(12).saturating_add(vertices)
    }
}

/// A mesh that was unpacked.
pub struct Unpacked {
    mesh: Mesh,
}

/// An array of an unpacked mesh, packed tightly.
pub struct Array {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// How one number is stored.
    pub component: Component,
    /// How many numbers make an element.
    pub shape: Shape,
    /// Whether integers stand for 0..=1 or -1..=1.
    pub normalized: bool,
    /// How many elements.
    pub count: u64,
}

impl Unpacked {
    /// Unpacks a mesh. Some programs declare less than there is: up to twice as much is read.
    ///
    /// # Errors
    /// What is wrong with the bytes, that there is far more than was declared, or that memory is
    /// short.
    pub fn decode(bytes: &[u8], declared: Declared) -> Result<Self, String> {
        if bytes.get(5..7).is_some_and(|version| version > NEWEST) {
            return Err("is of a version of Draco that is not known".to_owned());
        }
        let most = |count: u64| count.saturating_mul(2).saturating_add(64);
        let (triangles, vertices) = (most(declared.triangles), most(declared.vertices));
        let values = vertices.saturating_mul(declared.vertex_bytes.saturating_add(64));
        let work = triangles.saturating_mul(WORK_PER_TRIANGLE);
        let work = work.saturating_add(vertices.saturating_mul(WORK_PER_VERTEX));
        memory::claim(work.saturating_add(values))
            .map_err(|error| format!("unpacked it {error}"))?;
        let limits = DecodeLimits::default()
            .with_max_faces(triangles)
            .with_max_points(vertices)
            .with_max_decoded_bytes(values);
        let mesh = guard::run("cannot be unpacked by Draco", || {
            let mut mesh = Mesh::new();
            let mut source = DecoderBuffer::new(bytes).with_limits(limits);
            MeshDecoder::new().decode(&mut source, &mut mesh).map(|()| mesh)
        })?;
        let mesh = mesh.map_err(|error| format!("cannot be unpacked by Draco: {error}"))?;
        if mesh.num_points() as u64 > vertices || mesh.num_faces() as u64 > triangles {
            let (faces, points) = (mesh.num_faces(), mesh.num_points());
            return Err(format!("holds {faces} triangles of {points} vertices: far too many"));
        }
        Ok(Self { mesh })
    }

    /// Which vertices make its triangles.
    ///
    /// # Errors
    /// If one is not there.
    pub fn corners(&self) -> Result<Array, String> {
        let faces = self.mesh.faces();
        let mut bytes = Vec::with_capacity(12 * faces.len());
        for point in faces.iter().flatten() {
            if point.0 as usize >= self.mesh.num_points() {
                return Err(format!("a triangle has vertex {} of none such", point.0));
            }
            bytes.extend(point.0.to_le_bytes());
        }
        let count = 3 * faces.len() as u64;
        let (component, shape) = (Component::U32, Shape::Scalar);
        Ok(Array { bytes, component, shape, normalized: false, count })
    }

    /// The numbers of its attributes.
    pub fn attributes(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.mesh.num_attributes()).map(|at| self.mesh.attribute(at).unique_id())
    }

    /// The attribute of a number, for each vertex.
    ///
    /// # Errors
    /// If there is none, or its values are not there.
    pub fn attribute(&self, id: u32) -> Result<Array, String> {
        let absent = || format!("has no attribute {id}");
        let attribute = self.mesh.attribute_by_unique_id(id).ok_or_else(absent)?;
        let numbers = u64::from(attribute.num_components());
        if !(1..=4).contains(&numbers) {
            return Err(format!("attribute {id} has {numbers} numbers a vertex"));
        }
        let shape = if numbers == 1 { Shape::Scalar } else { Shape::Vector(numbers) };
        let count = self.mesh.num_points();
        let component = component(attribute.data_type());
        let bytes = if let Some(component) = component {
            let size = (numbers * component.size()) as usize;
            packed(attribute, count, size).ok_or_else(|| format!("attribute {id} is cut"))?
        } else {
            // Wide numbers, which glTF does not have.
            let values = attribute.read_f32s(count, numbers as usize);
            values.into_iter().flat_map(f32::to_le_bytes).collect()
        };
        let normalized = attribute.normalized();
        let component = component.unwrap_or(Component::F32);
        Ok(Array { bytes, component, shape, normalized, count: count as u64 })
    }
}

/// The component that is stored as Draco's numbers are.
fn component(kind: DataType) -> Option<Component> {
    Some(match kind {
        DataType::Int8 => Component::I8,
        DataType::Uint8 | DataType::Bool => Component::U8,
        DataType::Int16 => Component::I16,
        DataType::Uint16 => Component::U16,
        DataType::Uint32 => Component::U32,
        DataType::Float32 => Component::F32,
        _ => return None,
    })
}

/// The values of all vertices, of so many bytes each.
fn packed(attribute: &PointAttribute, count: usize, size: usize) -> Option<Vec<u8>> {
    let data = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(count * size);
    for point in 0..count as u32 {
        let value = attribute.mapped_index(PointIndex(point)).0 as usize;
        let start = value.checked_mul(size)?;
        bytes.extend(data.get(start..start.checked_add(size)?)?);
    }
    Some(bytes)
}
