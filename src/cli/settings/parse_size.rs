//! Values of settings that are sizes.

/// Units by their names, in bytes.
const UNITS: [(&str, u64); 13] = [
    ("", 1),
    ("b", 1),
    ("k", 1 << 10),
    ("kb", 1_000),
    ("kib", 1 << 10),
    ("m", 1 << 20),
    ("mb", 1_000_000),
    ("mib", 1 << 20),
    ("g", 1 << 30),
    ("gb", 1_000_000_000),
    ("gib", 1 << 30),
    ("tb", 1_000_000_000_000),
    ("tib", 1 << 40),
];

/// A number of bytes with its unit, as in `512MiB`, `2GB` or `1.5g`; `K`, `M` and `G` alone are
/// powers of 1024, as for other programs.
pub fn size(text: &str) -> Result<u64, String> {
    let form = || format!("`{text}` is no size: expected one as in 512MiB, 2GB or 2G");
    let end = text.find(|c: char| c != '.' && !c.is_ascii_digit()).unwrap_or(text.len());
    let (number, unit) = (&text[..end], text[end..].trim().to_ascii_lowercase());
    let unit = UNITS.iter().find(|(name, _)| *name == unit).ok_or_else(form)?.1;
    // Whole numbers are exact, however large.
    let bytes = if let Ok(whole) = number.parse::<u64>() {
        whole.checked_mul(unit)
    } else {
        let bytes = number.parse::<f64>().map_err(|_| form())? * unit as f64;
        (bytes < u64::MAX as f64).then_some(bytes as u64)
    };
    bytes.filter(|&bytes| bytes > 0).ok_or_else(form)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        for (text, bytes) in [
            ("512MiB", 512 << 20),
            ("2GB", 2_000_000_000),
            ("2g", 2 << 30),
            ("1.5 kB", 1500),
            ("0.5K", 512),
            ("17", 17),
            ("9007199254740993", 9_007_199_254_740_993),
        ] {
            assert_eq!(size(text), Ok(bytes), "{text}");
        }
        for wrong in ["", "0", "MB", "-1G", "2 apples", "1e3", "1..5G", "99999999TB", "0.1"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
