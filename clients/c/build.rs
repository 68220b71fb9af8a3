//! Gives the shared library its name for the loader, with the version of the interface in it.

/// `UNTANGLED_ABI_VERSION`; a test compares them.
const ABI_VERSION: u32 = 1;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libuntangled_client.so.{ABI_VERSION}");
}
