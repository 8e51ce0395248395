//! Reads any text as a message of a client.

#![no_main]

use libfuzzer_sys::fuzz_target;
use tyndall_stream::protocol::ClientMessage;

fuzz_target!(|text: &str| {
    if let Err(error) = ClientMessage::from_json(text) {
        assert!(!error.to_string().is_empty());
    }
});
