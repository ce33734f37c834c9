//! Reading numbers out of buffers, by way of checked accessors.

use std::borrow::Cow;
use std::cell::Cell;
use std::collections::BTreeMap;

use super::accessor::{Accessor, Component, Shape, View};
use super::draco::{Declared, Unpacked};
use super::json::Fault;
use super::notices::Notices;
use super::rows::{Rows, Stored};

/// Memory that decoded arrays may always take.
const FREE_BYTES: u64 = 1 << 30;

/// Memory that they may take beyond, as a multiple of the buffers' length: bytes can become floats,
/// and accessors can overlap, but a small file must not ask for gigabytes.
const EXPANSION: u64 = 32;

/// Placed meshes that there may always be.
const FREE_PLACEMENTS: u64 = 1 << 22;

/// Placed meshes that there may be beyond, for each byte of the buffers: a mesh of many parts is
/// placed by each of a node's copies, which takes some bytes there.
const PLACEMENTS_PER_BYTE: u64 = 8;

/// The same for each byte of a mesh packed by Draco: large ones take one or two for a triangle.
const MESH_EXPANSION: u64 = 256;

/// The most elements of an accessor that has no buffer view: nothing pays for its zeros.
const MAX_ZEROS: u64 = 1 << 22;

/// The buffers and everything that leads into them.
#[derive(Debug)]
pub struct Storage<'a> {
    buffers: Vec<Option<Cow<'a, [u8]>>>,
    views: Vec<View>,
    accessors: Vec<Accessor>,
    /// Of packed views their bytes.
    unpacked: BTreeMap<usize, Vec<u8>>,
    /// Bytes that may still be decoded.
    budget: Cell<u64>,
    /// Meshes that may still be placed.
    placement_budget: Cell<u64>,
}

impl<'a> Storage<'a> {
    /// Bytes of all buffers that are there.
    pub fn buffer_bytes(&self) -> u64 {
        self.buffers.iter().flatten().map(|bytes| bytes.len() as u64).sum()
    }

    /// Buffers that are not needed may be absent; the others are as long as the document says.
    pub fn new(
        buffers: Vec<Option<Cow<'a, [u8]>>>,
        views: Vec<View>,
        accessors: Vec<Accessor>,
    ) -> Self {
        let total: u64 = buffers.iter().flatten().map(|bytes| bytes.len() as u64).sum();
        let allow =
            |free: u64, each: u64| Cell::new(free.saturating_add(total.saturating_mul(each)));
        let budget = allow(FREE_BYTES, EXPANSION);
        let placement_budget = allow(FREE_PLACEMENTS, PLACEMENTS_PER_BYTE);
        Self { buffers, views, accessors, unpacked: BTreeMap::new(), budget, placement_budget }
    }

    /// An accessor that the document has.
    pub fn accessor(&self, index: usize) -> &Accessor {
        &self.accessors[index]
    }

    /// Unpacks those of some views that are packed.
    ///
    /// # Errors
    /// What is wrong with the packed bytes, or that there is far too much to unpack.
    pub fn unpack(&mut self, views: &[usize]) -> Result<(), Fault> {
        for &index in views {
            let View { packed: Some(packed), length, .. } = self.views[index] else { continue };
            let place = format!("/bufferViews/{index}");
            self.reserve(&place, length)?;
            let bytes = self.range(index, packed.buffer, packed.offset, packed.length)?;
            let bytes = packed.unpack(bytes).map_err(|message| Fault::new(place, message))?;
            self.unpacked.insert(index, bytes);
        }
        Ok(())
    }

