//! Names of scenes by their content: the first 128 bits of SHA-256.

use sha2::{Digest as _, Sha256};
use tyndall_scene::SceneDescription;

use crate::PictureError;

/// Hash of a description's canonical JSON: keys sorted, no white space. The same for the same
/// description on every machine and in every version that writes the same fields. Files that it
/// refers to count by name, not by content.
///
/// # Errors
/// [`PictureError::Json`] if a number is not finite.
pub fn scene_hash(description: &SceneDescription) -> Result<String, PictureError> {
    let json = |error: &dyn std::fmt::Display| PictureError::Json(error.to_string());
    let text = description.to_json().map_err(|error| json(&error))?;
    let value = serde_json::from_str(&text).map_err(|error| json(&error))?;
    Ok(hash_json(&value))
}

/// Hash of a JSON value in canonical form: 32 hexadecimal digits.
pub fn hash_json(value: &serde_json::Value) -> String {
    let mut text = String::new();
    canonical(value, &mut text);
    hash_bytes(text.as_bytes())
}

/// The first 128 bits of SHA-256 in hexadecimal.
pub fn hash_bytes(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    let digest = Sha256::digest(bytes);
    digest[..16].iter().fold(String::new(), |mut text, byte| {
        // Writing to a string can't fail.
        write!(text, "{byte:02x}").unwrap_or_default();
        text
    })
}

/// `serde_json` keeps keys sorted or in order of insertion, depending on a feature that any crate may
/// turn on: sorted here, so that it makes no difference.
fn canonical(value: &serde_json::Value, out: &mut String) {
    use serde_json::Value;
    match value {
        Value::Object(members) => {
            let mut members: Vec<_> = members.iter().collect();
            members.sort_by_key(|(name, _)| *name);
            out.push('{');
            for (i, (name, value)) in members.into_iter().enumerate() {
                if i > 0 {
                    out.push(',');
                }
                out.push_str(&Value::from(name.as_str()).to_string());
                out.push(':');
                canonical(value, out);
            }
            out.push('}');
        }
        Value::Array(values) => {
            out.push('[');
            for (i, value) in values.iter().enumerate() {
                if i > 0 {
                    out.push(',');
                }
                canonical(value, out);
            }
            out.push(']');
        }
        other => out.push_str(&other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_keys_makes_no_difference() {
        let parse = |text| serde_json::from_str::<serde_json::Value>(text).unwrap();
        let one = hash_json(&parse("{\"a\": [1, 2], \"b\": {\"c\": 0.5, \"d\": null}}"));
        let two = hash_json(&parse("{\"b\":{\"d\":null,\"c\":0.5},\"a\":[1,2]}"));
        assert_eq!(one, two);
        assert_eq!(one.len(), 32);
        assert_ne!(one, hash_json(&parse("{\"a\": [2, 1]}")));
    }

    #[test]
    fn the_hash_is_sha_256() {
        assert_eq!(hash_bytes(b"abc"), "ba7816bf8f01cfea414140de5dae2223");
    }

    #[test]
    fn a_scene_changes_its_hash_with_any_number() {
        let mut description = tyndall_scene::presets::description("cornell_fog").unwrap();
        let before = scene_hash(&description).unwrap();
        assert_eq!(before, scene_hash(&description.clone()).unwrap());
        description.render.seed += 1;
        assert_ne!(before, scene_hash(&description).unwrap());
    }
}
