//! Paths in OBJ and MTL files, kept within the folder of the scene.

use std::path::{Component, Path, PathBuf};

/// The path of a file that the scene refers to, by either kind of slash, or none if it would leave
/// the scene's folder.
pub(super) fn confine(folder: &Path, name: &str) -> Option<PathBuf> {
    let name = name.replace('\\', "/");
    // On Unix `C:` would be a folder like any other.
    if name.is_empty() || name.as_bytes().get(1) == Some(&b':') {
        return None;
    }
    let mut inside = PathBuf::new();
    for component in Path::new(&name).components() {
        match component {
            Component::Normal(part) => inside.push(part),
            Component::CurDir => {}
            Component::ParentDir if inside.pop() => {}
            _ => return None,
        }
    }
    Some(folder.join(inside))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_stay_in_the_folder() {
        let folder = Path::new("scenes");
        let inside = |name| confine(folder, name);
        assert_eq!(inside(".\\maps\\a b.png"), Some("scenes/maps/a b.png".into()));
        assert_eq!(inside("maps/../a.png"), Some("scenes/a.png".into()));
        for outside in ["../a.png", "maps/../../a.png", "/etc/passwd", "C:\\a.png", "\\\\host\\a"] {
            assert_eq!(inside(outside), None, "{outside}");
        }
    }
}
