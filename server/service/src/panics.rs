//! What a panic said, for errors and logs.

use std::any::Any;

/// Longest part that is shown. Unit: character.
const SHOWN: usize = 200;

/// The message of a panic on one line, cut short.
pub(crate) fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message");
    let one_line = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    one_line.take(SHOWN).collect()
}
