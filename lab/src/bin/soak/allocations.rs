//! An allocator that counts, by thread.

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
    sync::atomic::{AtomicU64, Ordering},
};

thread_local! {
    static BY_THREAD: Cell<u64> = const { Cell::new(0) };
}
static BY_ALL: AtomicU64 = AtomicU64::new(0);

/// The system's allocator with a count of calls that hand out memory.
pub(crate) struct Counting;

/// Calls of this thread so far.
pub(crate) fn of_this_thread() -> u64 {
    BY_THREAD.with(Cell::get)
}

/// Calls of all threads so far.
pub(crate) fn of_all_threads() -> u64 {
    BY_ALL.load(Ordering::Relaxed)
}

fn count() {
    BY_ALL.fetch_add(1, Ordering::Relaxed);
    // A thread that is ending has no count any more.
    let _ = BY_THREAD.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: all calls go to the system's allocator as they came; counting allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: as the caller promised.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as the caller promised.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: as the caller promised.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as the caller promised.
        unsafe { System.realloc(memory, layout, size) }
    }
}
