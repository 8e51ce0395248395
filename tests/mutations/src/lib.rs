//! Small changes to whole files and messages: what a reader makes of ten thousand of them.
//!
//! The changes follow from a fixed seed, so every run tests the same inputs. More of them, of other
//! seeds, with the environment variables `TYNDALL_MUTATIONS` (how many a format) and
//! `TYNDALL_MUTATION_SEED`.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Changed inputs of each format, unless the environment says otherwise.
const CASES: u64 = 10_000;
/// Numbers that readers get wrong more often than others.
const EXTREMES: [u64; 12] = [
    0,
    1,
    2,
    0x7f,
    0xff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7fc0_0000,
    0x7ff8_0000_0000_0000,
    i64::MAX as u64,
    u64::MAX,
];
/// Words that parsers of text get wrong more often than others.
const WORDS: [&str; 12] = [
    "0",
    "-1",
    "1e308",
    "-1e-320",
    "99999999999999999999",
    "null",
    "[]",
    "{}",
    "\"\"",
    "true",
    "nan",
    "\u{1f4a5}",
];

/// What of an input is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Bits, bytes and integers.
    Binary,
    /// Digits and words too.
    Text,
}

/// Makes changed copies of inputs, the same ones for the same seed (xorshift, Marsaglia 2003).
#[derive(Debug, Clone)]
pub struct Mutator {
    state: u64,
}

impl Mutator {
    /// A mutator whose changes follow from `seed`.
    pub fn new(seed: u64) -> Self {
        // Zero would stay zero.
        let state = (seed ^ 0x2545_f491_4f6c_dd1d).max(1);
        Self { state }
    }

    /// A number below `below`; 0 if that is 0.
    pub fn below(&mut self, below: usize) -> usize {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 7;
        self.state ^= self.state << 17;
        (self.state % below.max(1) as u64) as usize
    }

    /// A place in a text of this length; every other one is near its beginning, where headers are.
    fn place(&mut self, length: usize) -> usize {
        let most = if self.below(2) == 0 {
            length.min(64)
        } else {
            length
        };
        self.below(most)
    }

    /// A copy with one to three changes.
    pub fn changed(&mut self, input: &[u8], kind: Kind) -> Vec<u8> {
        let mut bytes = input.to_vec();
        for _ in 0..=self.below(3) {
            self.change(&mut bytes, kind);
        }
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>, kind: Kind) {
        let length = bytes.len();
        if length == 0 {
            return;
        }
        let at = self.place(length);
        let choices = if kind == Kind::Text { 7 } else { 5 };
        match self.below(choices) {
            0 => bytes[at] ^= 1 << self.below(8),
            1 => {
                let cut = self.place(length);
                bytes.truncate(length - cut);
            }
            2 | 3 => {
                let size = [1, 2, 4, 8][self.below(4)];
                let number = EXTREMES[self.below(EXTREMES.len())];
                let number = if self.below(2) == 0 {
                    number.to_le_bytes()
                } else {
                    number.rotate_right(8 * size as u32).to_be_bytes()
                };
                let end = (at + size).min(length);
                bytes[at..end].copy_from_slice(&number[..end - at]);
            }
            4 => {
                let count = 1 + self.below(64);
                let from = self.place(length);
                let piece = bytes[from..(from + count).min(length)].to_vec();
                let replaced = self.below(count);
                bytes.splice(at..(at + replaced).min(length), piece);
            }
            _ => {
                let word = WORDS[self.below(WORDS.len())];
                let replaced = self.below(8);
                bytes.splice(at..(at + replaced).min(length), word.bytes());
            }
        }
    }
}

/// Changed inputs of each format in this run.
pub fn cases() -> u64 {
    number("TYNDALL_MUTATIONS").unwrap_or(CASES)
}

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

/// Gives `read` changed copies of the seeds; true says that it took one. None may panic or take
/// longer than `within`.
///
/// # Panics
/// If one does; the message has the input as a Rust literal.
pub fn attack(
    format: &str,
    seeds: &[Vec<u8>],
    kind: Kind,
    within: Duration,
    mut read: impl FnMut(&[u8]) -> bool,
) {
    for (i, seed) in seeds.iter().enumerate() {
        assert!(read(seed), "{format}: whole input {i} is refused");
    }
    let mut mutator = Mutator::new(number("TYNDALL_MUTATION_SEED").unwrap_or(1));
    let begin = Instant::now();
    let (mut taken, mut slowest, mut culprit) = (0_u64, Duration::ZERO, Vec::new());
    let cases = cases();
    for _ in 0..cases {
        let seed = &seeds[mutator.below(seeds.len())];
        let input = mutator.changed(seed, kind);
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| read(&input)));
        let Ok(is_fine) = outcome else {
            panic!("{format}: the reader panics on {}", literal(&input));
        };
        taken += u64::from(is_fine);
        let time = start.elapsed();
        if time > slowest {
            (slowest, culprit) = (time, input);
        }
    }
    eprintln!(
        "{format}: {cases} inputs, {taken} of them taken, in {:.1} s, the slowest in {} ms",
        begin.elapsed().as_secs_f64(),
        slowest.as_millis()
    );
    let slow = literal(&culprit);
    assert!(slowest <= within, "{format}: {slowest:?} for {slow}");
}

/// An input as a Rust literal, cut short.
fn literal(input: &[u8]) -> String {
    const MOST: usize = 4096;
    let rest = if input.len() > MOST { "…" } else { "" };
    let shown = input[..input.len().min(MOST)].escape_ascii();
    format!("b\"{shown}\"{rest} ({} bytes)", input.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_seeds_give_equal_changes_and_others_others() {
        let input: Vec<u8> = (0..200).collect();
        let run = |seed| {
            let mut mutator = Mutator::new(seed);
            let copies = (0..100).map(|_| mutator.changed(&input, Kind::Text));
            copies.collect::<Vec<_>>()
        };
        assert_eq!(run(1), run(1));
        assert_ne!(run(1), run(2));
        let changed = run(1).iter().filter(|copy| **copy != input).count();
        assert!(changed > 90, "{changed} of 100 differ");
    }

    #[test]
    #[should_panic(expected = "the reader panics on b\"")]
    fn a_reader_that_panics_is_told_with_its_input() {
        attack("toy", &[vec![7; 9]], Kind::Binary, Duration::MAX, |bytes| {
            assert!(bytes.len() == 9 && bytes[4] == 7, "broken");
            true
        });
    }
}
