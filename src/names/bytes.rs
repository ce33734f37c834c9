//! Sizes as users write them.

/// Bytes of a size such as `512MiB`, `2G` or `1000000`: `KiB`, `MiB`, `GiB`, `TiB` and `K`, `M`,
/// `G`, `T` count in 1024s, `kB`, `MB`, `GB`, `TB` in 1000s.
pub fn parse_bytes(text: &str) -> Option<u64> {
    const UNITS: [(&str, u64); 13] = [
        ("KiB", 1 << 10),
        ("MiB", 1 << 20),
        ("GiB", 1 << 30),
        ("TiB", 1 << 40),
        ("kB", 1000),
        ("MB", 1_000_000),
        ("GB", 1_000_000_000),
        ("TB", 1_000_000_000_000),
        ("K", 1 << 10),
        ("M", 1 << 20),
        ("G", 1 << 30),
        ("T", 1 << 40),
        ("B", 1),
    ];
    let (digits, unit) = UNITS
        .iter()
        .find_map(|&(suffix, unit)| text.strip_suffix(suffix).map(|digits| (digits, unit)))
        .unwrap_or((text, 1));
    digits.trim().parse::<u64>().ok()?.checked_mul(unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_understood() {
        for (text, bytes) in [
            ("512MiB", 512 << 20),
            ("2G", 2 << 30),
            ("2 GiB", 2 << 30),
            ("3kB", 3000),
            ("17", 17),
            ("17B", 17),
            ("1TB", 1_000_000_000_000),
        ] {
            assert_eq!(parse_bytes(text), Some(bytes), "{text}");
        }
        for wrong in ["", "MiB", "-1", "1.5G", "2g", "18446744073709551615K", "1 000"] {
            assert_eq!(parse_bytes(wrong), None, "{wrong}");
        }
    }
}
