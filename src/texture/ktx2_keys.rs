//! Keys and values of a KTX 2.0 file (KTX File Format 2.0, 3.11 and 5) that tell how its texels are
//! to be seen.

/// The most bytes of a value that a note quotes.
const QUOTED: usize = 16;

/// What they ask for that is not honoured: texels that do not begin at the upper left, channels in
/// another order. A glTF file may have neither (KHR_texture_basisu). Each key is there once; of
/// others of its name nothing is said.
pub fn notes(mut data: &[u8]) -> Vec<String> {
    let (mut notes, mut known) = (Vec::new(), Vec::new());
    while !data.is_empty() {
        let Some((key, value, rest)) = entry(data) else {
            notes.push("has keys and values that are cut: the last are not read".to_owned());
            break;
        };
        data = rest;
        let text = value.split(|&byte| byte == 0).next().unwrap_or_default();
        let (usual, meaning) = match key {
            b"KTXorientation" => (&b"rd"[..], "texels begin at the upper left"),
            b"KTXswizzle" => (&b"rgba"[..], "channels keep their order"),
            _ => continue,
        };
        if text != usual && !known.contains(&key) {
            known.push(key);
            let key = String::from_utf8_lossy(key);
            let text = String::from_utf8_lossy(&text[..text.len().min(QUOTED)]);
            notes.push(format!("its {key} {text:?} is not honoured: {meaning}"));
        }
    }
    notes
}

/// The first key, its value, and what follows.
fn entry(data: &[u8]) -> Option<(&[u8], &[u8], &[u8])> {
    let (length, rest) = data.split_first_chunk()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let pair = rest.get(..length)?;
    let end = pair.iter().position(|&byte| byte == 0)?;
    // Each begins at a multiple of four; the last may end before one.
    let next = length.checked_next_multiple_of(4)?.min(rest.len());
    Some((&pair[..end], &pair[end + 1..], &rest[next..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(pairs: &[(&str, &str)]) -> Vec<u8> {
        let mut data = Vec::new();
        for (key, value) in pairs {
            let pair = format!("{key}\0{value}\0");
            data.extend((pair.len() as u32).to_le_bytes());
            data.extend(pair.as_bytes());
            data.resize(data.len().next_multiple_of(4), 0);
        }
        data
    }

    #[test]
    fn what_is_not_honoured_is_said() {
        let usual = [("KTXorientation", "rd"), ("KTXswizzle", "rgba"), ("KTXwriter", "a 1")];
        assert!(notes(&pairs(&usual)).is_empty() && notes(&[]).is_empty());
        let odd = [("KTXorientation", "ru"), ("KTXwriter", "a"), ("KTXswizzle", "rrr1")];
        let said = [
            "its KTXorientation \"ru\" is not honoured: texels begin at the upper left",
            "its KTXswizzle \"rrr1\" is not honoured: channels keep their order",
        ];
        assert_eq!(notes(&pairs(&odd)), said);
        let long = "x".repeat(1000);
        assert!(notes(&pairs(&[("KTXswizzle", &long)]))[0].len() < 100);
    }

    #[test]
    fn whatever_is_there_is_read_to_its_end() {
        let whole = pairs(&[("KTXwriter", "a"), ("KTXorientation", "rd")]);
        for end in 0..whole.len() {
            assert!(notes(&whole[..end]).len() <= 1, "{end}");
        }
        for length in [0_u32, 1, 1 << 31, u32::MAX] {
            let mut data = whole.clone();
            data[..4].copy_from_slice(&length.to_le_bytes());
            assert_eq!(notes(&data).len(), 1, "{length}");
        }
    }
}
