//! Build script. It tells the linker of macOS to accept symbols of Python that are resolved when
//! the module is imported.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
