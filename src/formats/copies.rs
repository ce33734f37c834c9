//! Files that tell where copies of something stand: points of a PLY file, or rows of an array.

use std::path::{Path, PathBuf};

use glam::{DAffine3, DMat4, DVec3};

use super::npy::Table;
use super::ply::Points;
use super::{LoadError, read_file};

/// Where copies stand, in the bytes of a file; they are read one by one.
///
/// - `.ply`: the vertices, see [`Points`].
/// - `.npy`: an array of shape (N, 3) of positions; or of shape (N, 12), (N, 3, 4), (N, 16) or
///   (N, 4, 4) of matrices, row by row as NumPy has them, the translation in the last column.
#[derive(Debug)]
pub struct CopiesFile {
    path: PathBuf,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Points(Points),
    Rows(Table),
}

impl CopiesFile {
    /// Reads a file.
    ///
    /// # Errors
    /// What is wrong with it as a whole.
    pub fn read(path: &Path) -> Result<Self, LoadError> {
        let bytes = read_file(path)?;
        let kind = if super::ply::is_ply(&bytes) {
            Kind::Points(Points::read(path, bytes)?)
        } else if Table::is_table(&bytes) {
            let table =
                Table::read(bytes).map_err(|message| LoadError::invalid(path, "", message))?;
            Kind::Rows(check_shape(path, table)?)
        } else {
            let message = "is neither PLY nor .npy, which tell where copies stand";
            return Err(LoadError::invalid(path, "", message));
        };
        Ok(Self { path: path.to_owned(), kind })
    }

    /// How many there are, or how many more than there are the file claims that it could hold.
    pub fn most(&self) -> u64 {
        match &self.kind {
            Kind::Points(points) => points.most(),
            Kind::Rows(table) => table.rows(),
        }
    }

    /// Gives each copy's place, in the order of the file, to `place`.
    ///
    /// # Errors
    /// A place that is none, or what `place` complains of: with the file, and the vertex or row.
    pub fn each(
        &self,
        place: &mut dyn FnMut(&DAffine3) -> Result<(), String>,
    ) -> Result<(), LoadError> {
        match &self.kind {
            Kind::Points(points) => points.each(&self.path, place),
            Kind::Rows(table) => (0..table.rows()).try_for_each(|row| {
                let placed = stands(table, row).and_then(|stands| place(&stands));
                placed.map_err(|message| {
                    LoadError::invalid(&self.path, format!("row {row}"), message)
                })
            }),
        }
    }
}

/// Refuses arrays that are neither positions nor matrices.
fn check_shape(path: &Path, table: Table) -> Result<Table, LoadError> {
    if matches!(table.shape()[1..], [3 | 12 | 16] | [3 | 4, 4]) {
        return Ok(table);
    }
    let sizes: Vec<String> = table.shape().iter().map(u64::to_string).collect();
    let message = format!(
        "has shape ({}); copies are (N, 3), (N, 12), (N, 16), (N, 3, 4) or (N, 4, 4)",
        sizes.join(", ")
    );
    Err(LoadError::invalid(path, "", message))
}

