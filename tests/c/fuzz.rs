//! The targets of the fuzzer for some seconds, without its engine: the corpus that is kept in the repository, and
//! pseudo-random changes of it. `make fuzz` runs them long, under AddressSanitizer.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

#[path = "../../fuzz/src/lib.rs"]
mod targets;

/// The inputs that are kept for a target, in the order of their names.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target);
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// xorshift64*
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % n.max(1)
    }

    /// One of the inputs with a few bytes changed, left out or put in, or continued by another one.
    fn changed(&mut self, inputs: &[Vec<u8>]) -> Vec<u8> {
        let mut data = inputs[self.below(inputs.len())].clone();
        for _ in 0..1 + self.below(4) {
            let at = self.below(data.len() + 1);
            match self.below(4) {
                0 => data.insert(at, self.below(256) as u8),
                1 if at < data.len() => drop(data.remove(at)),
                2 => {
                    let other = &inputs[self.below(inputs.len())];
                    data.truncate(at);
                    data.extend_from_slice(&other[self.below(other.len() + 1)..]);
                }
                _ if at < data.len() => data[at] = self.below(256) as u8,
                _ => {}
            }
        }
        data
    }
}

/// Says which input it was if the target panics.
struct Blame<'a>(&'a [u8]);

impl Drop for Blame<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let bytes: Vec<String> = self.0.iter().map(|byte| format!("\\x{byte:02x}")).collect();
            println!("printf '{}' > crash", bytes.concat());
        }
    }
}

/// Runs a target on its corpus and on changes of it until `most` are done or the time is over.
fn run(target: &str, most: usize, limit: Duration, run: impl Fn(&[u8])) -> usize {
    let (inputs, begun, mut random) = (corpus(target), Instant::now(), Random(0x9e37_79b9_7f4a_7c15));
    let blamed = |input: &[u8]| {
        let _blame = Blame(input);
        run(input);
    };
    inputs.iter().for_each(|input| blamed(input));
    (0..most).take_while(|_| begun.elapsed() < limit).map(|_| blamed(&random.changed(&inputs))).count()
}

#[test]
fn calls_in_any_order_with_any_argument_keep_their_word() {
    use std::sync::atomic::Ordering;
    let done = run("calls", 20_000, Duration::from_secs(15), targets::calls::run);
    let sequences = targets::calls::SEQUENCES.load(Ordering::Relaxed);
    let certified = targets::calls::CERTIFIED.load(Ordering::Relaxed);
    assert!(certified * 20 >= sequences, "{certified} of {sequences} sequences reach a certified solve");
    assert!(done > 0);
}

#[test]
fn any_bytes_as_options_keep_their_word() {
    assert!(run("text", 50_000, Duration::from_secs(5), targets::text::run) > 0);
}

#[test]
fn any_bytes_as_a_problem_file_are_refused_or_read_and_written_back() {
    assert!(run("file", 20_000, Duration::from_secs(8), targets::file::run) > 0);
}
