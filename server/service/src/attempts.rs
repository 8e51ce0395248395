//! Slows down who tries tokens: each wrong one costs its address half a second of waiting, the first few
//! nothing, and an address that owes too much is not even looked at.
//!
//! Addresses share a fixed number of slots by a hash that nobody outside can foresee, so the memory is
//! bounded however many addresses there are.

use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;
use std::net::IpAddr;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use crate::bell::lock;

/// Slots that addresses share.
const SLOTS: usize = 1024;
/// What a wrong token costs.
const COST: Duration = Duration::from_millis(500);
/// What an address may owe without waiting: someone who mistypes.
const FREE: Duration = Duration::from_secs(4);
/// Longest wait for the answer to a wrong token.
const LONGEST: Duration = Duration::from_secs(2);
/// What an address may owe before its tokens are refused unseen.
const MOST: Duration = Duration::from_secs(12);

/// What each address owes.
#[derive(Debug)]
pub(crate) struct Attempts {
    hasher: RandomState,
    /// When the debt of a slot is paid.
    paid: Mutex<Vec<Option<Instant>>>,
}

impl Attempts {
    pub(crate) fn new() -> Self {
        Self {
            hasher: RandomState::new(),
            paid: Mutex::new(vec![None; SLOTS]),
        }
    }

    /// Whether a token of this address is looked at; if not, after how long one will be.
    pub(crate) fn check(&self, address: IpAddr, now: Instant) -> Result<(), Duration> {
        let paid = lock(&self.paid)[self.slot(address)];
        let debt = paid.map_or(Duration::ZERO, |paid| paid.saturating_duration_since(now));
        match debt.saturating_sub(MOST) {
            Duration::ZERO => Ok(()),
            wait => Err(wait),
        }
    }

    /// Counts a wrong token, and says how long its answer waits.
    pub(crate) fn failed(&self, address: IpAddr, now: Instant) -> Duration {
        let slot = self.slot(address);
        let mut slots = lock(&self.paid);
        let paid = slots[slot].map_or(now, |paid| paid.max(now)) + COST;
        slots[slot] = Some(paid);
        (paid - now).saturating_sub(FREE).min(LONGEST)
    }

    /// One user of IPv6 has at least 2⁶⁴ addresses: they count as one.
    fn slot(&self, address: IpAddr) -> usize {
        let key = match address.to_canonical() {
            IpAddr::V4(address) => u128::from(address.to_bits()),
            IpAddr::V6(address) => address.to_bits() >> 64 | 1 << 127,
        };
        (self.hasher.hash_one(key) % SLOTS as u64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_tokens_wait_longer_and_longer_and_are_refused_in_the_end() {
        let attempts = Attempts::new();
        let (start, address) = (Instant::now(), IpAddr::from([10, 0, 0, 1]));
        let waits: Vec<u128> = (0..14)
            .map(|_| attempts.failed(address, start).as_millis())
            .collect();
        assert_eq!(waits[..8], [0; 8]);
        assert_eq!(waits[8..], [500, 1000, 1500, 2000, 2000, 2000]);
        assert!(attempts.check(address, start).is_ok());
        for _ in 0..11 {
            attempts.failed(address, start);
        }
        let wait = attempts.check(address, start).unwrap_err();
        assert_eq!(wait, Duration::from_millis(500));
        assert!(attempts.check(address, start + wait).is_ok());
        let later = start + Duration::from_mins(1);
        assert_eq!(attempts.failed(address, later), Duration::ZERO);
    }

    #[test]
    fn a_network_counts_as_one_address_and_memory_is_bounded() {
        let attempts = Attempts::new();
        let at = |text: &str| attempts.slot(text.parse().unwrap());
        assert_eq!(at("2001:db8::1"), at("2001:db8::ffff:1"));
        assert_eq!(at("::ffff:10.0.0.1"), at("10.0.0.1"));
        for i in 0..100_000_u32 {
            attempts.failed(IpAddr::from(i.to_be_bytes()), Instant::now());
        }
        assert_eq!(lock(&attempts.paid).len(), SLOTS);
    }
}
