//! Ranks on threads of one process, with a link of channels as a host would write it.

use std::sync::mpsc::{channel, Receiver, Sender};
use std::sync::{Arc, Mutex};

use feti_contact::solver::{Link, Rank, Ranks};

/// The pipes of a rank to each rank that it speaks with, from rank `first` on.
struct Pipes {
    first: usize,
    ends: Vec<Mutex<(Sender<Vec<u8>>, Receiver<Vec<u8>>)>>,
}

impl Link for Pipes {
    fn send(&self, rank: usize, data: &[u8]) -> bool {
        self.ends[rank - self.first].lock().unwrap().0.send(data.to_vec()).is_ok()
    }

    fn flush(&self) -> bool {
        true
    }

    fn receive(&self, rank: usize, data: &mut [u8]) -> bool {
        let sent = self.ends[rank - self.first].lock().unwrap().1.recv();
        let Some(sent) = sent.ok().filter(|sent| sent.len() == data.len()) else { return false };
        data.copy_from_slice(&sent);
        true
    }
}

/// Runs `host` on every rank; what they return, in their order.
pub fn on_ranks<T: Send>(size: usize, host: impl Fn(Arc<Rank>) -> T + Sync) -> Vec<T> {
    let (mut leader, mut links) = (Pipes { first: 1, ends: Vec::new() }, Vec::new());
    for _ in 1..size {
        let ((down, from_leader), (up, from_other)) = (channel(), channel());
        leader.ends.push(Mutex::new((down, from_other)));
        links.push(Pipes { first: 0, ends: vec![Mutex::new((up, from_leader))] });
    }
    links.insert(0, leader);
    let host = &host;
    std::thread::scope(|scope| {
        let run = |(rank, link): (usize, Pipes)| {
            scope.spawn(move || host(Rank::new(Ranks::new(rank, size, Box::new(link)))))
        };
        let threads: Vec<_> = links.into_iter().enumerate().map(run).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}
