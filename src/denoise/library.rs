//! The functions of Open Image Denoise's C library, found by name: the unsafe code of denoising.
//!
//! Types and names are those of `oidn.h` of version 2, which keeps them in all its releases.

#![allow(unsafe_code)]

use std::ffi::{CStr, c_char, c_int, c_void};
use std::path::Path;
use std::ptr::null_mut;

use libloading::Library;

/// `OIDN_DEVICE_TYPE_CPU`.
const CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;
/// `OIDN_ERROR_NONE`.
const NO_ERROR: c_int = 0;

/// A device, a filter.
type Handle = *mut c_void;

/// The functions that are used.
struct Functions {
    new_device: unsafe extern "C" fn(c_int) -> Handle,
    release_device: unsafe extern "C" fn(Handle),
    commit_device: unsafe extern "C" fn(Handle),
    set_device_bool: unsafe extern "C" fn(Handle, *const c_char, bool),
    set_device_int: unsafe extern "C" fn(Handle, *const c_char, c_int),
    device_int: unsafe extern "C" fn(Handle, *const c_char) -> c_int,
    device_error: unsafe extern "C" fn(Handle, *mut *const c_char) -> c_int,
    new_filter: unsafe extern "C" fn(Handle, *const c_char) -> Handle,
    release_filter: unsafe extern "C" fn(Handle),
    set_filter_bool: unsafe extern "C" fn(Handle, *const c_char, bool),
    set_image: SetImage,
    commit_filter: unsafe extern "C" fn(Handle),
    execute_filter: unsafe extern "C" fn(Handle),
}

/// `oidnSetSharedFilterImage`: filter, name, pixels, format, width, height, and where pixels lie:
/// offset, bytes from one to the next, bytes from a row to the next; zero: close together.
type SetImage = unsafe extern "C" fn(
    Handle,
    *const c_char,
    *mut c_void,
    c_int,
    usize,
    usize,
    usize,
    usize,
    usize,
);

impl Functions {
    /// Opens a library, which then stays in the process: it has threads of its own.
    ///
    /// # Errors
    /// What the loader says.
    fn open(path: &Path) -> Result<Self, libloading::Error> {
        // SAFETY: whoever names the library, or has installed it, trusts what it does when it is
        // opened.
        let library = unsafe { Library::new(path) }?;
        let library: &'static Library = Box::leak(Box::new(library));
        // SAFETY: the types are those of the functions of these names in `oidn.h`, and the library
        // is never closed.
        unsafe {
            Ok(Self {
                new_device: *library.get(b"oidnNewDevice\0")?,
                release_device: *library.get(b"oidnReleaseDevice\0")?,
                commit_device: *library.get(b"oidnCommitDevice\0")?,
                set_device_bool: *library.get(b"oidnSetDeviceBool\0")?,
                set_device_int: *library.get(b"oidnSetDeviceInt\0")?,
                device_int: *library.get(b"oidnGetDeviceInt\0")?,
                device_error: *library.get(b"oidnGetDeviceError\0")?,
                new_filter: *library.get(b"oidnNewFilter\0")?,
                release_filter: *library.get(b"oidnReleaseFilter\0")?,
                set_filter_bool: *library.get(b"oidnSetFilterBool\0")?,
                set_image: *library.get(b"oidnSetSharedFilterImage\0")?,
                commit_filter: *library.get(b"oidnCommitFilter\0")?,
                execute_filter: *library.get(b"oidnExecuteFilter\0")?,
            })
        }
    }

    /// The first error since it was last asked for, of a device or, with null, of making one.
    fn take_error(&self, device: Handle) -> Result<(), String> {
        let mut message = std::ptr::null();
        // SAFETY: the device is live or null, and the message has a place.
        let code = unsafe { (self.device_error)(device, &raw mut message) };
        if code == NO_ERROR {
            return Ok(());
        }
        if message.is_null() {
            return Err(format!("error {code}"));
        }
        // SAFETY: the library's messages end with a zero, and live until the next call.
        let message = unsafe { CStr::from_ptr(message) };
        Err(message.to_string_lossy().into_owned())
    }
}

/// The processor as a device of the library.
pub(super) struct Device {
    functions: Functions,
    handle: Handle,
}

