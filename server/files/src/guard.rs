//! The one place where decoders that others wrote are run: on a thread of their own, whose panic
//! becomes an error and whose stack is not the caller's.

use std::any::Any;
use std::sync::Once;
use std::thread::Builder;

/// Name of the threads that decode; panics there are reported by the error alone.
const THREAD: &str = "decoder";
/// Stack of a decoder: several times what any of them uses. Unit: byte.
const STACK: usize = 8 << 20;
/// Longest part of a panic's message that an error shows. Unit: character.
const SHOWN: usize = 200;

/// A decoder gave up in a way that is a fault of its own.
#[derive(Debug, thiserror::Error)]
#[error("the decoder of {decoder} failed on this file: {message}")]
pub struct DecoderFailed {
    /// What it decodes.
    pub decoder: &'static str,
    /// Its last words, or why it could not be started.
    pub message: String,
}

/// Runs a decoder and waits for it.
///
/// # Errors
/// [`DecoderFailed`] if it panics, or if the system gives no thread.
pub fn guarded<T: Send>(
    decoder: &'static str,
    decode: impl FnOnce() -> T + Send,
) -> Result<T, DecoderFailed> {
    keep_decoders_quiet();
    let failed = |message: String| DecoderFailed { decoder, message };
    std::thread::scope(|scope| {
        let thread = Builder::new().name(THREAD.to_owned()).stack_size(STACK);
        let started = thread
            .spawn_scoped(scope, decode)
            .map_err(|error| failed(format!("no thread could be started: {error}")))?;
        started
            .join()
            .map_err(|panic| failed(words(panic.as_ref())))
    })
}

/// The message of a panic on one line, cut short.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("it panicked");
    let one_line = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    one_line.take(SHOWN).collect()
}

/// Leaves the report of a decoder's panic to the error, once for this process; every other panic is
/// reported as before.
fn keep_decoders_quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if std::thread::current().name() != Some(THREAD) {
                before(info);
            }
        }));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_that_names_the_decoder() {
        let fine = guarded("numbers", || 7);
        assert_eq!(fine.unwrap(), 7);
        let error = guarded("numbers", || -> u32 { panic!("no such\nnumber") });
        assert_eq!(
            error.unwrap_err().to_string(),
            "the decoder of numbers failed on this file: no such number"
        );
    }
}
