//! Rank 0, which leads, and the ranks that serve it: requests, answers, and the tokens under which the others keep what rank 0 has
//! sent. Knows no body.
//!
//! Rank 0 sends one request to each rank that it needs, works itself, and receives the answers in the order of the ranks. Nobody sends
//! unasked, and one request at most waits for its answer: the exchange cannot lock.

mod alone;
mod frame;
#[cfg(any(test, feature = "loopback"))]
pub mod loopback;
mod wire;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::error::{Error, Kind, Result};
use crate::platform::interrupt::Interrupt;
use crate::platform::memory::filled;
use crate::platform::stopwatch;
use frame::{Frame, FRAME};
#[cfg(feature = "loopback")]
pub use wire::spoiling;
pub use wire::{damaged, message, put_all, value, Wire};
pub(crate) use wire::{wire_enum, wire_struct, wire_unit};

/// Moves bytes between rank 0 and another rank, in the order in which they are sent. Each call returns whether it succeeded.
pub trait Link: Send + Sync {
    /// `data` stay unchanged until `flush`.
    fn send(&self, rank: usize, data: &[u8]) -> bool;

    /// All data sent may be changed after it.
    fn flush(&self) -> bool;

    /// Waits for exactly these bytes, which were sent in one portion.
    fn receive(&self, rank: usize, data: &mut [u8]) -> bool;
}

/// The ranks that share one stream of messages.
pub struct Ranks {
    pub rank: usize,
    pub size: usize,
    link: Box<dyn Link>,
    /// A request waits for its answer.
    busy: AtomicBool,
    /// The link has failed, or the other ranks serve no longer.
    closed: AtomicBool,
    /// Requests and tokens so far.
    serial: AtomicU64,
    /// Problems of which other ranks have parts: the rank, and their numbers here and there.
    pairs: Mutex<Vec<(usize, u64, u64)>>,
    /// Set if the host cancels the call that all ranks make: on rank 0 also by an answer of another.
    cancel: Mutex<Option<Arc<AtomicBool>>>,
    /// Tokens, with their ranks, that rank 0 no longer has.
    dropped: Mutex<Vec<(usize, u64)>>,
    traffic: Mutex<Traffic>,
}

/// What rank 0 has exchanged with the others.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Traffic {
    /// Requests and answers.
    pub messages: u64,
    pub bytes: u64,
    /// Time in which rank 0 waited for answers.
    pub seconds_waited: f64,
}

/// One question to one rank.
pub struct Request {
    pub rank: usize,
    pub question: u32,
    /// Writes it.
    pub put: Put,
}

/// What is written to the end of a message, once.
pub type Put = Box<dyn FnOnce(&mut Vec<u8>)>;

/// A request as the rank that serves receives it.
pub struct Incoming {
    pub question: u32,
    pub message: Vec<u8>,
    /// Tokens that rank 0 has dropped before it.
    pub dropped: Vec<u64>,
    pub seconds_left: f64,
    serial: u64,
}

/// The question that ends the service.
pub const END: u32 = 0;

impl Ranks {
    /// `rank` of `size` ranks; messages run by `link`.
    pub fn new(rank: usize, size: usize, link: Box<dyn Link>) -> Arc<Self> {
        Arc::new(Self {
            rank,
            size,
            link,
            busy: AtomicBool::new(false),
            closed: AtomicBool::new(false),
            serial: AtomicU64::new(0),
            pairs: Mutex::default(),
            cancel: Mutex::default(),
            dropped: Mutex::default(),
            traffic: Mutex::default(),
        })
    }

