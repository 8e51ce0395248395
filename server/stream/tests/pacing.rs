//! Pacing with an invented clock.

use std::time::{Duration, Instant};

use tyndall_stream::encode::{Chroma, EncodeChoice};
use tyndall_stream::header::Codec;
use tyndall_stream::pacing::{Accepts, Acknowledged, Pacing, PacingSettings, Tier};

const BOTH: Accepts = Accepts {
    jpeg: true,
    png: true,
};

fn ms(millis: u64) -> Duration {
    Duration::from_millis(millis)
}

fn pacing() -> (Pacing, Instant) {
    (Pacing::new(PacingSettings::default()), Instant::now())
}

/// Begins and sends one frame.
fn send(pacing: &mut Pacing, now: Instant) -> Option<u32> {
    let frame = pacing.begin(now)?;
    pacing.sent(frame, now);
    Some(frame)
}

fn moving_quality(pacing: &Pacing) -> u8 {
    match pacing.choose(Tier::Moving, BOTH) {
        EncodeChoice::Jpeg { quality, .. } => quality,
        EncodeChoice::Png => panic!("moving pictures are jpeg"),
    }
}

#[test]
fn at_most_two_frames_are_on_their_way() {
    let (mut pacing, now) = pacing();
    assert_eq!(send(&mut pacing, now), Some(1));
    assert_eq!(
        pacing.begin(now),
        Some(2),
        "a frame being rendered takes a place"
    );
    assert_eq!(pacing.begin(now), None);
    assert_eq!(pacing.in_flight(), 2);
    pacing.discard(2);
    assert_eq!(
        pacing.begin(now),
        Some(3),
        "a discarded frame gives its place back"
    );
}

#[test]
fn acknowledgement_opens_the_window_and_measures_the_round_trip() {
    let (mut pacing, now) = pacing();
    send(&mut pacing, now);
    send(&mut pacing, now + ms(5));
    let outcome = pacing.acknowledge(1, now + ms(40));
    assert_eq!(outcome, Acknowledged::RoundTrip(ms(40)));
    assert_eq!(pacing.begin(now + ms(41)), Some(3));
    assert_eq!(pacing.round_trip(), Some(ms(40)));
}

#[test]
fn acknowledging_the_newest_covers_the_older() {
    let (mut pacing, now) = pacing();
    send(&mut pacing, now);
    send(&mut pacing, now + ms(10));
    assert_eq!(
        pacing.acknowledge(2, now + ms(30)),
        Acknowledged::RoundTrip(ms(20))
    );
    assert_eq!(pacing.in_flight(), 0);
}

#[test]
fn stale_and_invented_acknowledgements_change_nothing() {
    let (mut pacing, now) = pacing();
    send(&mut pacing, now);
    let rendering = pacing.begin(now).unwrap();
    for frame in [0, rendering, 77, u32::MAX] {
        assert_eq!(pacing.acknowledge(frame, now + ms(1)), Acknowledged::Stale);
    }
    assert_eq!(pacing.in_flight(), 2);
    assert_eq!(
        pacing.acknowledge(1, now + ms(2)),
        Acknowledged::RoundTrip(ms(2))
    );
    assert_eq!(
        pacing.acknowledge(1, now + ms(3)),
        Acknowledged::Stale,
        "twice"
    );
}

#[test]
fn silent_client_is_unwedged_after_two_seconds() {
    let (mut pacing, now) = pacing();
    send(&mut pacing, now);
    send(&mut pacing, now + ms(100));
    assert_eq!(pacing.next_deadline(), Some(now + ms(2000)));
    assert!(!pacing.is_open(now + ms(1999)));
    assert!(pacing.is_open(now + ms(2000)));
    assert_eq!(pacing.in_flight(), 1, "only the older frame is given up");
    assert_eq!(
        pacing.next_deadline(),
        None,
        "an open window waits for nothing"
    );
    assert_eq!(send(&mut pacing, now + ms(2000)), Some(3));
    assert_eq!(pacing.acknowledge(1, now + ms(2001)), Acknowledged::Stale);
}

#[test]
fn slow_rendering_is_not_taken_for_a_silent_client() {
    let (mut pacing, now) = pacing();
    pacing.begin(now);
    pacing.begin(now);
    assert!(!pacing.is_open(now + ms(60_000)));
    assert_eq!(pacing.next_deadline(), None);
}

#[test]
fn tiers_follow_the_last_input() {
    let (mut pacing, now) = pacing();
    assert_eq!(pacing.tier(false, now), Tier::Settling, "no input yet");
    pacing.input(now);
    assert_eq!(pacing.tier(false, now + ms(249)), Tier::Moving);
    assert_eq!(pacing.tier(false, now + ms(250)), Tier::Settling);
    assert_eq!(pacing.tier(true, now + ms(1)), Tier::Converged);
}

#[test]
fn tiers_choose_their_codecs() {
    let (pacing, _) = pacing();
    let jpeg = |quality, chroma| EncodeChoice::Jpeg { quality, chroma };
    assert_eq!(pacing.choose(Tier::Moving, BOTH), jpeg(75, Chroma::Quarter));
    assert_eq!(pacing.choose(Tier::Settling, BOTH), jpeg(92, Chroma::Full));
    assert_eq!(pacing.choose(Tier::Converged, BOTH), EncodeChoice::Png);
    let jpeg_only = Accepts::from_list(&[Codec::Jpeg]).unwrap();
    assert_eq!(
        pacing.choose(Tier::Converged, jpeg_only),
        jpeg(95, Chroma::Full)
    );
    let png_only = Accepts::from_list(&[Codec::Png]).unwrap();
    assert_eq!(pacing.choose(Tier::Moving, png_only), EncodeChoice::Png);
    assert_eq!(Accepts::from_list(&[]), None);
}

#[test]
fn quality_falls_while_the_queue_fills_and_recovers_when_it_drains() {
    let (mut pacing, mut now) = pacing();
    let mut exchange = |pacing: &mut Pacing, round_trip: Duration| {
        let frame = send(pacing, now).unwrap();
        now += round_trip;
        pacing.acknowledge(frame, now);
    };
    exchange(&mut pacing, ms(20));
    assert_eq!(moving_quality(&pacing), 75);
    for _ in 0..40 {
        exchange(&mut pacing, ms(600));
    }
    let slow = moving_quality(&pacing);
    assert!((35..75).contains(&slow), "{slow}");
    for _ in 0..60 {
        exchange(&mut pacing, ms(20));
    }
    assert_eq!(moving_quality(&pacing), 75);
}

#[test]
fn a_long_but_steady_route_keeps_its_quality() {
    let (mut pacing, mut now) = pacing();
    for _ in 0..100 {
        let frame = send(&mut pacing, now).unwrap();
        now += ms(300);
        pacing.acknowledge(frame, now);
    }
    assert_eq!(moving_quality(&pacing), 75);
}

#[test]
fn reconnecting_forgets_the_link_but_not_the_frame_count() {
    let (mut pacing, now) = pacing();
    send(&mut pacing, now);
    send(&mut pacing, now);
    pacing.reconnect();
    assert_eq!(pacing.in_flight(), 0);
    assert_eq!(pacing.begin(now), Some(3));
}
