//! Checks that look at one file: numerics, sizes, heads, addresses.

use std::sync::LazyLock;

use regex::Regex;

use super::Finding;
use super::source::Source;

/// A comment with one of these and a reason, on the line or the one above, permits the line.
const ALLOW_ONE_MINUS_EXP: &str = "// allow-one-minus-exp: ";
const ALLOW_FLOAT_BITS: &str = "// allow-float-bits: ";

/// A pattern of this module: written here, tested here, so it always compiles.
macro_rules! pattern {
    ($($part:expr),+ $(,)?) => {
        LazyLock::new(|| {
            Regex::new(&[$($part),+].concat()).expect("the pattern is a constant that tests cover")
        })
    };
}

/// The number one as Rust and WESL spell it, scalar or vector.
const ONE: &str = r"(?:\b1(?:\.0*)?(?:_?f(?:16|32|64)|[fh])?|\b(?:\w+::)*ONE|\b(?:vec[234](?:[fhd]|<\s*\w+\s*>)?|(?:\w+::)+splat)\(\s*1(?:\.0*)?(?:_?f(?:16|32|64)|[fh])?\s*\))";
/// The name of an exponential as a function; the shaders' transmittance is one too.
const EXP: &str = r"\b(?:\w+(?:::<\w+>)?::)*(?:exp2?f?|transmittance_of)";

static ONE_MINUS: LazyLock<Regex> = pattern!(r"(?:^|[^\w.])", ONE, r"\s*-\s*");
static EXP_CALL: LazyLock<Regex> = pattern!(r"^", EXP, r"\s*\(");
static EXP_METHOD: LazyLock<Regex> = pattern!(r"\.\s*(?:exp2?\s*\(\s*\)|map\(\s*", EXP, r"\s*\))");
static MINUS_EXP: LazyLock<Regex> = pattern!(r"-\s*", EXP, r"\s*\(");
static PLUS_ONE: LazyLock<Regex> = pattern!(r"^\s*\+\s*", ONE, r"(?:[^\w.]|$)");
static EXP_TIMES_MINUS_ONE: LazyLock<Regex> =
    pattern!(r"\.\s*exp2?\s*\(\s*\)\s*\.\s*mul_add\(\s*-\s*1");

/// 1 − e^(−x) loses every digit for small x; in any spelling of Rust or WESL.
pub fn one_minus_exp(source: &Source) -> Vec<Finding> {
    if !matches!(source.extension(), "rs" | "wesl") {
        return Vec::new();
    }
    let code = source.code.as_str();
    let mut offsets: Vec<usize> = Vec::new();
    for found in ONE_MINUS.find_iter(code) {
        if is_exponential(factor(&code[found.end()..])) {
            offsets.push(found.end());
        }
    }
    for found in MINUS_EXP.find_iter(code) {
        let inside = found.end() - 1;
        if let Some(length) = parenthesis_length(&code[inside..])
            && PLUS_ONE.is_match(&code[inside + length..])
        {
            offsets.push(found.start());
        }
    }
    offsets.extend(
        EXP_TIMES_MINUS_ONE
            .find_iter(code)
            .map(|found| found.start()),
    );
    offsets
        .into_iter()
        .map(|offset| source.line_of(offset))
        .filter(|line| !is_allowed(source, *line, ALLOW_ONE_MINUS_EXP))
        .map(|line| Finding {
            path: source.path.clone(),
            line,
            message: "1 - exp(-x) cancels for small x: use one_minus_exp_neg (WESL) or -(-x).exp_m1() (Rust)".to_owned(),
        })
        .collect()
}

/// The first factor of an expression: up to an operator, a comma or the end of its parenthesis.
fn factor(text: &str) -> &str {
    let mut depth = 0_usize;
    for (at, character) in text.char_indices() {
        match character {
            '(' | '[' => depth += 1,
            ')' | ']' if depth > 0 => depth -= 1,
            ')' | ']' | ',' | ';' | '{' | '}' if depth == 0 => return &text[..at],
            // An operator ends the factor unless it is the sign in front of it.
            '+' | '-' | '*' | '/' | '<' | '>' | '=' | '&' | '|'
                if depth == 0 && !text[..at].trim().is_empty() =>
            {
                return &text[..at];
            }
            _ => {}
        }
    }
    text
}

