//! `BloscLZ`, the codec that blosc brings along: literal runs and matches within a window.
//!
//! A control byte below 32 is followed by that many literals and one. Any other starts a match: its
//! upper three bits are the length less 2, which further bytes lengthen when all three are set; its
//! lower five and one more byte are the distance less 1, and if all thirteen are set, two more
//! bytes, high first, come on top.

/// Distance at which the long form begins.
const FAR: usize = 8191;

/// Unpacks into `output`; how many bytes it filled, or `None` where the stream is broken.
pub(super) fn decompress(input: &[u8], output: &mut [u8]) -> Option<usize> {
    let mut input = input.iter().copied();
    let mut control = usize::from(input.next()?) & 31;
    let mut filled = 0;
    loop {
        if control < 32 {
            let end = filled + control + 1;
            for slot in output.get_mut(filled..end)? {
                *slot = input.next()?;
            }
            filled = end;
        } else {
            let mut length = (control >> 5) - 1;
            if length == 6 {
                loop {
                    let more = input.next()?;
                    length += usize::from(more);
                    if more != 255 {
                        break;
                    }
                }
            }
            length += 3;
            let high = control & 31;
            let low = usize::from(input.next()?);
            let mut distance = (high << 8) + low + 1;
            if high == 31 && low == 255 {
                let further = usize::from(input.next()?) << 8;
                distance = FAR + 1 + further + usize::from(input.next()?);
            }
            let start = filled.checked_sub(distance)?;
            let end = filled + length;
            if end > output.len() {
                return None;
            }
            for step in 0..length {
                output[filled + step] = output[start + step];
            }
            filled = end;
        }
        match input.next() {
            Some(next) => control = usize::from(next),
            None => return Some(filled),
        }
    }
}