    /// The other ranks answer no more: what they kept is lost.
    pub fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }

    pub fn traffic(&self) -> Traffic {
        *lock(&self.traffic)
    }

    /// On rank 0: other ranks have given parts of a problem; these are their numbers here and there. False, and nothing is kept, if this
    /// turns the order in which the problems of both were created.
    pub fn pair(&self, here: u64, there: &[(usize, u64)]) -> bool {
        let mut pairs = lock(&self.pairs);
        let suits = |(rank, number): &(usize, u64)| {
            let of_rank = pairs.iter().filter(|(of, ..)| of == rank);
            of_rank.into_iter().all(|(_, a, b)| (*a < here) == (b < number))
        };
        let fits = there.iter().all(suits);
        pairs.extend(there.iter().filter(|_| fits).map(|(rank, number)| (*rank, here, *number)));
        fits
    }

    /// The first of so many new names, which a rank will give.
    pub fn block(&self, count: u64) -> u64 {
        self.serial.fetch_add(count, Ordering::Relaxed)
    }

    /// The name that a rank has given.
    pub fn named(self: &Arc<Self>, rank: usize, number: u64) -> Token {
        Token { ranks: Arc::clone(self), rank, number }
    }

    /// A new name for something that a rank will keep.
    pub fn token(self: &Arc<Self>, rank: usize) -> Token {
        Token { ranks: Arc::clone(self), rank, number: self.serial.fetch_add(1, Ordering::Relaxed) }
    }

    /// While all ranks make a call, this flag cancels it.
    pub fn cancel_by(&self, flag: Option<Arc<AtomicBool>>) {
        *lock(&self.cancel) = flag;
    }

    fn is_cancelled(&self) -> bool {
        lock(&self.cancel).as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Sends these requests, at most one to each rank, in the order of the ranks. Dropping the result receives the answers, so that no
    /// error leaves a message behind.
    pub fn ask(self: &Arc<Self>, requests: Vec<Request>) -> Result<Asked> {
        if self.is_closed() {
            return Err(Error::new(Kind::Communication, "the other ranks serve no longer"));
        }
        if self.busy.swap(true, Ordering::Acquire) {
            let what =
                "the other ranks are answering another call, as from a function that this call has called";
            return Err(Error::new(Kind::Communication, what));
        }
        let seconds_left = Interrupt::present().seconds_left();
        let mut asked = Asked { ranks: Arc::clone(self), waiting: Vec::new() };
        let mut sent = Vec::with_capacity(requests.len());
        for request in requests {
            let mut message = message(&self.dropped_of(request.rank));
            (request.put)(&mut message);
            let serial = self.serial.fetch_add(1, Ordering::Relaxed);
            let frame = Frame::new(serial, request.question, false, message.len(), seconds_left);
            sent.push((request.rank, wire::message(&frame), message));
            asked.waiting.push((request.rank, serial));
        }
        let is_sent = sent.iter().all(|(rank, frame, message)| self.send(*rank, frame, message));
        // also after a failure: what is on its way may not be freed
        let is_flushed = self.waiting(|| self.link.flush());
        if !(is_sent && is_flushed) {
            asked.waiting.clear();
            return Err(self.failed());
        }
        Ok(asked)
    }

    /// Ends the service of the other ranks.
    pub fn end(self: &Arc<Self>) -> Result<()> {
        if self.is_closed() {
            return Ok(());
        }
        let request = |rank| Request { rank, question: END, put: Box::new(|_| {}) };
        let ended = self.ask((1..self.size).map(request).collect())?.answers();
        self.closed.store(true, Ordering::Relaxed);
        ended.map(drop)
    }

    /// The next request of rank 0.
    pub fn next(&self) -> Result<Incoming> {
        let (frame, mut message) = self.receive(0)?;
        let mut rest = &message[..];
        let dropped = Vec::take(&mut rest)?;
        let begin = message.len() - rest.len();
        message.drain(..begin);
        let Frame { question, seconds_left, serial, .. } = frame;
        Ok(Incoming { question, message, dropped, seconds_left, serial })
    }

    /// The answer to a request; an error of a request is its answer.
    pub fn reply(&self, incoming: &Incoming, answer: Result<Vec<u8>>) -> Result<()> {
        let failed = answer.is_err();
        let message = answer.unwrap_or_else(|error| wire::message(&error));
        let frame = Frame::new(incoming.serial, incoming.question, failed, message.len(), f64::INFINITY);
        let frame = Frame { cancelled: u64::from(self.is_cancelled()), ..frame };
        let is_sent = self.send(0, &wire::message(&frame), &message);
        if self.link.flush() && is_sent {
            Ok(())
        } else {
            Err(self.failed())
        }
    }

    /// Sends a message in two portions, as it is received: its frame, and what it says.
    fn send(&self, rank: usize, frame: &[u8], message: &[u8]) -> bool {
        self.count(frame.len() + message.len());
        self.link.send(rank, frame) && (message.is_empty() || self.link.send(rank, message))
    }

    fn count(&self, bytes: usize) {
        let mut traffic = lock(&self.traffic);
        traffic.messages += 1;
        traffic.bytes += bytes as u64;
    }

    /// A frame and its message.
    fn receive(&self, rank: usize) -> Result<(Frame, Vec<u8>)> {
        let mut bytes = [0; FRAME];
        if !self.link.receive(rank, &mut bytes) {
            return Err(self.failed());
        }
        let frame = value::<Frame>(&bytes)?;
        if !frame.is_ours() {
            self.closed.store(true, Ordering::Relaxed);
            let what = format!("rank {rank} runs another build of the library");
            return Err(Error::new(Kind::Communication, what));
        }
        let count = usize::try_from(frame.bytes).map_err(|_| damaged())?;
        // no room: the stream cannot go on
        let mut message = filled(count, 0, "a message of another rank")
            .inspect_err(|_| self.closed.store(true, Ordering::Relaxed))?;
        if count > 0 && !self.link.receive(rank, &mut message) {
            return Err(self.failed());
        }
        self.count(FRAME + count);
        Ok((frame, message))
    }

    /// Counts the time of `work` as waiting.
    fn waiting<T>(&self, work: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let done = stopwatch::aside(work);
        lock(&self.traffic).seconds_waited += begun.elapsed().as_secs_f64();
        done
    }

    fn failed(&self) -> Error {
        self.closed.store(true, Ordering::Relaxed);
        Error::new(Kind::Communication, "a message could not be sent to or received from another rank")
    }

    /// Tokens of a rank that have been dropped since the last request.
    fn dropped_of(&self, rank: usize) -> Vec<u64> {
        let mut all = lock(&self.dropped);
        let (own, others) = all.iter().partition::<Vec<_>, _>(|(of, _)| *of == rank);
        *all = others;
        own.into_iter().map(|(_, number)| number).collect()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The name of something that another rank keeps. No destructor sends: the next request tells that it was dropped.
pub struct Token {
    pub ranks: Arc<Ranks>,
    pub rank: usize,
    pub number: u64,
}

impl Drop for Token {
    fn drop(&mut self) {
        lock(&self.ranks.dropped).push((self.rank, self.number));
    }
}

/// Requests whose answers have not been received.
pub struct Asked {
    ranks: Arc<Ranks>,
    waiting: Vec<(usize, u64)>,
}

impl Asked {
    /// The answers, in the order of the requests, each perhaps an error; an error of the link is an error of all.
    pub fn answers(mut self) -> Result<Vec<Result<Vec<u8>>>> {
        let mut answers = Vec::with_capacity(self.waiting.len());
        while !self.waiting.is_empty() {
            answers.push(self.next()?);
        }
        Ok(answers)
    }

    fn next(&mut self) -> Result<Result<Vec<u8>>> {
        let (rank, serial) = self.waiting.remove(0);
        let (frame, message) = self.ranks.waiting(|| self.ranks.receive(rank))?;
        if frame.serial != serial {
            self.ranks.closed.store(true, Ordering::Relaxed);
            return Err(damaged());
        }
        if frame.cancelled != 0 {
            lock(&self.ranks.cancel).iter().for_each(|flag| flag.store(true, Ordering::Relaxed));
        }
        Ok(if frame.failed == 0 { Ok(message) } else { Err(value::<Error>(&message)?) })
    }
}

impl Drop for Asked {
    fn drop(&mut self) {
        while !self.waiting.is_empty() && !self.ranks.is_closed() {
            drop(self.next());
        }
        self.ranks.busy.store(false, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ranks::loopback::linked;

    /// Rank 1 answers twice the number, and refuses negative ones; ends at `END`.
    fn double(ranks: &Ranks) -> Vec<u64> {
        let mut dropped = Vec::new();
        loop {
            let incoming = ranks.next().unwrap();
            dropped.extend(&incoming.dropped);
            if incoming.question == END {
                ranks.reply(&incoming, Ok(Vec::new())).unwrap();
                return dropped;
            }
            let v: f64 = value(&incoming.message).unwrap();
            let refused = || Error::new(Kind::Indefinite, "negative").value(v);
            ranks.reply(&incoming, if v < 0.0 { Err(refused()) } else { Ok(message(&(2.0 * v))) }).unwrap();
        }
    }

    fn ask(ranks: &Arc<Ranks>, v: f64) -> Result<Vec<Result<Vec<u8>>>> {
        let request =
            |rank| Request { rank, question: 5, put: Box::new(move |to| (v * rank as f64).put(to)) };
        ranks.ask((1..ranks.size).map(request).collect())?.answers()
    }

    #[test]
    fn every_rank_answers_and_an_error_is_an_answer() {
        let (leader, others) = linked(3);
        std::thread::scope(|scope| {
            let served: Vec<_> = others.iter().map(|ranks| scope.spawn(|| double(ranks))).collect();
            let answers = ask(&leader, 3.0).unwrap();
            assert_eq!(answers.into_iter().map(|a| value::<f64>(&a.unwrap()).unwrap()).sum::<f64>(), 18.0);
            let refused = ask(&leader, -1.0).unwrap();
            assert!(refused.iter().all(|a| a.as_ref().unwrap_err().kind == Kind::Indefinite));
            let number = leader.token(2).number;
            // a request whose answers nobody takes leaves none behind, and none may be asked meanwhile
            let waiting =
                leader.ask(vec![Request { rank: 2, question: 5, put: Box::new(|to| 1f64.put(to)) }]).unwrap();
            assert_eq!(ask(&leader, 1.0).unwrap_err().kind, Kind::Communication);
            drop(waiting);
            assert_eq!(value::<f64>(ask(&leader, 1.0).unwrap().remove(1).unwrap().as_slice()).unwrap(), 4.0);
            leader.end().unwrap();
            assert!(ask(&leader, 1.0).is_err());
            let dropped: Vec<_> = served.into_iter().map(|thread| thread.join().unwrap()).collect();
            assert_eq!(dropped, [vec![], vec![number]]);
        });
    }

    #[test]
    fn a_broken_link_closes_the_stream_and_nobody_waits() {
        let (leader, others) = linked(2);
        drop(others);
        assert_eq!(ask(&leader, 1.0).unwrap_err().kind, Kind::Communication);
        assert!(leader.is_closed());
        leader.end().unwrap();
    }
}