/// Whether a factor is an exponential: `exp(..)`, `f32::exp(..)`, `(..).exp()`, or one in brackets.
fn is_exponential(factor: &str) -> bool {
    let factor = factor.trim();
    if EXP_CALL.is_match(factor) {
        return true;
    }
    if let Some(length) = parenthesis_length(factor)
        && length == factor.len()
    {
        return is_exponential(&factor[1..length - 1]);
    }
    // Only a method at the outermost level makes the whole factor an exponential.
    let mut outer = String::new();
    let mut depth = 0_usize;
    for character in factor.chars() {
        match character {
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 || (depth == 1 && character == '(') {
            outer.push(character);
        }
    }
    EXP_METHOD.is_match(&outer) || EXP_METHOD.is_match(factor) && factor.contains(".map(")
}

/// Length of the parenthesis that the text starts with, both brackets included.
fn parenthesis_length(text: &str) -> Option<usize> {
    if !text.starts_with('(') {
        return None;
    }
    let mut depth = 0_usize;
    for (at, character) in text.char_indices() {
        match character {
            '(' => depth += 1,
            ')' => {
                depth -= 1;
                if depth == 0 {
                    return Some(at + 1);
                }
            }
            _ => {}
        }
    }
    None
}

/// Whether the line, or the one above, carries the exception with a reason worth the name.
fn is_allowed(source: &Source, line: usize, marker: &str) -> bool {
    let first = line.saturating_sub(2);
    source
        .text
        .lines()
        .skip(first)
        .take(line - first)
        .any(|text| {
            text.split_once(marker)
                .is_some_and(|(_, reason)| reason.trim().len() >= 10)
        })
}

/// Files are short, so that each holds one idea: Rust and scripts 500 lines, WESL 250.
pub fn file_size(source: &Source) -> Vec<Finding> {
    let cap = match source.extension() {
        "rs" | "ts" | "mjs" | "js" | "sh" => 500,
        "wesl" => 250,
        _ => return Vec::new(),
    };
    let lines = source.text.lines().count();
    if lines <= cap || source.is_generated() {
        return Vec::new();
    }
    vec![Finding {
        path: source.path.clone(),
        line: 0,
        message: format!("{lines} lines, at most {cap}: split it by responsibility"),
    }]
}

static UNFINISHED: LazyLock<Regex> = pattern!(r"\b(?:TO", r"DO|FIX", r"ME)\b");

/// Work that is left goes into an issue, not into a comment.
pub fn unfinished_work(source: &Source) -> Vec<Finding> {
    if !matches!(
        source.extension(),
        "rs" | "wesl" | "ts" | "mjs" | "js" | "css" | "html" | "sh" | "toml"
    ) {
        return Vec::new();
    }
    matches_in(
        source,
        &source.text,
        &UNFINISHED,
        "left-over work: finish it or file an issue",
    )
}

static BARE_NORMALIZE: LazyLock<Regex> = pattern!(r"\bnormalize\s*\(");

/// `normalize` of a zero vector is undefined in WGSL.
pub fn bare_normalize(source: &Source) -> Vec<Finding> {
    if source.extension() != "wesl" {
        return Vec::new();
    }
    matches_in(
        source,
        &source.code,
        &BARE_NORMALIZE,
        "use safe_normalize of numeric.wesl",
    )
}

static SENTINEL: LazyLock<Regex> = pattern!(
    r"(?i)\b0x[7f]f[89a-f]0*u?\b|",
    r"\b\d+(?:\.\d*)?e\+?(?:39|[4-9]\d|\d{3,})f?\b|",
    r"[\w)\]]\s*/\s*0+(?:\.0*)?f?(?:[^\w.]|$)|",
    r"\b(?:isnan|isinf)\s*\(",
);

/// WGSL may assume that no value is infinite or NaN, so neither may carry a meaning.
pub fn sentinel(source: &Source) -> Vec<Finding> {
    if source.extension() != "wesl" {
        return Vec::new();
    }
    let mut findings = matches_in(
        source,
        &source.code,
        &SENTINEL,
        "no infinity or NaN as a value: use a flag, a finite bound, or is_finite of numeric.wesl",
    );
    findings.retain(|finding| !is_allowed(source, finding.line, ALLOW_FLOAT_BITS));
    findings
}

/// Every file begins by saying what it is and why.
pub fn head_comment(source: &Source) -> Vec<Finding> {
    let first = source
        .text
        .lines()
        .find(|line| !line.trim().is_empty())
        .unwrap_or_default();
    let (is_head, wanted) = match source.extension() {
        "rs" => (first.starts_with("//!"), "//!"),
        "wesl" => (first.starts_with("//"), "//"),
        "ts" | "mjs" => (
            first.starts_with("//") || first.starts_with("/*"),
            "// or /**",
        ),
        "sh" => (first.starts_with('#'), "#"),
        _ => return Vec::new(),
    };
    // A test file of the page is called after what it tests.
    if is_head || source.is_generated() || source.path.contains(".test.") {
        return Vec::new();
    }
    vec![Finding {
        path: source.path.clone(),
        line: 1,
        message: format!("starts without a head ({wanted}) that says what the file is and why"),
    }]
}

/// Addresses that bind the repository to one machine or one mirror. Joined from parts, so that
/// this file does not find itself.
static ADDRESS: LazyLock<Regex> = pattern!(
    r"(?i)\b(?:index|static)\.crates",
    r"\.io\b|\bregistry\.(?:npmjs|yarnpkg)",
    r"\.(?:org|com)\b|",
    r"\bpypi",
    r"\.org\b|\bpythonhosted",
    r"\.org\b|",
    r"\b(?:deb|security|snapshot|ftp)\.debian",
    r"\.org\b|\b(?:archive|ports|security)\.ubuntu",
    r"\.com\b|",
    r#"(?:^|[\s"'`=(:\[])/wo"#,
    r#"rk/|(?:^|[\s"'`=(:\[])/tmp/ba"#,
    "sh",
);

/// Registry hosts and paths of one machine stay out of the repository.
pub fn local_address(source: &Source) -> Vec<Finding> {
    matches_in(
        source,
        &source.text,
        &ADDRESS,
        "names a registry host or a path of one machine: derive it at run time",
    )
}

/// Every crate takes the workspace's lints.
pub fn crate_lints(source: &Source) -> Vec<Finding> {
    if !source.path.ends_with("/Cargo.toml") {
        return Vec::new();
    }
    let mut lines = source.text.lines().map(str::trim);
    let has_lints = lines.by_ref().any(|line| line == "[lints]")
        && lines.next().is_some_and(|line| line == "workspace = true");
    if has_lints {
        return Vec::new();
    }
    vec![Finding {
        path: source.path.clone(),
        line: 0,
        message: "lacks `[lints] workspace = true`".to_owned(),
    }]
}

fn matches_in(source: &Source, text: &str, pattern: &Regex, message: &str) -> Vec<Finding> {
    text.lines()
        .enumerate()
        .filter_map(|(index, line)| {
            let found = pattern.find(line)?;
            Some(Finding {
                path: source.path.clone(),
                line: index + 1,
                message: format!("`{}`: {message}", found.as_str().trim()),
            })
        })
        .collect()
}
