//! Counts the expensive work of a thread for tests, which check how much is still done once a call has to end.

#[cfg(test)]
thread_local! {
    static DONE: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// A product with F, a system solved with a coarse factor, a factorisation: begun now.
pub fn costly() {
    #[cfg(test)]
    DONE.set(DONE.get() + 1);
}

/// How much this thread has begun so far.
#[cfg(test)]
pub fn done() -> usize {
    DONE.get()
}
