//! Counts the expensive work of a thread for tests, which check how much is still done after a call has to end.

#[cfg(test)]
thread_local! {
    static DONE: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// Counts the beginning of a product with F, a solve with a coarse factor, or a factorisation.
pub fn costly() {
    #[cfg(test)]
    DONE.set(DONE.get() + 1);
}

/// Number of such operations that this thread has begun.
#[cfg(test)]
pub fn done() -> usize {
    DONE.get()
}
