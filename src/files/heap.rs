//! The C library's heap: large pieces go back to the system as soon as they are free.
//!
//! The unsafe code of it. By itself glibc learns from the first large piece that is freed that the
//! next ones, up to 32 MB, are better kept. What a build frees then stays with the process while
//! what it makes is written: a hall of 4.3 million placed triangles took 202 MB so, and takes 159.
#![allow(unsafe_code)]

/// A piece of so many bytes is mapped by itself: the value that glibc begins with.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGE: i32 = 128 << 10;

/// Has large pieces given back as soon as they are free; nothing where the C library is not glibc.
pub fn give_back_large_pieces() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: sets a number of the allocator, under its own lock. It takes no pointer, and a value
    // that it does not like changes nothing.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
    }
}
