//! The conventions of `CONTRIBUTING.md` that a program can check.
//!
//! `source` lists the repository's files and blanks what is not code, `text` holds the checks that
//! look at one file, `layers`, `layout`, `imports`, `recipes` and `test_files` those that look across files. Every
//! check is a pure function from
//! files to [`Finding`]s, so that the tests can plant a violation and see it found.

pub mod imports;
pub mod layers;
pub mod layout;
pub mod recipes;
pub mod source;
pub mod test_files;
pub mod text;

use std::fmt;

/// One violation: where it is and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Path from the repository's root, with `/`.
    pub path: String,
    /// Line, from 1; 0 when the finding is about the whole file.
    pub line: usize,
    /// What is wrong and what is wanted instead.
    pub message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}:{}: {}", self.path, self.line, self.message)
    }
}

/// Fails with the list of findings if there are any.
///
/// # Panics
/// If there are any.
pub fn assert_none(findings: &[Finding]) {
    let list: Vec<String> = findings.iter().map(ToString::to_string).collect();
    assert!(
        list.is_empty(),
        "{} findings:\n{}",
        list.len(),
        list.join("\n")
    );
}
