//! The frame header: every value survives, hostile bytes end in a named error.

#![allow(
    clippy::unwrap_used,
    reason = "a test that unwraps says where it failed"
)]

use proptest::prelude::*;
use tyndall_stream::header::{
    Codec, FrameHeader, HEADER_BYTES, HeaderError, MAX_PAYLOAD_BYTES, MAX_SAFE_INTEGER, MAX_SIDE,
};

fn sample() -> FrameHeader {
    FrameHeader {
        codec: Codec::Jpeg,
        converged: true,
        software: false,
        session_epoch: 0x0403_0201,
        frame_id: 7,
        applied_input: 9,
        samples: 64,
        width: 1280,
        height: 720,
        estimated_error: None,
        render_micros: 1234,
        encode_micros: 567,
        payload_length: 3,
    }
}

#[test]
fn layout_is_the_documented_one() {
    let bytes = sample().encode().unwrap();
    assert_eq!(&bytes[0..8], b"TYND\x01\x00\x01\x01");
    assert_eq!(&bytes[8..12], [1, 2, 3, 4], "little-endian");
    assert_eq!(bytes[12..16], 7_u32.to_le_bytes());
    assert_eq!(bytes[16..24], 9_u64.to_le_bytes());
    assert_eq!(bytes[24..28], 64_u32.to_le_bytes());
    assert_eq!(bytes[28..32], 1280_u32.to_le_bytes());
    assert_eq!(bytes[32..36], 720_u32.to_le_bytes());
    assert_eq!(bytes[36..40], (-1.0_f32).to_le_bytes());
    assert_eq!(bytes[40..44], 1234_u32.to_le_bytes());
    assert_eq!(bytes[44..48], 567_u32.to_le_bytes());
    assert_eq!(bytes[48..52], 3_u32.to_le_bytes());
    assert_eq!(bytes[52..64], [0; 12]);
}

/// Changes one byte range of a good header and returns the error.
fn spoilt(at: usize, bytes: &[u8]) -> HeaderError {
    let mut header = sample().encode().unwrap();
    header[at..at + bytes.len()].copy_from_slice(bytes);
    FrameHeader::decode(&header).unwrap_err()
}

#[test]
fn each_wrong_field_has_its_own_error() {
    assert!(matches!(
        FrameHeader::decode(&[0; 63]),
        Err(HeaderError::Truncated { found: 63 })
    ));
    assert_eq!(spoilt(0, b"HTTP"), HeaderError::Magic { found: *b"HTTP" });
    assert_eq!(spoilt(4, &[2, 0]), HeaderError::Version { found: 2 });
    assert_eq!(spoilt(6, &[0]), HeaderError::Codec { found: 0 });
    assert_eq!(spoilt(7, &[0x84]), HeaderError::Flags { found: 0x84 });
    assert_eq!(
        spoilt(28, &[0; 4]),
        HeaderError::Size {
            width: 0,
            height: 720
        }
    );
    assert!(matches!(
        spoilt(36, &f32::NAN.to_le_bytes()),
        HeaderError::EstimatedError { .. }
    ));
    assert!(matches!(
        spoilt(36, &(-0.5_f32).to_le_bytes()),
        HeaderError::EstimatedError { .. }
    ));
    assert_eq!(
        spoilt(16, &[0xff; 8]),
        HeaderError::AppliedInput { found: u64::MAX }
    );
    assert_eq!(
        spoilt(48, &[0xff; 4]),
        HeaderError::PayloadTooLong { found: u32::MAX }
    );
    assert_eq!(spoilt(63, &[1]), HeaderError::Reserved);
}

#[test]
fn payload_must_be_as_long_as_announced() {
    let mut message = sample().encode().unwrap().to_vec();
    message.extend_from_slice(b"abc");
    let (header, payload) = FrameHeader::decode_message(&message).unwrap();
    assert_eq!((header, payload), (sample(), b"abc".as_slice()));
    message.push(b'd');
    let error = FrameHeader::decode_message(&message).unwrap_err();
    assert_eq!(
        error,
        HeaderError::PayloadLength {
            announced: 3,
            found: 4
        }
    );
}

fn any_header() -> impl Strategy<Value = FrameHeader> {
    let flags = (
        prop_oneof![Just(Codec::Jpeg), Just(Codec::Png)],
        any::<(bool, bool)>(),
    );
    let counts = (
        any::<(u32, u32, u32)>(),
        0..=MAX_SAFE_INTEGER,
        0..=MAX_PAYLOAD_BYTES,
    );
    let error = prop_oneof![Just(None), (0.0_f32..f32::MAX).prop_map(Some)];
    let size = (1..=MAX_SIDE, 1..=MAX_SIDE);
    (flags, counts, error, size, any::<(u32, u32)>()).prop_map(
        |((codec, flags), (ids, applied_input, payload_length), estimated_error, size, times)| {
            FrameHeader {
                codec,
                converged: flags.0,
                software: flags.1,
                session_epoch: ids.0,
                frame_id: ids.1,
                applied_input,
                samples: ids.2,
                width: size.0,
                height: size.1,
                estimated_error,
                render_micros: times.0,
                encode_micros: times.1,
                payload_length,
            }
        },
    )
}

proptest! {
    #[test]
    fn whatever_encodes_decodes_to_itself(header in any_header()) {
        let bytes = header.encode().unwrap();
        prop_assert_eq!(FrameHeader::decode(&bytes).unwrap(), header);
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        drop(FrameHeader::decode_message(&bytes));
    }

    #[test]
    fn damaged_headers_decode_to_themselves_or_an_error(
        header in any_header(), at in 0..HEADER_BYTES, value in any::<u8>()
    ) {
        let mut bytes = header.encode().unwrap();
        bytes[at] = value;
        if let Ok(decoded) = FrameHeader::decode(&bytes) {
            prop_assert_eq!(decoded.encode().unwrap(), bytes);
        }
    }
}