    /// Unpacks those of some views that hold meshes packed by Draco: their parts become views.
    ///
    /// # Errors
    /// What is wrong with the packed bytes, or that there is far too much to unpack.
    pub fn unpack_meshes(&mut self, views: &[usize], notices: &mut Notices) -> Result<(), Fault> {
        let mut parts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, accessor) in self.accessors.iter().enumerate() {
            if let Some(part) = accessor.part.filter(|part| views.binary_search(&part.view).is_ok())
            {
                parts.entry(part.view).or_default().push(index);
            }
        }
        for (view, parts) in parts {
            self.unpack_mesh(view, &parts, notices)?;
        }
        Ok(())
    }

    /// Unpacks the mesh in a view for the accessors that are its parts.
    fn unpack_mesh(
        &mut self,
        view: usize,
        parts: &[usize],
        notices: &mut Notices,
    ) -> Result<(), Fault> {
        let place = self.accessors[parts[0]].place.clone();
        let declared = self.declare(parts);
        let bytes = self.view(view)?;
        let justified = (bytes.len() as u64).saturating_mul(MESH_EXPANSION);
        self.budget.set(self.budget.get().saturating_add(justified));
        self.reserve(&place, declared.bytes())?;
        let mesh =
            Unpacked::decode(bytes, declared).map_err(|message| Fault::new(place, message))?;
        for &index in parts {
            let accessor = &mut self.accessors[index];
            let array = match accessor.part.and_then(|part| part.attribute) {
                Some(id) => mesh.attribute(id),
                None => mesh.corners(),
            };
            let array = array.map_err(|message| Fault::new(accessor.place.clone(), message))?;
            if array.count == 0 {
                return Err(Fault::new(accessor.place.clone(), "holds no triangles"));
            }
            if accessor.count != 0 && accessor.count != array.count {
                let message = "holds another number of elements than its accessor declares";
                notices.add(accessor.place.clone(), message);
            }
            let is_integer = |component| !matches!(component, Component::F32 | Component::U32);
            let (from, to) = (is_integer(accessor.component), is_integer(array.component));
            accessor.normalized = to && if from { accessor.normalized } else { array.normalized };
            accessor.fill(self.views.len(), array.component, array.shape, array.count);
            let length = array.bytes.len() as u64;
            self.unpacked.insert(self.views.len(), array.bytes);
            self.views.push(View { buffer: 0, offset: 0, length, stride: None, packed: None });
        }
        Ok(())
    }

    /// What the accessors that are parts of a packed mesh declare of it.
    fn declare(&self, parts: &[usize]) -> Declared {
        let mut declared = Declared::default();
        for accessor in parts.iter().map(|&index| &self.accessors[index]) {
            if accessor.part.is_some_and(|part| part.attribute.is_some()) {
                declared.vertices = declared.vertices.max(accessor.count);
                declared.vertex_bytes += accessor.element_size();
            } else {
                declared.triangles = declared.triangles.max(accessor.count / 3);
            }
        }
        if declared.triangles == 0 {
            declared.triangles = declared.vertices.saturating_mul(2);
        }
        declared
    }

    /// The bytes of a buffer view; of a packed one only once it is unpacked.
    pub fn view(&self, index: usize) -> Result<&[u8], Fault> {
        if let Some(bytes) = self.unpacked.get(&index) {
            return Ok(bytes);
        }
        let View { buffer, offset, length, .. } = self.views[index];
        self.range(index, buffer, offset, length)
    }

    fn range(&self, index: usize, buffer: usize, offset: u64, length: u64) -> Result<&[u8], Fault> {
        let bytes = self.buffers[buffer].as_deref().ok_or_else(|| {
            Fault::new(format!("/buffers/{buffer}"), "has no data that dapple can read")
        })?;
        let range = offset as usize..(offset + length) as usize;
        bytes.get(range).ok_or_else(|| {
            Fault::new(format!("/bufferViews/{index}"), "is past the end of its buffer")
        })
    }

    /// Sets memory for decoded numbers aside.
    pub fn reserve(&self, place: &str, bytes: u64) -> Result<(), Fault> {
        let message = "the geometry takes far more memory than the buffers' length can justify";
        spend(&self.budget, bytes).ok_or_else(|| Fault::new(place, message))
    }

    /// Accounts for so many placed meshes.
    pub fn reserve_placements(&self, place: &str, count: u64) -> Result<(), Fault> {
        let message = "there are far more placed meshes than the buffers' length can justify";
        spend(&self.placement_budget, count).ok_or_else(|| Fault::new(place, message))
    }

    /// Vectors of `N` numbers, or scalars where `N` is 1.
    pub fn vectors<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, Fault> {
        let accessor = &self.accessors[index];
        Self::expect(accessor, N, "numbers")?;
        self.reserve(&accessor.place, accessor.count.saturating_mul(4 * N as u64))?;
        let decode = decoder(accessor.component, accessor.normalized);
        let size = accessor.component.size() as usize;
        self.elements(accessor, [0.0; N], |bytes| {
            let mut vector = [0.0; N];
            for (slot, number) in vector.iter_mut().zip(bytes.chunks_exact(size)) {
                *slot = decode(number);
            }
            vector
        })
    }

    /// The same, each decoded when it is asked for.
    pub fn rows<const N: usize>(&self, index: usize) -> Result<Rows<'_, N>, Fault> {
        let accessor = &self.accessors[index];
        let (Some((view, offset)), None) = (accessor.base, &accessor.sparse) else {
            return self.vectors::<N>(index).map(Rows::Decoded);
        };
        Self::expect(accessor, N, "numbers")?;
        Ok(Rows::Stored(Stored {
            bytes: &self.view(view)?[offset as usize..],
            stride: accessor.stride as usize,
            size: accessor.component.size() as usize,
            decode: decoder(accessor.component, accessor.normalized),
        }))
    }

    /// Matrices of four columns, of floats.
    pub fn matrices(&self, index: usize) -> Result<Vec<[f32; 16]>, Fault> {
        let accessor = &self.accessors[index];
        if accessor.shape != Shape::Matrix(4) || accessor.component != Component::F32 {
            let message = "must be of type MAT4 and of floats to be used for matrices";
            return Err(Fault::new(accessor.place.clone(), message));
        }
        self.reserve(&accessor.place, accessor.count.saturating_mul(64))?;
        let decode = decoder(Component::F32, false);
        self.elements(accessor, [0.0; 16], |bytes| {
            let mut matrix = [0.0; 16];
            for (slot, number) in matrix.iter_mut().zip(bytes.chunks_exact(4)) {
                *slot = decode(number);
            }
            matrix
        })
    }

    /// Unsigned integers.
    pub fn indices(&self, index: usize) -> Result<Vec<u32>, Fault> {
        let accessor = &self.accessors[index];
        Self::expect(accessor, 1, "indices")?;
        let decode = index_decoder(accessor.component).ok_or_else(|| {
            Fault::new(accessor.place.clone(), "indices must be unsigned integers")
        })?;
        self.reserve(&accessor.place, accessor.count.saturating_mul(4))?;
        self.elements(accessor, 0, decode)
    }

    fn expect(accessor: &Accessor, count: usize, what: &str) -> Result<(), Fault> {
        let found = match accessor.shape {
            Shape::Scalar => 1,
            Shape::Vector(found) => found as usize,
            Shape::Matrix(_) => 0,
        };
        if found == count {
            return Ok(());
        }
        let wanted = if count == 1 { "SCALAR".to_owned() } else { format!("VEC{count}") };
        let message = format!("must be of type {wanted} to be used for {what}");
        Err(Fault::new(accessor.place.clone(), message))
    }

    /// All elements, the sparse ones put in.
    fn elements<T: Copy>(
        &self,
        accessor: &Accessor,
        zero: T,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, Fault> {
        if accessor.base.is_none() && accessor.count > MAX_ZEROS {
            let message = format!("more than {MAX_ZEROS} elements without a buffer view");
            return Err(Fault::new(format!("{}/count", accessor.place), message));
        }
        let size = accessor.element_size() as usize;
        let mut elements: Vec<T> = match accessor.base {
            None => vec![zero; accessor.count as usize],
            Some((view, offset)) => {
                let bytes = &self.view(view)?[offset as usize..];
                let chunks = bytes.chunks(accessor.stride as usize).take(accessor.count as usize);
                chunks.map(|chunk| decode(&chunk[..size])).collect()
            }
        };
        let Some(sparse) = &accessor.sparse else { return Ok(elements) };

        let (view, offset, kind) = sparse.indices;
        let decode_index = index_decoder(kind).expect("sparse indices are unsigned");
        let indices = self.view(view)?[offset as usize..].chunks_exact(kind.size() as usize);
        let (view, offset) = sparse.values;
        let values = self.view(view)?[offset as usize..].chunks_exact(size);
        for (i, (index, value)) in indices.zip(values).take(sparse.count as usize).enumerate() {
            let index = decode_index(index);
            let Some(slot) = elements.get_mut(index as usize) else {
                let message =
                    format!("sparse index {i} is {index}, beyond the {} elements", accessor.count);
                return Err(Fault::new(format!("{}/sparse/indices", accessor.place), message));
            };
            *slot = decode(value);
        }
        Ok(elements)
    }
}

