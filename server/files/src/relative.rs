//! Names of files that strangers chose: plain relative paths and nothing else.

/// Why `file` is no plain relative path that stays in its folder, if so.
pub fn why_not_relative(file: &str) -> Option<&'static str> {
    if file.is_empty() {
        return Some("which is empty");
    }
    if file.chars().any(char::is_control) {
        return Some("which has a control character");
    }
    if file.starts_with('/') || file.starts_with('\\') {
        return Some("which is absolute");
    }
    // A colon starts a URI scheme, a drive or an alternate stream; a backslash hides separators.
    if file.contains(':') {
        return Some("which has a scheme or a drive");
    }
    if file.contains('\\') {
        return Some("which has a backslash");
    }
    if file.split('/').any(|part| part == "..") {
        return Some("which leaves the folder by '..'");
    }
    None
}
