//! Buffer views that are packed: EXT_meshopt_compression, and KHR_meshopt_compression, which has a
//! second version of attributes and a filter for colours.

use meshoptimizer_rs::Error;
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{
    BufferView, Filter, Mode, decode_filter_color, decode_filter_exp, decode_filter_oct,
    decode_filter_quat, decode_vertex_buffer,
};

use super::json::{Fault, Object};
use crate::files::memory;

/// The most that a byte may unpack to: an attribute that does not change takes a bit for sixteen
/// bytes, and that some files have.
const MOST_EXPANSION: u64 = 4096;

/// Where the packed bytes are, and what they hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packed {
    /// Which buffer.
    pub buffer: usize,
    /// Where they begin in it.
    pub offset: u64,
    /// How many they are.
    pub length: u64,
    /// How many come out.
    unpacked: u64,
    layout: BufferView,
    /// Of attributes of KHR_meshopt_compression what they are.
    attributes: Option<Attributes>,
}

/// Attributes of either version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Attributes {
    count: usize,
    size: usize,
    /// What is done to them; none: they are colours.
    filter: Option<Filter>,
}

impl Attributes {
    fn decode(self, packed: &[u8]) -> Result<Vec<u8>, Error> {
        let Self { count, size, filter } = self;
        let workspace = &mut Workspace::default();
        let mut bytes = decode_vertex_buffer(count, size, packed, workspace)?;
        match filter {
            Some(Filter::None) => {}
            Some(Filter::Octahedral) => decode_filter_oct(&mut bytes, count, size, workspace)?,
            Some(Filter::Quaternion) => decode_filter_quat(&mut bytes, count, size, workspace)?,
            Some(Filter::Exponential) => decode_filter_exp(&mut bytes, count, size, workspace)?,
            None => decode_filter_color(&mut bytes, count, size, workspace)?,
        }
        Ok(bytes)
    }
}

impl Packed {
    /// What the extension says of a view of `length` bytes with that `stride`, if it is packed;
    /// `buffers` are the lengths of all buffers.
    pub fn read(
        view: &Object,
        buffers: &[u64],
        length: u64,
        stride: Option<u64>,
    ) -> Result<Option<Self>, Fault> {
        let khr = view.extension("KHR_meshopt_compression")?;
        let is_khr = khr.is_some();
        let ext = view.extension("EXT_meshopt_compression")?;
        if khr.is_some() && ext.is_some() {
            return Err(view.fault("is packed in two ways"));
        }
        let Some(packed) = khr.or(ext) else { return Ok(None) };
        let buffer = packed.required_reference("buffer", "buffer", buffers.len())?;
        let offset = packed.whole("byteOffset")?.unwrap_or(0);
        let bytes = packed.required_whole("byteLength")?;
        if offset.checked_add(bytes).is_none_or(|end| end > buffers[buffer]) {
            let message = format!("{bytes} bytes from byte {offset} on are past the end of it");
            return Err(packed.fault_at("buffer", message));
        }
        let mode = match packed.text("mode")?.ok_or_else(|| packed.absent("mode"))? {
            "ATTRIBUTES" => Mode::Attributes,
            "TRIANGLES" => Mode::Triangles,
            "INDICES" => Mode::Indices,
            other => return Err(packed.fault_at("mode", format!("{other:?} is no mode"))),
        };
        let filter = packed.text("filter")?.unwrap_or("NONE");
        let is_color = is_khr && filter == "COLOR";
        let filter = Filter::parse(if is_color { "NONE" } else { filter })
            .map_err(|_| packed.fault_at("filter", format!("{filter:?} is no filter")))?;
        let (count, size) = (packed.required_whole("count")?, packed.required_whole("byteStride")?);
        if count.checked_mul(size) != Some(length) || stride.is_some_and(|stride| stride != size) {
            let message = format!("{count} elements of {size} bytes are not what the view holds");
            return Err(packed.fault_at("count", message));
        }
        if length > bytes.saturating_mul(MOST_EXPANSION) {
            let message = format!("{length} bytes cannot come out of {bytes}");
            return Err(packed.fault_at("byteLength", message));
        }
        if is_color && (mode != Mode::Attributes || ![4, 8].contains(&size)) {
            return Err(packed.fault_at("filter", "colours are attributes of 4 or 8 bytes"));
        }
        let attributes = (is_khr && mode == Mode::Attributes).then_some(Attributes {
            count: count as usize,
            size: size as usize,
            filter: (!is_color).then_some(filter),
        });
        let layout = BufferView::new(mode, filter, count as usize, size as usize);
        let layout =
            layout.map_err(|error| packed.fault(format!("cannot be unpacked: {error}")))?;
        Ok(Some(Self { buffer, offset, length: bytes, unpacked: length, layout, attributes }))
    }

    /// The view's bytes.
    ///
    /// # Errors
    /// What is wrong with the packed ones, or that memory is short.
    pub fn unpack(&self, packed: &[u8]) -> Result<Vec<u8>, String> {
        memory::claim(self.unpacked).map_err(|error| format!("unpacked it {error}"))?;
        let unpacked = match self.attributes {
            Some(attributes) => attributes.decode(packed),
            None => self.layout.decode(packed, &mut Workspace::default()),
        };
        unpacked.map_err(|error| format!("cannot be unpacked: {error}"))
    }
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn packed(text: &str, length: u64) -> Result<Option<Packed>, String> {
        let text = format!("{{\"extensions\": {{\"EXT_meshopt_compression\": {{{text}}}}}}}");
        let value = json::parse(text.as_bytes()).expect("valid JSON");
        let view = Object::new(&value, "/bufferViews/0".to_owned()).expect("an object");
        Packed::read(&view, &[64], length, None).map_err(|fault| fault.message)
    }

    #[test]
    fn a_triangle_is_unpacked() {
        // Triangles, version 1: a code that says "three new vertices", no data, and the codes'
        // table.
        let table: [u8; 16] =
            [0, 0x76, 0x87, 0x56, 0x67, 0x78, 0xa9, 0x86, 0x65, 0x89, 0x68, 0x98, 1, 0x69, 0, 0];
        let bytes: Vec<u8> = [0xe1, 0xf0].into_iter().chain(table).collect();
        let view =
            r#""buffer": 0, "byteLength": 18, "byteStride": 2, "count": 3, "mode": "TRIANGLES""#;
        let view = packed(view, 6).expect("valid").expect("packed");
        assert_eq!(view.unpack(&bytes), Ok(vec![0, 0, 1, 0, 2, 0]));
        for length in 0..bytes.len() {
            assert!(view.unpack(&bytes[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let ok =
            r#""buffer": 0, "byteLength": 18, "byteStride": 2, "count": 3, "mode": "TRIANGLES""#;
        assert!(packed(ok, 6).is_ok());
        for (from, to) in [
            ("\"buffer\": 0", "\"buffer\": 1"),
            ("18", "65"),
            ("TRIANGLES", "STRIPS"),
            ("\"count\": 3", "\"count\": 18446744073709551615"),
            ("\"byteStride\": 2", "\"byteStride\": 3"),
            ("\"count\": 3", "\"count\": 3, \"filter\": \"OCTAHEDRAL\""),
            ("\"count\": 3", "\"count\": 3, \"filter\": \"X\""),
        ] {
            assert!(packed(&ok.replace(from, to), 6).is_err(), "{to}");
        }
    }
}