/// Takes so much from a budget, if there is as much.
fn spend(budget: &Cell<u64>, amount: u64) -> Option<()> {
    budget.set(budget.get().checked_sub(amount)?);
    Some(())
}

type Decode<T> = fn(&[u8]) -> T;

/// Of one number's bytes, its value (glTF 2.0, 3.6.2.2 for the normalised ones).
fn decoder(component: Component, normalized: bool) -> Decode<f32> {
    match (component, normalized) {
        (Component::I8, false) => |b| f32::from(b[0] as i8),
        (Component::I8, true) => |b| (f32::from(b[0] as i8) / 127.0).max(-1.0),
        (Component::U8, false) => |b| f32::from(b[0]),
        (Component::U8, true) => |b| f32::from(b[0]) / 255.0,
        (Component::I16, false) => |b| f32::from(i16::from_le_bytes([b[0], b[1]])),
        (Component::I16, true) => {
            |b| (f32::from(i16::from_le_bytes([b[0], b[1]])) / 32767.0).max(-1.0)
        }
        (Component::U16, false) => |b| f32::from(u16::from_le_bytes([b[0], b[1]])),
        (Component::U16, true) => |b| f32::from(u16::from_le_bytes([b[0], b[1]])) / 65535.0,
        (Component::U32, _) => |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32,
        (Component::F32, _) => |b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
    }
}

fn index_decoder(component: Component) -> Option<Decode<u32>> {
    match component {
        Component::U8 => Some(|b| u32::from(b[0])),
        Component::U16 => Some(|b| u32::from(u16::from_le_bytes([b[0], b[1]]))),
        Component::U32 => Some(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        Component::I8 | Component::I16 | Component::F32 => None,
    }
}

#[cfg(test)]
mod tests;
