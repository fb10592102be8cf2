//! The program `enfilade`; everything it does is in the library, see [`enfilade::cli`].

use std::process::ExitCode;

use enfilade::cli::Memory;
use peak_alloc::PeakAlloc;

/// Counts what is on the heap, for `enfilade study`. Here and not in the library, which leaves the
/// choice of an allocator to the program.
#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

fn main() -> ExitCode {
    enfilade::cli::main(Some(Memory {
        now: || HEAP.current_usage(),
        peak: || HEAP.peak_usage(),
        forget_peak: || HEAP.reset_peak_usage(),
    }))
}
