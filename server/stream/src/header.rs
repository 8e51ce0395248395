//! The 64-byte header in front of every binary frame.
//!
//! Fixed little-endian layout so that the page reads it with a `DataView` and no decoder:
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | 4 bytes | magic `TYND` |
//! | 4 | u16 | version, 1 |
//! | 6 | u8 | codec: 1 JPEG, 2 PNG |
//! | 7 | u8 | flags: bit 0 converged, bit 1 software adapter |
//! | 8 | u32 | session epoch |
//! | 12 | u32 | frame id |
//! | 16 | u64 | last applied input |
//! | 24 | u32 | samples per pixel |
//! | 28, 32 | u32 | width, height in pixels |
//! | 36 | f32 | estimated relative error, −1 when unknown |
//! | 40, 44 | u32 | render and encode time in µs |
//! | 48 | u32 | payload length in bytes |
//! | 52 | 12 bytes | reserved, zero |
//!
//! Encoding and decoding check the same rules, so whatever encodes also decodes, and hostile
//! bytes end in a named error.

use serde::{Deserialize, Serialize};
use ts_rs::TS;

/// Length of the header in bytes.
pub const HEADER_BYTES: usize = 64;
/// First four bytes of every frame.
pub const MAGIC: [u8; 4] = *b"TYND";
/// Version this code writes and reads.
pub const HEADER_VERSION: u16 = 1;
/// Largest width or height. Unit: pixel.
pub const MAX_SIDE: u32 = 16_384;
/// Largest payload. Unit: byte. A frame of the largest size as uncompressed RGB fits below it.
pub const MAX_PAYLOAD_BYTES: u32 = 1 << 30;
/// Largest integer that JavaScript's numbers carry exactly: 2⁵³ − 1.
pub const MAX_SAFE_INTEGER: u64 = (1 << 53) - 1;

const FLAG_CONVERGED: u8 = 1;
const FLAG_SOFTWARE: u8 = 2;
const RESERVED_AT: usize = 52;

/// How a frame's payload is compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, TS)]
#[serde(rename_all = "snake_case")]
pub enum Codec {
    /// Baseline JPEG, lossy.
    Jpeg,
    /// 8-bit RGB PNG, lossless.
    Png,
}

impl Codec {
    /// The byte that stands for this codec on the wire.
    pub const fn wire(self) -> u8 {
        match self {
            Self::Jpeg => 1,
            Self::Png => 2,
        }
    }

    const fn from_wire(byte: u8) -> Option<Self> {
        match byte {
            1 => Some(Self::Jpeg),
            2 => Some(Self::Png),
            _ => None,
        }
    }
}

/// What a frame says about itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameHeader {
    /// Compression of the payload.
    pub codec: Codec,
    /// Whether the picture is final until something changes.
    pub converged: bool,
    /// Whether a software adapter rendered it.
    pub software: bool,
    /// Counts the scenes of this session; frames of an older epoch show an older scene.
    pub session_epoch: u32,
    /// Counts the frames of this session, from 1.
    pub frame_id: u32,
    /// Largest input number whose effect the picture shows. Range: at most [`MAX_SAFE_INTEGER`].
    pub applied_input: u64,
    /// Accumulated samples a pixel.
    pub samples: u32,
    /// Unit: pixel. Range: 1 to [`MAX_SIDE`].
    pub width: u32,
    /// Unit: pixel. Range: 1 to [`MAX_SIDE`].
    pub height: u32,
    /// Estimated relative error, finite and ≥ 0; `None` when nothing estimates it.
    pub estimated_error: Option<f32>,
    /// Time the device took. Unit: µs.
    pub render_micros: u32,
    /// Time the encoder took. Unit: µs.
    pub encode_micros: u32,
    /// Length of the payload behind the header. Unit: byte. Range: at most [`MAX_PAYLOAD_BYTES`].
    pub payload_length: u32,
}

/// Why bytes are not a frame, or a header cannot be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HeaderError {
    /// Fewer bytes than a header.
    #[error("frame has {found} bytes, a header needs {HEADER_BYTES}")]
    Truncated {
        /// Bytes given.
        found: usize,
    },
    /// Not one of our frames.
    #[error("frame starts with {found:02x?}, expected \"TYND\"")]
    Magic {
        /// First four bytes.
        found: [u8; 4],
    },
    /// A version this code does not read.
    #[error("frame header version {found}, this side reads {HEADER_VERSION}")]
    Version {
        /// Version given.
        found: u16,
    },
    /// A codec byte without meaning.
    #[error("unknown codec {found}, known are 1 (jpeg) and 2 (png)")]
    Codec {
        /// Byte given.
        found: u8,
    },
    /// Flag bits without meaning.
    #[error("unknown flag bits in {found:#010b}")]
    Flags {
        /// Byte given.
        found: u8,
    },
    /// A size outside the range.
    #[error("frame size {width}x{height}, each side must be 1 to {MAX_SIDE}")]
    Size {
        /// Unit: pixel.
        width: u32,
        /// Unit: pixel.
        height: u32,
    },
    /// An error estimate that is no estimate.
    #[error("estimated error {found}, must be finite and at least 0, or exactly -1 for unknown")]
    EstimatedError {
        /// Value given.
        found: f32,
    },
    /// An input number that JavaScript cannot hold.
    #[error("applied input {found}, at most 2^53 - 1 is allowed")]
    AppliedInput {
        /// Number given.
        found: u64,
    },
    /// Reserved bytes in use.
    #[error("reserved bytes of the header are not zero")]
    Reserved,
    /// A payload above the limit.
    #[error("payload of {found} bytes, at most {MAX_PAYLOAD_BYTES} are allowed")]
    PayloadTooLong {
        /// Bytes announced.
        found: u32,
    },
    /// A payload that is not as long as announced.
    #[error("header announces {announced} payload bytes, the message has {found}")]
    PayloadLength {
        /// Bytes announced.
        announced: u32,
        /// Bytes behind the header.
        found: usize,
    },
}

