//! Ranks that serve on threads of this process: for tests.

use std::sync::Arc;

use crate::body::{Bodies, Name};
use crate::error::Result;
use crate::ranks::loopback::linked;
use crate::ranks::{Incoming, Ranks};
use crate::serving::{answer, answer_all, taken};

/// Rank 0 of `size` ranks, whose others serve until it is dropped. At the end of each its bodies go to `ended`.
pub fn on_threads(size: usize, ended: impl Fn(&Bodies) + Clone + Send + 'static) -> Arc<Ranks> {
    let (leader, others) = linked(size);
    for ranks in others {
        let ended = ended.clone();
        std::thread::spawn(move || {
            let mut bodies = Bodies::new(taken);
            let wrong = std::env::var("RANKS_WRONG");
            bodies.wrong = Name::ALL
                .iter()
                .find(|name| wrong.as_ref().is_ok_and(|of| *of == format!("{name:?}")))
                .copied();
            let served = answer_all(&ranks, &bodies, &mut alone);
            drop(served);
            ended(&bodies);
        });
    }
    leader
}

fn alone(incoming: &Incoming, bodies: &Bodies) -> Result<Vec<u8>> {
    answer(bodies, incoming, 1)
}

/// As many ranks as variable RANKS says; RANKS_WRONG names a kind of questions that they answer wrongly in the last bit. A line for each is added to file RANKS_LOG: how many questions of each kind it has answered.
pub fn by_environment() -> Option<Arc<Ranks>> {
    let size = std::env::var("RANKS").ok()?.parse().ok().filter(|size| *size > 1)?;
    Some(on_threads(size, |bodies| {
        let counts = Name::ALL.iter().zip(bodies.asked()).map(|(name, count)| format!("{name:?} {count}"));
        log(&counts.collect::<Vec<_>>().join(" "));
    }))
}

/// Adds a line to file RANKS_LOG, if there is such a variable.
pub fn log(line: &str) {
    use std::io::Write;

    let Ok(path) = std::env::var("RANKS_LOG") else { return };
    let opened = std::fs::OpenOptions::new().create(true).append(true).open(path);
    // one write: lines of several processes do not mix
    opened.and_then(|mut file| file.write_all(format!("{line}\n").as_bytes())).ok();
}