impl Device {
    /// Opens a library, and in it the processor with so many threads; 0: as many as it likes.
    ///
    /// # Errors
    /// What the loader or the library says, or that it is of another version.
    pub fn open(path: &Path, threads: usize) -> Result<Self, String> {
        let functions = Functions::open(path).map_err(|error| error.to_string())?;
        // SAFETY: the function has no preconditions.
        let handle = unsafe { (functions.new_device)(CPU) };
        if handle.is_null() {
            functions.take_error(null_mut())?;
            return Err("has no device for this processor".to_owned());
        }
        let device = Self { functions, handle };
        let [major, minor, patch] = device.version();
        if major != 2 {
            return Err(format!("is version {major}.{minor}.{patch}, version 2 is needed"));
        }
        // SAFETY: the device is live, the names are its parameters', of these types. Threads are
        // not tied to cores, which other processes may be using.
        unsafe {
            (device.functions.set_device_bool)(handle, c"setAffinity".as_ptr(), false);
            if threads > 0 {
                let threads = c_int::try_from(threads).unwrap_or(c_int::MAX);
                (device.functions.set_device_int)(handle, c"numThreads".as_ptr(), threads);
            }
            (device.functions.commit_device)(handle);
        }
        device.take_error()?;
        Ok(device)
    }

    /// Major, minor and patch version of the library.
    pub fn version(&self) -> [c_int; 3] {
        // SAFETY: the device is live, the names are its parameters'.
        [c"versionMajor", c"versionMinor", c"versionPatch"]
            .map(|name| unsafe { (self.functions.device_int)(self.handle, name.as_ptr()) })
    }

    /// Filters images of `size` (width, height), which are given by the filter's names for them,
    /// into `output`, with the filter's switches `flags` on.
    ///
    /// # Errors
    /// What the library says.
    ///
    /// # Panics
    /// If an image, or the output, is not of that size.
    pub fn filter(
        &self,
        size: (usize, usize),
        images: &[(&'static CStr, &[[f32; 3]])],
        flags: &[&'static CStr],
        output: &mut [[f32; 3]],
    ) -> Result<(), String> {
        let functions = &self.functions;
        // SAFETY: the device is live; `RT` is the filter for ray-traced images.
        let handle = unsafe { (functions.new_filter)(self.handle, c"RT".as_ptr()) };
        if handle.is_null() {
            self.take_error()?;
            return Err("it has no filter for ray-traced images".to_owned());
        }
        let filter = Filter { functions, handle };
        for (name, pixels) in images {
            // The library does not write to what it filters.
            filter.set_image(name, pixels.as_ptr().cast_mut().cast(), pixels.len(), size);
        }
        filter.set_image(c"output", output.as_mut_ptr().cast(), output.len(), size);
        // SAFETY: the filter is live, and so are all images until it has been released.
        unsafe {
            for flag in flags {
                (functions.set_filter_bool)(handle, flag.as_ptr(), true);
            }
            (functions.commit_filter)(handle);
            (functions.execute_filter)(handle);
        }
        self.take_error()
    }

    fn take_error(&self) -> Result<(), String> {
        self.functions.take_error(self.handle)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the device is live, and nobody uses it from now on.
        unsafe { (self.functions.release_device)(self.handle) };
    }
}

/// A filter of a device.
struct Filter<'a> {
    functions: &'a Functions,
    handle: Handle,
}

impl Filter<'_> {
    /// Hands it an image of so many pixels, which it does not copy.
    fn set_image(
        &self,
        name: &CStr,
        pixels: *mut c_void,
        count: usize,
        (width, height): (usize, usize),
    ) {
        assert_eq!(count, width * height, "the image has the size that is told");
        // SAFETY: the filter is live, and there are that many pixels of three floats.
        unsafe {
            let (filter, name) = (self.handle, name.as_ptr());
            (self.functions.set_image)(filter, name, pixels, FLOAT3, width, height, 0, 0, 0);
        }
    }
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: the filter is live, and nobody uses it from now on.
        unsafe { (self.functions.release_filter)(self.handle) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_library_is_an_error() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.so");
        std::fs::write(&file, b"not a library").expect("written");
        assert!(Device::open(&file, 0).is_err());
        assert!(Device::open(&folder.path().join("none.so"), 0).is_err());
    }
}
