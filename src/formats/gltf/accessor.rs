//! Accessors as the document declares them: typed arrays within buffer views (glTF 2.0, 3.6).
//!
//! All that can be judged without the bytes is judged here: afterwards no range within a buffer
//! view can be past its end, and no arithmetic on them can overflow.

pub use super::element::{Component, Shape};
use super::json::{Fault, Object};
use super::meshopt::Packed;
use super::notices::Notices;

/// A range of a buffer.
#[derive(Clone, Debug)]
pub struct View {
    /// Which buffer.
    pub buffer: usize,
    /// Where the range begins, in bytes.
    pub offset: u64,
    /// How long it is, in bytes.
    pub length: u64,
    /// From one vertex's data to the next, in bytes; none: they are packed tightly.
    pub stride: Option<u64>,
    /// Where its bytes are instead, packed.
    pub packed: Option<Packed>,
}

impl View {
    /// The buffer that must be there.
    pub fn source(&self) -> usize {
        self.packed.map_or(self.buffer, |packed| packed.buffer)
    }
}

/// Elements that replace some of the others.
#[derive(Clone, Debug)]
pub struct Sparse {
    /// How many.
    pub count: u64,
    /// View, offset in it and type of the indices of those replaced, which increase strictly.
    pub indices: (usize, u64, Component),
    /// View and offset of what replaces them, packed tightly.
    pub values: (usize, u64),
}

/// A part of a mesh that is packed by Draco.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Part {
    /// The buffer view that holds the mesh.
    pub view: usize,
    /// The number of an attribute; none: the corners of the triangles.
    pub attribute: Option<u32>,
}

/// An array of numbers, vectors or matrices.
#[derive(Clone, Debug)]
pub struct Accessor {
    /// The pointer to it.
    pub place: String,
    /// Buffer view and offset in it; none: all zeros.
    pub base: Option<(usize, u64)>,
    /// Of what type its numbers are.
    pub component: Component,
    /// How many make an element.
    pub shape: Shape,
    /// Whether integers stand for 0..=1 or -1..=1.
    pub normalized: bool,
    /// How many elements.
    pub count: u64,
    /// From one element to the next, in bytes.
    pub stride: u64,
    /// What is replaced.
    pub sparse: Option<Sparse>,
    /// Where its elements come from instead.
    pub part: Option<Part>,
}

impl Accessor {
    /// An array that is a part of a packed mesh, of which nothing is known but its type.
    pub fn of_part(part: Part, place: String, component: Component, shape: Shape) -> Self {
        Self {
            place,
            base: None,
            component,
            shape,
            normalized: false,
            count: 0,
            stride: shape.packed_stride(component),
            sparse: None,
            part: Some(part),
        }
    }

    /// A part of a packed mesh that is declared as this accessor is.
    pub fn as_part(&self, part: Part, place: String) -> Self {
        let Self { component, shape, normalized, count, .. } = *self;
        Self { normalized, count, ..Self::of_part(part, place, component, shape) }
    }

    /// The buffer views that it reads.
    pub fn views(&self) -> impl Iterator<Item = usize> {
        let sparse = self.sparse.iter().flat_map(|sparse| [sparse.indices.0, sparse.values.0]);
        let (base, part) = (self.base.map(|(view, _)| view), self.part.map(|part| part.view));
        base.into_iter().chain(sparse).chain(part)
    }

    /// Lets its elements be those that fill a buffer view.
    pub fn fill(&mut self, view: usize, component: Component, shape: Shape, count: u64) {
        self.base = Some((view, 0));
        (self.component, self.shape, self.count) = (component, shape, count);
        self.stride = shape.packed_stride(component);
    }

    /// Whether its elements are vectors of so many numbers.
    pub fn is_vector(&self, numbers: u64) -> bool {
        self.shape == Shape::Vector(numbers)
    }

    /// How many numbers make an element; of a matrix none.
    pub fn numbers(&self) -> u64 {
        match self.shape {
            Shape::Scalar => 1,
            Shape::Vector(count) => count,
            Shape::Matrix(_) => 0,
        }
    }

    /// Bytes per element, without those between elements.
    pub fn element_size(&self) -> u64 {
        self.shape.size(self.component)
    }
}

