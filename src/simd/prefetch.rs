//! Asking for memory before it is needed.
//!
//! The only unsafe code of rendering. With sixteen rays in flight it makes the walk of the wide
//! hierarchies faster by 10 % where the tree fits the second-level cache (70 thousand triangles)
//! and 1.9 to 2.3 times as fast where it does not (870 thousand); `kd-prefetch`, over the plain
//! stack, 2.1 times there.

/// Starts to fetch `bytes` bytes of a slice's memory, from place `at` on; never changes a result.
/// What lies beyond its end is asked for in vain.
#[inline(always)]
pub fn prefetch<T>(slice: &[T], at: usize, bytes: usize) {
    prefetch_lines(slice.as_ptr().wrapping_add(at).cast(), bytes);
}

/// Asks for the cache lines from an address on.
#[inline(always)]
#[allow(unsafe_code)]
fn prefetch_lines(start: *const i8, bytes: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        for line in 0..bytes.div_ceil(64) {
            // SAFETY: a prefetch reads nothing that the program can see and does not fault,
            // whatever the address.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line * 64)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (start, bytes);
}
