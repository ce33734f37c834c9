//! Bytes packed by Zstandard (RFC 8878), unpacked to a length that is known.

use std::io::Read;

use ruzstd::decoding::StreamingDecoder;

use crate::files::guard;

/// The window that a frame may always ask for, bytes: what the RFC advises (3.1.1.1.2).
const WINDOW: u64 = 8 << 20;

/// Unpacks exactly `length` bytes, for which the caller has claimed memory.
///
/// # Errors
/// What is wrong, also if other than `length` bytes come out.
pub fn unpack(packed: &[u8], length: u64) -> Result<Vec<u8>, String> {
    let unpacked = guard::run("its Zstandard data cannot be unpacked", || {
        let decoder = StreamingDecoder::new_with_max_window_size(packed, WINDOW.max(length));
        let decoder = decoder.map_err(|error| error.to_string())?;
        let mut unpacked = Vec::new();
        // One more would show.
        let read = decoder.take(length + 1).read_to_end(&mut unpacked);
        read.map_err(|error| error.to_string())?;
        Ok::<_, String>(unpacked)
    })?;
    let unpacked =
        unpacked.map_err(|error| format!("its Zstandard data cannot be unpacked: {error}"))?;
    if unpacked.len() as u64 != length {
        return Err(format!("its Zstandard data do not hold {length} bytes"));
    }
    Ok(unpacked)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame of one block as it is: magic, one segment of a byte's length, the block's header.
    fn stored(bytes: &[u8]) -> Vec<u8> {
        let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0x20, bytes.len() as u8];
        frame.extend(&((bytes.len() as u32) << 3 | 1).to_le_bytes()[..3]);
        frame.extend(bytes);
        frame
    }

    #[test]
    fn exactly_so_many_bytes_come_out() {
        let packed = stored(b"dapple");
        assert_eq!(unpack(&packed, 6), Ok(b"dapple".to_vec()));
        for length in [0, 5, 7] {
            assert!(unpack(&packed, length).is_err(), "{length}");
        }
        for end in 0..packed.len() {
            assert!(unpack(&packed[..end], 6).is_err(), "cut at {end}");
        }
    }

    /// One block that repeats a byte 2^20 times, in four bytes.
    #[test]
    fn a_bomb_ends_where_the_caller_says() {
        let mut bomb = vec![0x28, 0xb5, 0x2f, 0xfd, 0x00, 0x58];
        for last in [0, 0, 0, 1] {
            bomb.extend(&((128_u32 << 10) << 3 | 2 | last).to_le_bytes()[..3]);
            bomb.push(7);
        }
        assert_eq!(unpack(&bomb, 512 << 10).map(|bytes| bytes.len()), Ok(512 << 10));
        assert!(unpack(&bomb, 1000).is_err());
        // A window of gigabytes.
        bomb[5] = 0xf8;
        assert!(unpack(&bomb, 512 << 10).is_err());
    }
}