/// Reads the buffer views; `buffers` are the lengths of the buffers.
pub fn views(root: &Object, buffers: &[u64], notices: &mut Notices) -> Result<Vec<View>, Fault> {
    root.objects("bufferViews")?.iter().map(|view| self::view(view, buffers, notices)).collect()
}

/// The target of buffer views that hold indices.
const ELEMENT_ARRAY: u64 = 34963;

fn view(view: &Object, buffers: &[u64], notices: &mut Notices) -> Result<View, Fault> {
    let buffer = view.required_reference("buffer", "buffer", buffers.len())?;
    let offset = view.whole("byteOffset")?.unwrap_or(0);
    let length = view.required_whole("byteLength")?;
    if length == 0 {
        return Err(view.fault_at("byteLength", "must be at least 1"));
    }
    let available = buffers[buffer];
    if offset.checked_add(length).is_none_or(|end| end > available) {
        return Err(view.fault(format!(
            "{length} bytes from byte {offset} on are past the end of buffer {buffer} \
             ({available} bytes)"
        )));
    }
    let stride = view.whole("byteStride")?;
    if let Some(stride) = stride {
        if !(4..=252).contains(&stride) {
            return Err(view.fault_at("byteStride", format!("{stride} is not within 4 to 252")));
        }
        if !stride.is_multiple_of(4) {
            notices.add(view.at("byteStride"), "is not a multiple of 4, as the format asks");
        }
        if view.whole("target")? == Some(ELEMENT_ARRAY) {
            notices.add(view.at("byteStride"), "only data of vertices have a stride");
        }
    }
    let packed = Packed::read(view, buffers, length, stride)?;
    Ok(View { buffer, offset, length, stride, packed })
}

/// Reads the accessors.
pub fn accessors(
    root: &Object,
    views: &[View],
    notices: &mut Notices,
) -> Result<Vec<Accessor>, Fault> {
    let all = root.objects("accessors")?;
    all.iter().map(|accessor| self::accessor(accessor, views, notices)).collect()
}

fn accessor(object: &Object, views: &[View], notices: &mut Notices) -> Result<Accessor, Fault> {
    let component = component(object)?;
    let name = object.text("type")?.ok_or_else(|| object.absent("type"))?;
    let shape = Shape::of(name)
        .ok_or_else(|| object.fault_at("type", format!("{name:?} is no type of accessors")))?;
    let count = object.required_whole("count")?;
    if count == 0 {
        return Err(object.fault_at("count", "must be at least 1"));
    }
    let mut normalized = object.flag("normalized")?;
    if normalized && matches!(component, Component::F32 | Component::U32) {
        notices.add(object.at("normalized"), "only 8 and 16 bit integers can be normalized");
        normalized = false;
    }

    let offset = object.whole("byteOffset")?.unwrap_or(0);
    let size = shape.size(component);
    let view = object.reference("bufferView", "buffer view", views.len())?;
    let stride = view.and_then(|view| views[view].stride).unwrap_or(shape.packed_stride(component));
    if let Some(view) = view {
        if stride < size {
            let message = format!(
                "its elements take {size} bytes, but buffer view {view} has a stride of {stride}"
            );
            return Err(object.fault(message));
        }
        within(object, (view, &views[view]), offset, (count, size, stride))?;
        check_alignment(object, views[view].offset, offset, component, notices);
    }
    let sparse = match object.object("sparse")? {
        Some(sparse) => Some(self::sparse(&sparse, views, count, size)?),
        None => None,
    };
    Ok(Accessor {
        place: object.place().to_owned(),
        base: view.map(|view| (view, offset)),
        component,
        shape,
        normalized,
        count,
        stride,
        sparse,
        part: None,
    })
}

fn component(object: &Object) -> Result<Component, Fault> {
    let code = object.required_whole("componentType")?;
    Component::of(code).ok_or_else(|| {
        object.fault_at("componentType", format!("{code} is no type of numbers (5120 to 5126)"))
    })
}

/// Misaligned data are read all the same, but other programs may refuse them.
fn check_alignment(
    object: &Object,
    view_offset: u64,
    offset: u64,
    component: Component,
    notices: &mut Notices,
) {
    let size = component.size();
    if !offset.is_multiple_of(size) || !(view_offset + offset).is_multiple_of(size) {
        notices.add(object.place(), "its data are not aligned to the size of their numbers");
    }
}

