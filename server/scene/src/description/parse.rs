//! JSON text to types, with errors that name the path, what was found and what is allowed.

use serde::de::DeserializeOwned;

use crate::error::{SceneError, abbreviate};

/// Parses JSON text.
///
/// # Errors
/// [`SceneError::Syntax`] if the text is not JSON, [`SceneError::Invalid`] with the exact path if
/// a value has the wrong type, is missing or unknown.
pub fn parse_json<T: DeserializeOwned>(text: &str) -> Result<T, SceneError> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let path = error.path().to_string();
        from_serde(&path, error.inner())
    })?;
    deserializer.end().map_err(|error| from_serde("", &error))?;
    Ok(value)
}

/// Reads JSON that is parsed already, with the errors of [`parse_json`].
///
/// # Errors
/// [`SceneError::Invalid`] with the exact path if a value has the wrong type, is missing or unknown.
pub fn parse_value<T: DeserializeOwned>(value: serde_json::Value) -> Result<T, SceneError> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let path = error.path().to_string();
        from_serde(&path, error.inner())
    })
}

/// Turns serde's error at `path` into ours.
fn from_serde(path: &str, error: &serde_json::Error) -> SceneError {
    let (line, column) = (error.line(), error.column());
    let text = error.to_string();
    let position = format!(" at line {line} column {column}");
    let message = text.strip_suffix(&position).unwrap_or(&text);
    // serde_json reports a number beyond f64 as a data error without a path of its own.
    if error.classify() == serde_json::error::Category::Data {
        let Located {
            path,
            found,
            allowed,
        } = located(path, message);
        return SceneError::invalid(path, found, allowed);
    }
    SceneError::Syntax {
        line,
        column,
        message: message.to_owned(),
    }
}

/// A parse error taken apart.
#[derive(Debug, PartialEq)]
pub(super) struct Located {
    pub(super) path: String,
    pub(super) found: String,
    pub(super) allowed: String,
}

/// Writes a parse error so that [`located`] finds it again one level further out.
pub(super) fn located_message(error: &Located) -> String {
    let Located {
        path,
        found,
        allowed,
    } = error;
    format!("at `{path}`: found {found}, allowed {allowed}")
}

/// Takes serde's message at `path` apart.
pub(super) fn located(path: &str, message: &str) -> Located {
    let outer = if path == "." { "" } else { path };
    let (inner, message) = message
        .strip_prefix("at `")
        .and_then(|rest| rest.split_once("`: "))
        .unwrap_or(("", message));
    let path = join(outer, inner);
    let in_ticks = |prefix: &str| {
        message
            .strip_prefix(prefix)
            .and_then(|rest| rest.split_once('`'))
    };
    if let Some((name, rest)) = in_ticks("unknown field `") {
        let allowed = rest.strip_prefix(", expected ").unwrap_or("no such member");
        // The path may already end in the unknown name.
        let path = if last_name(&path) == name {
            path
        } else {
            join(&path, name)
        };
        return Located {
            path,
            found: format!("unknown member `{}`", abbreviate(name)),
            allowed: allowed.replace('`', ""),
        };
    }
    if let Some((name, _)) = in_ticks("missing field `") {
        return Located {
            path: join(&path, name),
            found: "nothing".to_owned(),
            allowed: "a value, which is required".to_owned(),
        };
    }
    if let Some((name, _)) = in_ticks("duplicate field `") {
        return Located {
            path: join(&path, name),
            found: "the member twice".to_owned(),
            allowed: "it once".to_owned(),
        };
    }
    if let Some((name, rest)) = in_ticks("unknown variant `") {
        let allowed = rest.strip_prefix(", expected ").unwrap_or("another value");
        return Located {
            path,
            found: format!("\"{}\"", abbreviate(name)),
            allowed: allowed.replace('`', ""),
        };
    }
    let taken_apart = message
        .strip_prefix("found ")
        .and_then(|rest| rest.split_once(", allowed "))
        .or_else(|| {
            ["invalid type: ", "invalid value: ", "invalid "]
                .iter()
                .find_map(|prefix| message.strip_prefix(prefix))
                .and_then(|rest| rest.rsplit_once(", expected "))
        });
    match taken_apart {
        Some((found, allowed)) => Located {
            path,
            found: abbreviate(found),
            allowed: in_words(allowed),
        },
        None => Located {
            path,
            found: abbreviate(message),
            allowed: "a value of the documented type".to_owned(),
        },
    }
}

/// Serde's names of types in words.
fn in_words(expected: &str) -> String {
    match expected {
        "f64" | "f32" => "a number",
        "u32" | "u64" | "usize" => "a whole number, at least 0",
        "an array of length 3" => "three numbers",
        "an array of length 2" => "two numbers",
        "a boolean" => "true or false",
        "a sequence" => "an array",
        other if other.starts_with("struct ") => "an object",
        other => other,
    }
    .to_owned()
}

/// Appends an inner path to an outer one.
fn join(outer: &str, inner: &str) -> String {
    match (outer, inner) {
        ("", path) | (path, "") => path.to_owned(),
        (outer, inner) if inner.starts_with('[') => format!("{outer}{inner}"),
        (outer, inner) => format!("{outer}.{inner}"),
    }
}

/// The last member name of a path.
fn last_name(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}
