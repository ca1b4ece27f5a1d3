//! Ranks on threads of one process, linked by channels: for tests.

use std::sync::mpsc::{channel, Receiver, Sender};
use std::sync::{Arc, Mutex};

use crate::ranks::{lock, Link, Ranks};

/// The ends of the channels of one rank to each other rank it speaks with.
struct Channels {
    first: usize,
    to: Vec<Mutex<Sender<Vec<u8>>>>,
    from: Vec<Mutex<Receiver<Vec<u8>>>>,
}

impl Link for Channels {
    fn send(&self, rank: usize, data: &[u8]) -> bool {
        lock(&self.to[rank - self.first]).send(data.to_vec()).is_ok()
    }

    fn flush(&self) -> bool {
        true
    }

    fn receive(&self, rank: usize, data: &mut [u8]) -> bool {
        let Ok(sent) = lock(&self.from[rank - self.first]).recv() else { return false };
        let is_whole = sent.len() == data.len();
        if is_whole {
            data.copy_from_slice(&sent);
        }
        is_whole
    }
}

/// Rank 0 of `size` ranks, and the others.
pub fn linked(size: usize) -> (Arc<Ranks>, Vec<Arc<Ranks>>) {
    linked_by(size, |link| link)
}

/// As `linked`, with another link of rank 0.
pub fn linked_by(
    size: usize,
    link: impl FnOnce(Box<dyn Link>) -> Box<dyn Link>,
) -> (Arc<Ranks>, Vec<Arc<Ranks>>) {
    let mut of_leader = Channels { first: 1, to: Vec::new(), from: Vec::new() };
    let mut others = Vec::new();
    for rank in 1..size {
        let ((down, from_leader), (up, from_other)) = (channel(), channel());
        of_leader.to.push(Mutex::new(down));
        of_leader.from.push(Mutex::new(from_other));
        let (to, from) = (vec![Mutex::new(up)], vec![Mutex::new(from_leader)]);
        others.push(Ranks::new(rank, size, Box::new(Channels { first: 0, to, from })));
    }
    (Ranks::new(0, size, link(Box::new(of_leader))), others)
}