fn sparse(object: &Object, views: &[View], total: u64, size: u64) -> Result<Sparse, Fault> {
    let count = object.required_whole("count")?;
    if count == 0 || count > total {
        let message = format!("{count} is not within 1 and the accessor's count {total}");
        return Err(object.fault_at("count", message));
    }
    let indices = object.object("indices")?.ok_or_else(|| object.absent("indices"))?;
    let values = object.object("values")?.ok_or_else(|| object.absent("values"))?;

    let kind = component(&indices)?;
    if !matches!(kind, Component::U8 | Component::U16 | Component::U32) {
        return Err(indices.fault_at("componentType", "indices must be unsigned integers"));
    }
    let packed = |object: &Object, size: u64| {
        let view = object.required_reference("bufferView", "buffer view", views.len())?;
        let offset = object.whole("byteOffset")?.unwrap_or(0);
        within(object, (view, &views[view]), offset, (count, size, size))?;
        Ok::<_, Fault>((view, offset))
    };
    let (view, offset) = packed(&indices, kind.size())?;
    Ok(Sparse { count, indices: (view, offset, kind), values: packed(&values, size)? })
}

/// Checks that elements lie within a view; `elements` are their count, size and stride.
fn within(
    object: &Object,
    (index, view): (usize, &View),
    offset: u64,
    (count, size, stride): (u64, u64, u64),
) -> Result<(), Fault> {
    let last = (count - 1).checked_mul(stride);
    let end = last.and_then(|last| last.checked_add(size)?.checked_add(offset));
    match end {
        Some(end) if end <= view.length => Ok(()),
        Some(end) => Err(object.fault(format!(
            "byte range {offset}..{end} is past the end of buffer view {index} ({} bytes)",
            view.length
        ))),
        None => Err(object.fault(format!("{count} elements are past all bounds"))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn parse(text: &str, views: &[View]) -> Result<Accessor, String> {
        let value = json::parse(text.as_bytes()).expect("valid JSON");
        let object = Object::new(&value, "/accessors/3".to_owned()).expect("an object");
        accessor(&object, views, &mut Notices::default())
            .map_err(|fault| format!("{}: {}", fault.place, fault.message))
    }

    fn view(length: u64) -> View {
        View { buffer: 0, offset: 0, length, stride: None, packed: None }
    }

    #[test]
    fn a_range_past_the_end_is_told_in_bytes() {
        let text = r#"{"bufferView": 1, "componentType": 5126, "type": "VEC3", "count": 8}"#;
        let error = parse(text, &[view(96), view(48)]).expect_err("needs 96 bytes");
        assert_eq!(
            error,
            "/accessors/3: byte range 0..96 is past the end of buffer view 1 (48 bytes)"
        );
        assert!(parse(text, &[view(48), view(96)]).is_ok());
    }

    #[test]
    fn counts_and_offsets_that_overflow_are_refused() {
        for text in [
            r#"{"bufferView": 0, "componentType": 5126, "type": "VEC3",
                "count": 18446744073709551615}"#,
            r#"{"bufferView": 0, "componentType": 5121, "type": "SCALAR", "count": 1,
                "byteOffset": 18446744073709551615}"#,
            r#"{"bufferView": 0, "componentType": 5121, "type": "SCALAR", "count": 0}"#,
        ] {
            assert!(parse(text, &[view(1000)]).is_err(), "{text}");
        }
    }

    #[test]
    fn the_last_element_needs_no_padding_after_it() {
        let text = r#"{"bufferView": 0, "componentType": 5121, "type": "VEC3", "count": 2}"#;
        let strided = |length| View { stride: Some(16), ..view(length) };
        assert!(parse(text, &[strided(19)]).is_ok());
        assert!(parse(text, &[strided(18)]).is_err());
    }

    #[test]
    fn columns_of_matrices_are_aligned() {
        let sizes = |columns, component| {
            let shape = Shape::Matrix(columns);
            (shape.size(component), shape.packed_stride(component))
        };
        assert_eq!(sizes(2, Component::U8), (6, 8));
        assert_eq!(sizes(3, Component::I16), (22, 24));
        assert_eq!(sizes(4, Component::F32), (64, 64));
    }
}
