//! What the functions of a host that listen keep; they stay where they are as long as the host.

/// What a host's progress function counts and does.
#[derive(Default)]
pub struct Watcher {
    pub p: usize,
    pub calls: u64,
    /// Calls until it returns `verdict`.
    pub until: u64,
    pub verdict: i32,
}

/// What a host's log function counts, and when it gives up.
#[derive(Default)]
pub struct Listener {
    pub level: i32,
    /// Lines until it returns a failure.
    pub left: u64,
}
