//! Ten thousand changed messages of clients: each is understood or refused with its reason, and soon.

use std::time::Duration;

use serde_json::json;
use tyndall_mutations::{Kind, attack};
use tyndall_stream::protocol::ClientMessage;

const SOON: Duration = Duration::from_millis(500);

#[test]
fn changed_messages_are_harmless() {
    let messages = [
        json!({"type": "hello", "protocol": 1, "accept": ["jpeg", "png"], "width": 96, "height": 64,
            "resume": "0123456789abcdef0123456789abcdef"}),
        json!({"type": "camera", "input": 9, "camera": {"position": [1.5, 0, 5], "target": [0, 0, 0],
            "up": [0, 1, 0], "vertical_fov_degrees": 50}}),
        json!({"type": "edit", "input": 3, "edit": {
            "lights": [{"kind": "point", "position": [0, 3, 0], "intensity": [1, 2, 3]}],
            "media": [{"kind": "height_fog", "sigma_t": 0.2, "albedo": 0.9, "falloff": 0.5}],
            "render": {"technique": "single_scattering", "samples": 4}}}),
        json!({"type": "open_preset", "input": 4, "name": "cloud"}),
        json!({"type": "resize", "input": 5, "width": 640, "height": 360}),
        json!({"type": "ack", "frame": 17}),
        json!({"type": "visible", "visible": false}),
    ];
    let seeds = messages.map(|message| message.to_string().into_bytes());
    attack("message", &seeds, Kind::Text, SOON, |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else {
            return false;
        };
        match ClientMessage::from_json(text) {
            Ok(_) => true,
            Err(error) => {
                assert!(!error.to_string().is_empty());
                false
            }
        }
    });
}
