//! Where the bytes of buffers and images come from: `data:` URIs and files next to the glTF file.

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use tyndall_files::relative::why_not_relative;

use super::file::File;
use crate::error::{SceneError, abbreviate};
use crate::import::importer::Importer;

/// Exporters disagree on padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The bytes behind a URI of the file.
pub(super) fn read(
    file: &File,
    importer: &Importer,
    uri: &str,
    location: &str,
) -> Result<Vec<u8>, SceneError> {
    if uri
        .get(..5)
        .is_some_and(|head| head.eq_ignore_ascii_case("data:"))
    {
        let bytes =
            data(&uri[5..]).map_err(|why| file.refused(location, format!("the data URI {why}")))?;
        importer.folder.spend(&file.path, bytes.len() as u64)?;
        return Ok(bytes);
    }
    let relative = percent_decoded(uri).ok_or_else(|| {
        let shown = abbreviate(uri);
        file.refused(location, format!("\"{shown}\" is not a well-formed URI"))
    })?;
    if let Some(why) = why_not_relative(&relative) {
        let shown = abbreviate(uri);
        let message =
            format!("\"{shown}\", {why}; allowed is a relative path inside the scene's folder");
        return Err(file.refused(location, message));
    }
    let beside = match file.name.rsplit_once('/') {
        Some((folder, _)) => format!("{folder}/{relative}"),
        None => relative,
    };
    importer
        .folder
        .read(&file.path, &beside)
        .map_err(|error| match error {
            SceneError::Io {
                file: name, source, ..
            } => file.refused(location, format!("\"{}\": {source}", abbreviate(&name))),
            SceneError::Invalid { found, allowed, .. } => {
                file.refused(location, format!("found {found}, allowed {allowed}"))
            }
            other => other,
        })
}

/// Decodes what follows `data:`.
fn data(rest: &str) -> Result<Vec<u8>, &'static str> {
    let (head, payload) = rest.split_once(',').ok_or("has no comma")?;
    let is_base64 = head
        .rsplit(';')
        .next()
        .is_some_and(|last| last.eq_ignore_ascii_case("base64"));
    if !is_base64 {
        return Err("is not base64");
    }
    let decode = |text: &str| BASE64.decode(text).ok();
    let bytes = if payload.contains('%') {
        percent_decoded(payload).and_then(|payload| decode(&payload))
    } else {
        decode(payload)
    };
    bytes.ok_or("is not well-formed base64")
}

/// Resolves `%20` and the like; `None` if malformed.
fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        if byte == b'%' {
            let digit = |at: usize| char::from(*tail.get(at)?).to_digit(16);
            bytes.push((digit(0)? * 16 + digit(1)?) as u8);
            rest = &tail[2..];
        } else {
            bytes.push(byte);
            rest = tail;
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_encoding_resolves_and_refuses() {
        assert_eq!(percent_decoded("a%20b").as_deref(), Some("a b"));
        assert_eq!(percent_decoded("%2e%2E/x").as_deref(), Some("../x"));
        for bad in ["%", "%4", "%zz", "%ff"] {
            assert_eq!(percent_decoded(bad), None, "{bad}");
        }
    }

    #[test]
    fn data_uris_decode_with_and_without_padding() {
        let decode = |uri: &str| data(uri).ok();
        assert_eq!(decode(";base64,QUI="), Some(b"AB".to_vec()));
        assert_eq!(decode("image/png;base64,QUI"), Some(b"AB".to_vec()));
        assert_eq!(data("QUI="), Err("has no comma"));
        assert_eq!(data("text/plain,AB"), Err("is not base64"));
        assert_eq!(data(";base64,@@"), Err("is not well-formed base64"));
    }
}
