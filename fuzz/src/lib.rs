//! Fuzz targets: `cargo fuzz run -s none NAME` for every name of [`TARGETS`].

mod memory;
mod targets;

pub use libfuzzer_sys;
pub use memory::Counting;
pub use targets::{TARGETS, run};

/// A fuzz target that runs one row of [`TARGETS`], with an allocator that counts memory.
#[macro_export]
macro_rules! target {
    ($name:literal) => {
        #[global_allocator]
        static MEMORY: $crate::Counting = $crate::Counting;
        $crate::libfuzzer_sys::fuzz_target!(|data: &[u8]| $crate::run($name, data));
    };
}
