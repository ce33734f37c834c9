//! Tests of reading numbers out of buffers.

use super::super::accessor::Sparse;
use super::*;

fn storage(bytes: &[u8], stride: Option<u64>, accessor: Accessor) -> Storage<'_> {
    let view = |offset, length, stride| View { buffer: 0, offset, length, stride, packed: None };
    let all = bytes.len() as u64;
    // View 0 is everything, view 1 the last six bytes.
    let views = vec![view(0, all, stride), view(all - 6, 6, None)];
    Storage::new(vec![Some(Cow::Borrowed(bytes))], views, vec![accessor])
}

fn plain(component: Component, shape: Shape, count: u64) -> Accessor {
    Accessor {
        place: "/accessors/0".to_owned(),
        base: Some((0, 0)),
        component,
        shape,
        normalized: false,
        count,
        stride: shape_size(component, shape),
        sparse: None,
        part: None,
    }
}

fn shape_size(component: Component, shape: Shape) -> u64 {
    match shape {
        Shape::Vector(n) => n * component.size(),
        _ => component.size(),
    }
}

#[test]
fn normalised_integers_reach_both_ends() {
    let bytes = [0x80, 0x81, 0x7f, 0x00, 0, 0];
    let mut accessor = plain(Component::I8, Shape::Vector(2), 2);
    accessor.normalized = true;
    let read = storage(&bytes, None, accessor).vectors::<2>(0).expect("reads");
    assert_eq!(read, [[-1.0, -1.0], [1.0, 0.0]]);
}

#[test]
fn strides_skip_what_lies_between() {
    let bytes = [1, 2, 99, 99, 3, 4, 99, 99, 5, 6];
    let mut accessor = plain(Component::U8, Shape::Vector(2), 3);
    accessor.stride = 4;
    let read = storage(&bytes, Some(4), accessor).vectors::<2>(0).expect("reads");
    assert_eq!(read, [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]);
}

#[test]
fn sparse_values_replace_zeros() {
    // Indices 1 and 3, then their values 7 and 9, as u8; two bytes are left over.
    let bytes = [1, 3, 7, 9, 0, 0];
    let mut accessor = plain(Component::U8, Shape::Scalar, 4);
    accessor.base = None;
    accessor.sparse = Some(Sparse { count: 2, indices: (1, 0, Component::U8), values: (1, 2) });
    let read = storage(&bytes, None, accessor.clone()).vectors::<1>(0).expect("reads");
    assert_eq!(read, [[0.0], [7.0], [0.0], [9.0]]);

    accessor.count = 3;
    let fault = storage(&bytes, None, accessor).vectors::<1>(0).expect_err("3 of 3");
    assert_eq!(fault.place, "/accessors/0/sparse/indices");
}

/// Normalised, with something between the elements: values that replace others have nothing there.
#[test]
fn sparse_values_replace_those_of_a_stride() {
    // Two signed bytes of four are an element; then index 2 and its value.
    let bytes = [127, 0, 9, 9, 0, 127, 9, 9, 0x81, 127, 9, 9, 2, 0, 127, 0x81, 0, 0];
    let mut accessor = plain(Component::I8, Shape::Vector(2), 3);
    (accessor.stride, accessor.normalized) = (4, true);
    accessor.sparse = Some(Sparse { count: 1, indices: (1, 0, Component::U16), values: (1, 2) });
    let storage = storage(&bytes, Some(4), accessor);
    let expected = [[1.0, 0.0], [0.0, 1.0], [1.0, -1.0]];
    assert_eq!(storage.vectors::<2>(0).expect("reads"), expected);
    let rows = storage.rows::<2>(0).expect("reads");
    assert_eq!((0..3).map(|row| rows.get(row)).collect::<Vec<_>>(), expected);
}

/// At an odd place, as no validator lets pass, and with something between them.
#[test]
fn matrices_are_read_wherever_they_lie() {
    let numbers: Vec<f32> = (0..32).map(|i| i as f32).collect();
    let bytes = |matrix: &[f32]| matrix.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let all = [vec![7], bytes(&numbers[..16]), vec![9; 8], bytes(&numbers[16..]), vec![5; 6]];
    let mut accessor = plain(Component::F32, Shape::Matrix(4), 2);
    (accessor.base, accessor.stride) = (Some((0, 1)), 72);
    let all = all.concat();
    let read = storage(&all, Some(72), accessor).matrices(0).expect("reads");
    assert_eq!(read.as_flattened(), numbers);
}

#[test]
fn a_small_file_cannot_ask_for_gigabytes() {
    let mut accessor = plain(Component::F32, Shape::Vector(3), u64::MAX);
    accessor.base = None;
    assert!(storage(&[0; 6], None, accessor.clone()).vectors::<3>(0).is_err());
    accessor.count = MAX_ZEROS + 1;
    assert!(storage(&[0; 6], None, accessor).vectors::<3>(0).is_err());
}

#[test]
fn indices_are_unsigned() {
    let bytes = [1, 0, 2, 0, 0, 0];
    let accessor = plain(Component::U16, Shape::Scalar, 3);
    assert_eq!(storage(&bytes, None, accessor).indices(0), Ok(vec![1, 2, 0]));
    let accessor = plain(Component::I16, Shape::Scalar, 3);
    assert!(storage(&bytes, None, accessor).indices(0).is_err());
}