impl FrameHeader {
    /// Writes the header.
    ///
    /// # Errors
    /// Any value that [`FrameHeader::decode`] would refuse.
    pub fn encode(&self) -> Result<[u8; HEADER_BYTES], HeaderError> {
        self.check()?;
        let flags = if self.converged { FLAG_CONVERGED } else { 0 }
            | if self.software { FLAG_SOFTWARE } else { 0 };
        let mut bytes = [0; HEADER_BYTES];
        bytes[0..4].copy_from_slice(&MAGIC);
        bytes[4..6].copy_from_slice(&HEADER_VERSION.to_le_bytes());
        bytes[6] = self.codec.wire();
        bytes[7] = flags;
        bytes[8..12].copy_from_slice(&self.session_epoch.to_le_bytes());
        bytes[12..16].copy_from_slice(&self.frame_id.to_le_bytes());
        bytes[16..24].copy_from_slice(&self.applied_input.to_le_bytes());
        bytes[24..28].copy_from_slice(&self.samples.to_le_bytes());
        bytes[28..32].copy_from_slice(&self.width.to_le_bytes());
        bytes[32..36].copy_from_slice(&self.height.to_le_bytes());
        let error = self.estimated_error.unwrap_or(-1.0);
        bytes[36..40].copy_from_slice(&error.to_le_bytes());
        bytes[40..44].copy_from_slice(&self.render_micros.to_le_bytes());
        bytes[44..48].copy_from_slice(&self.encode_micros.to_le_bytes());
        bytes[48..52].copy_from_slice(&self.payload_length.to_le_bytes());
        Ok(bytes)
    }

    /// Reads a header from the start of `bytes`; whatever follows is not looked at.
    ///
    /// # Errors
    /// A [`HeaderError`] that names the first field that is wrong.
    pub fn decode(bytes: &[u8]) -> Result<Self, HeaderError> {
        let truncated = HeaderError::Truncated { found: bytes.len() };
        let header: &[u8; HEADER_BYTES] = bytes.first_chunk().ok_or(truncated)?;
        let magic = take(header, 0);
        if magic != MAGIC {
            return Err(HeaderError::Magic { found: magic });
        }
        let version = u16::from_le_bytes(take(header, 4));
        if version != HEADER_VERSION {
            return Err(HeaderError::Version { found: version });
        }
        let [codec_byte, flags] = take(header, 6);
        let codec = Codec::from_wire(codec_byte).ok_or(HeaderError::Codec { found: codec_byte })?;
        if flags & !(FLAG_CONVERGED | FLAG_SOFTWARE) != 0 {
            return Err(HeaderError::Flags { found: flags });
        }
        if header[RESERVED_AT..].iter().any(|&byte| byte != 0) {
            return Err(HeaderError::Reserved);
        }
        let error = f32::from_le_bytes(take(header, 36));
        let decoded = Self {
            codec,
            converged: flags & FLAG_CONVERGED != 0,
            software: flags & FLAG_SOFTWARE != 0,
            session_epoch: u32::from_le_bytes(take(header, 8)),
            frame_id: u32::from_le_bytes(take(header, 12)),
            applied_input: u64::from_le_bytes(take(header, 16)),
            samples: u32::from_le_bytes(take(header, 24)),
            width: u32::from_le_bytes(take(header, 28)),
            height: u32::from_le_bytes(take(header, 32)),
            estimated_error: if error == -1.0 { None } else { Some(error) },
            render_micros: u32::from_le_bytes(take(header, 40)),
            encode_micros: u32::from_le_bytes(take(header, 44)),
            payload_length: u32::from_le_bytes(take(header, 48)),
        };
        decoded.check()?;
        Ok(decoded)
    }

    /// Splits a whole message into header and payload.
    ///
    /// # Errors
    /// As [`FrameHeader::decode`], and when the payload is not exactly as long as announced.
    pub fn decode_message(message: &[u8]) -> Result<(Self, &[u8]), HeaderError> {
        let header = Self::decode(message)?;
        let payload = &message[HEADER_BYTES..];
        if payload.len() != header.payload_length as usize {
            return Err(HeaderError::PayloadLength {
                announced: header.payload_length,
                found: payload.len(),
            });
        }
        Ok((header, payload))
    }

    fn check(&self) -> Result<(), HeaderError> {
        let (width, height) = (self.width, self.height);
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(HeaderError::Size { width, height });
        }
        if let Some(found) = self.estimated_error
            && !(found.is_finite() && found >= 0.0)
        {
            return Err(HeaderError::EstimatedError { found });
        }
        if self.applied_input > MAX_SAFE_INTEGER {
            return Err(HeaderError::AppliedInput {
                found: self.applied_input,
            });
        }
        if self.payload_length > MAX_PAYLOAD_BYTES {
            return Err(HeaderError::PayloadTooLong {
                found: self.payload_length,
            });
        }
        Ok(())
    }
}

/// Copies `N` bytes from offset `at`; every caller stays inside the header.
fn take<const N: usize>(header: &[u8; HEADER_BYTES], at: usize) -> [u8; N] {
    std::array::from_fn(|i| header[at + i])
}
