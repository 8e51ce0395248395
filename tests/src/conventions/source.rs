//! The repository's files, and their text with everything that is not code blanked.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folders that a walk without git leaves out: built or downloaded, never written by hand.
const GENERATED_FOLDERS: [&str; 5] = [".git", "target", "node_modules", "dist", "artefacts"];

/// A text file of the repository.
#[derive(Debug, Clone)]
pub struct Source {
    /// Path from the repository's root, with `/`.
    pub path: String,
    /// The file as it is.
    pub text: String,
    /// The same with comments, strings and character literals replaced by spaces. Line breaks
    /// stay, so lines have the same numbers. Equal to `text` unless the file is Rust or WESL.
    pub code: String,
}

impl Source {
    /// A file that need not exist: the way tests plant a violation.
    pub fn new(path: &str, text: &str) -> Self {
        let code = match extension(path) {
            "rs" => blank(text, Literals::Rust),
            "wesl" | "wgsl" => blank(text, Literals::None),
            _ => text.to_owned(),
        };
        Self {
            path: path.to_owned(),
            text: text.to_owned(),
            code,
        }
    }

    /// The part of the name after its last dot; empty without one.
    pub fn extension(&self) -> &str {
        extension(&self.path)
    }

    /// Whether a program writes this file: its name says so.
    pub fn is_generated(&self) -> bool {
        let name = self.path.rsplit('/').next().unwrap_or_default();
        name.contains(".gen.")
            || name == "package-lock.json"
            || matches!(self.extension(), "snap" | "lock")
    }

    /// The line, from 1, of a byte offset in `code`.
    pub fn line_of(&self, offset: usize) -> usize {
        1 + self.code[..offset].matches('\n').count()
    }
}

fn extension(path: &str) -> &str {
    let name = path.rsplit('/').next().unwrap_or_default();
    name.rsplit_once('.').map_or("", |(_, extension)| extension)
}

/// The repository's root: the folder above this crate's.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .map(Path::to_path_buf)
        .unwrap_or_default()
}

/// Paths of the repository's files: those that git tracks or would track; a walk without git.
pub fn paths(root: &Path) -> io::Result<Vec<String>> {
    let git = Command::new("git")
        .args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ])
        .current_dir(root)
        .output();
    let mut paths = match git {
        Ok(output) if output.status.success() => String::from_utf8_lossy(&output.stdout)
            .split_terminator('\0')
            .map(ToOwned::to_owned)
            // Deleted, but still in git's index.
            .filter(|path| root.join(path).is_file())
            .collect(),
        _ => {
            let mut found = Vec::new();
            walk(root, root, &mut found)?;
            found
        }
    };
    paths.sort_unstable();
    paths.dedup();
    Ok(paths)
}

fn walk(root: &Path, folder: &Path, found: &mut Vec<String>) -> io::Result<()> {
    for entry in folder.read_dir()? {
        let entry = entry?;
        let path = entry.path();
        if entry.file_type()?.is_dir() {
            let name = entry.file_name();
            if !GENERATED_FOLDERS.iter().any(|generated| name == *generated) {
                walk(root, &path, found)?;
            }
        } else if let Ok(relative) = path.strip_prefix(root) {
            found.push(relative.to_string_lossy().replace('\\', "/"));
        }
    }
    Ok(())
}

/// Every text file of the repository; files that are not UTF-8 are pictures and models.
pub fn sources(root: &Path) -> io::Result<Vec<Source>> {
    let mut sources = Vec::new();
    for path in paths(root)? {
        if let Ok(text) = String::from_utf8(std::fs::read(root.join(&path))?) {
            sources.push(Source::new(&path, &text));
        }
    }
    Ok(sources)
}

/// Which literals hide text from the checks.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Literals {
    /// WESL has neither strings nor characters.
    None,
    /// Strings (plain and raw) and character literals.
    Rust,
}

/// Replaces comments and literals by spaces, byte by byte, keeping line breaks.
fn blank(text: &str, literals: Literals) -> String {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let length = hidden_length(bytes, at, literals);
        if length == 0 {
            out.push(bytes[at]);
            at += 1;
        } else {
            let end = (at + length).min(bytes.len());
            out.extend(
                bytes[at..end]
                    .iter()
                    .map(|byte| if *byte == b'\n' { b'\n' } else { b' ' }),
            );
            at = end;
        }
    }
    // Only whole literals and comments were replaced, so what is left is still UTF-8.
    String::from_utf8_lossy(&out).into_owned()
}

/// Length of the comment or literal that starts here; 0 if none does.
fn hidden_length(bytes: &[u8], at: usize, literals: Literals) -> usize {
    let rest = &bytes[at..];
    if rest.starts_with(b"//") {
        return rest
            .iter()
            .position(|byte| *byte == b'\n')
            .unwrap_or(rest.len());
    }
    if rest.starts_with(b"/*") {
        return block_comment_length(rest);
    }
    if literals == Literals::None {
        return 0;
    }
    let after_name = at > 0 && (bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_');
    match rest[0] {
        b'"' => quoted_length(rest, b'"'),
        b'r' if !after_name || bytes[at - 1] == b'b' => raw_string_length(rest),
        // A lifetime has no closing quote within the next character.
        b'\'' if rest.get(1) == Some(&b'\\') => quoted_length(rest, b'\''),
        b'\'' => character_length(rest),
        _ => 0,
    }
}

fn block_comment_length(rest: &[u8]) -> usize {
    let mut depth = 0_usize;
    let mut at = 0;
    while at < rest.len() {
        if rest[at..].starts_with(b"/*") {
            depth += 1;
            at += 2;
        } else if rest[at..].starts_with(b"*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += 1;
        }
    }
    rest.len()
}

fn quoted_length(rest: &[u8], quote: u8) -> usize {
    let mut at = 1;
    while at < rest.len() {
        match rest[at] {
            b'\\' => at += 2,
            byte if byte == quote => return at + 1,
            _ => at += 1,
        }
    }
    rest.len()
}

fn raw_string_length(rest: &[u8]) -> usize {
    let hashes = rest[1..].iter().take_while(|byte| **byte == b'#').count();
    if rest.get(1 + hashes) != Some(&b'"') {
        return 0;
    }
    let mut close = vec![b'"'];
    close.resize(1 + hashes, b'#');
    let body = &rest[2 + hashes..];
    body.windows(close.len())
        .position(|window| window == close)
        .map_or(rest.len(), |position| 2 + hashes + position + close.len())
}

fn character_length(rest: &[u8]) -> usize {
    let text = String::from_utf8_lossy(&rest[1..rest.len().min(8)]);
    let Some(first) = text.chars().next() else {
        return 0;
    };
    let after = 1 + first.len_utf8();
    if rest.get(after) == Some(&b'\'') {
        after + 1
    } else {
        0
    }
}