/// What a row of an array says.
fn stands(table: &Table, row: u64) -> Result<DAffine3, String> {
    let mut numbers = [0.0; 16];
    let columns = table.columns();
    table.row(row, &mut numbers[..columns]);
    if !numbers.iter().all(|number| number.is_finite()) {
        return Err("a number is not finite".to_owned());
    }
    if columns == 3 {
        return Ok(DAffine3::from_translation(DVec3::from_slice(&numbers[..3])));
    }
    if columns == 12 {
        numbers[15] = 1.0;
    }
    if numbers[12..] != [0.0, 0.0, 0.0, 1.0] {
        let message = "the last row of a matrix must be 0 0 0 1: its translation is in the last \
                       column";
        return Err(message.to_owned());
    }
    Ok(DAffine3::from_mat4(DMat4::from_cols_array(&numbers).transpose()))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// The places of copies in a file, or what is wrong with it, without the folder's name.
    fn read(name: &str, bytes: &[u8]) -> Result<Vec<DAffine3>, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(name);
        fs::write(&path, bytes).expect("written");
        let mut all = Vec::new();
        let each = |file: CopiesFile| {
            file.each(&mut |stands| {
                all.push(*stands);
                Ok(())
            })
        };
        let read = CopiesFile::read(&path).and_then(each);
        let clean = |error: LoadError| {
            error.to_string().replace(&format!("{}/", folder.path().display()), "")
        };
        read.map(|()| all).map_err(clean)
    }

    fn npy(descr: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
        let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
        let length = (text.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes(), numbers].concat()
    }

    fn doubles(numbers: &[f64]) -> Vec<u8> {
        numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    #[test]
    fn arrays_hold_positions_or_matrices_by_rows() {
        let at = |x, y, z| DAffine3::from_translation(DVec3::new(x, y, z));
        let two = doubles(&[1.0, 2.0, 3.0, 4e6, 5.0, 6.0]);
        let read_two = read("a.npy", &npy("<f8", "(2, 3)", &two));
        assert_eq!(read_two, Ok(vec![at(1.0, 2.0, 3.0), at(4e6, 5.0, 6.0)]));
        let floats: Vec<u8> = [7.0_f32, 8.0, 9.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(read("a.npy", &npy("<f4", "(1, 3)", &floats)), Ok(vec![at(7.0, 8.0, 9.0)]));
        // A quarter turn about Z, and a shift.
        let rows = [0.0, -1.0, 0.0, 5.0, 1.0, 0.0, 0.0, 6.0, 0.0, 0.0, 1.0, 7.0];
        let whole = [&rows[..], &[0.0, 0.0, 0.0, 1.0]].concat();
        for (shape, numbers) in [
            ("(1, 12)", &rows[..]),
            ("(1, 3, 4)", &rows),
            ("(1, 16)", &whole),
            ("(1, 4, 4)", &whole),
        ] {
            let stands = read("a.npy", &npy("<f8", shape, &doubles(numbers))).expect(shape)[0];
            assert_eq!(stands.transform_point3(DVec3::X), DVec3::new(5.0, 7.0, 7.0), "{shape}");
        }
    }

    #[test]
    fn what_is_wrong_with_an_array_names_the_row() {
        let three = |last| npy("<f8", "(2, 3)", &doubles(&[0.0, 0.0, 0.0, 0.0, 0.0, last]));
        let error = |bytes: &[u8]| read("a.npy", bytes).expect_err("it is broken");
        assert_eq!(error(&three(f64::NAN)), "a.npy: row 1: a number is not finite");
        let shape = npy("<f8", "(1, 5)", &doubles(&[0.0; 5]));
        assert!(error(&shape).starts_with("a.npy: has shape (1, 5); copies are (N, 3)"));
        let matrix = npy("<f8", "(1, 16)", &doubles(&[1.0; 16]));
        assert!(error(&matrix).starts_with("a.npy: row 0: the last row of a matrix must be"));
        let huge = npy("<f8", "(4611686018427387904, 3)", &[]);
        assert!(error(&huge).contains("its header promises"), "{}", error(&huge));
        assert!(error(b"x y z").starts_with("a.npy: is neither PLY nor .npy"));
        assert!(error(&npy("<i8", "(1, 3)", &[0; 24])).contains("int64"));
    }

    #[test]
    fn points_stand_turned_and_scaled() {
        let header = "ply\nformat ascii 1.0\nelement vertex 2\n";
        let properties = |names: &str| {
            names.split(' ').fold(String::new(), |all, name| all + "property float " + name + "\n")
        };
        let file = |names: &str, rows: &str| {
            let text = format!("{header}{}end_header\n{rows}", properties(names));
            read("a.ply", text.as_bytes())
        };
        let turned = file("x y z scale nx ny nz", "1 2 3 2 1 0 0\n0 0 0 1 0 -4 0\n").expect("good");
        let up = |stands: &DAffine3| stands.transform_point3(DVec3::Y);
        assert!(up(&turned[0]).distance(DVec3::new(3.0, 2.0, 3.0)) < 1e-12);
        assert!(up(&turned[1]).distance(DVec3::NEG_Y) < 1e-12);
        let quarter = "0 0 0.5 0.5";
        let rows = format!("0 0 0 1 2 3 {quarter}\n0 0 0 1 1 1 {quarter}\n");
        let turned = file("x y z scale_x scale_y scale_z qx qy qz qw", &rows).expect("good");
        assert!(up(&turned[0]).distance(DVec3::new(-2.0, 0.0, 0.0)) < 1e-12);
        for (names, rows, message) in [
            ("x y", "0 0\n0 0\n", "a.ply: has no vertices with x, y and z"),
            ("x y z nx", "0 0 0 1\n0 0 0 1\n", "a.ply: its vertices have some of nx, ny, nz"),
            ("x y z nx ny nz", "0 0 0 1 1 1\n0 0 0 0 0 0\n", "a.ply:12: vertex 1: its normal"),
            ("x y z qx qy qz qw", "0 0 0 0 0 0 0\n", "a.ply:12: vertex 0: its rotation"),
            ("x y z", "0 0 0\n", "a.ply:9: vertex 1: the file ends"),
            ("x y z", "0 0 0\n0 inf 0\n", "a.ply:9: vertex 1: a number is not finite"),
        ] {
            let error = file(names, rows).expect_err(names);
            assert!(error.starts_with(message), "{error}");
        }
    }
}
