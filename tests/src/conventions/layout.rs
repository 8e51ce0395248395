//! Checks that look across files: techniques and their names, documents and what they point at.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use regex::Regex;

use super::Finding;
use super::source::Source;

/// Where a technique's Rust lives.
const RUST_TECHNIQUES: &str = "server/render/src/techniques/";
/// Where a technique's shaders live.
const WESL_TECHNIQUES: &str = "shaders/wesl/techniques/";

/// A pattern of this module: written here, tested here, so it always compiles.
macro_rules! pattern {
    ($text:expr) => {
        LazyLock::new(|| Regex::new($text).expect("the pattern is a constant that tests cover"))
    };
}

/// Names of the techniques that have Rust, and of those that have shaders: each is a folder.
pub fn technique_names(paths: &[&str]) -> (BTreeSet<String>, BTreeSet<String>) {
    let first_part = |path: &str, folder: &str| {
        let rest = path.strip_prefix(folder)?;
        let (name, _file) = rest.split_once('/')?;
        Some(name.to_owned())
    };
    let rust = paths
        .iter()
        .filter_map(|path| first_part(path, RUST_TECHNIQUES))
        .collect();
    let wesl = paths
        .iter()
        .filter_map(|path| first_part(path, WESL_TECHNIQUES))
        .collect();
    (rust, wesl)
}

/// A technique has one name: its Rust folder and its shader folder are called the same. One that is made of
/// stages alone has no shaders.
pub fn technique_pairs(paths: &[&str]) -> Vec<Finding> {
    let (rust, wesl) = technique_names(paths);
    wesl.difference(&rust)
        .map(|name| Finding {
            path: format!("{WESL_TECHNIQUES}{name}"),
            line: 0,
            message: format!("technique `{name}` has no counterpart in {RUST_TECHNIQUES}"),
        })
        .collect()
}

static PATH_STEP: LazyLock<Regex> =
    pattern!(r"\b(?:(?:techniques|super)\s*::\s*)+(?:(\w+)|\{([^}]*)\})");
static WORD: LazyLock<Regex> = pattern!(r"\w+");

/// Techniques never import one another; what two of them need lives outside both.
pub fn technique_imports(source: &Source, techniques: &BTreeSet<String>) -> Vec<Finding> {
    let Some(own) = own_technique(&source.path) else {
        return Vec::new();
    };
    PATH_STEP
        .captures_iter(&source.code)
        .flat_map(|capture| {
            let names = capture.get(1).or_else(|| capture.get(2));
            names.into_iter().flat_map(|names| {
                WORD.find_iter(names.as_str())
                    .map(|word| (names.start() + word.start(), word.as_str()))
                    .collect::<Vec<_>>()
            })
        })
        .filter(|(_, name)| *name != own && techniques.contains(*name))
        .map(|(offset, name)| Finding {
            path: source.path.clone(),
            line: source.line_of(offset),
            message: format!(
                "technique `{own}` imports technique `{name}`: move what both need out"
            ),
        })
        .collect()
}

fn own_technique(path: &str) -> Option<&str> {
    let rest = path
        .strip_prefix(RUST_TECHNIQUES)
        .or_else(|| path.strip_prefix(WESL_TECHNIQUES))?;
    let name = rest.split('/').next()?;
    let name = name.strip_suffix(".rs").unwrap_or(name);
    (name != "mod").then_some(name)
}

static CODE_SPAN: LazyLock<Regex> = pattern!(r"`([^`\n]+)`");
static LINK: LazyLock<Regex> = pattern!(r"\]\(([^)\s#]+)(?:#[^)]*)?\)");
static FILE_NAME: LazyLock<Regex> = pattern!(r"^(?:[\w.-]+/)+(?:[\w.-]+\.\w+)?$");

/// Each heading below the title of a map names a file or folder, and that exists.
pub fn heading_paths(document: &Source, paths: &[&str]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (index, line) in outside_fences(&document.text) {
        if !line.starts_with("## ") && !line.starts_with("### ") {
            continue;
        }
        let mut spans = CODE_SPAN.captures_iter(line).peekable();
        let mut add = |message| {
            findings.push(Finding {
                path: document.path.clone(),
                line: index + 1,
                message,
            });
        };
        if spans.peek().is_none() {
            add("heading names no file: put its path in backticks".to_owned());
        }
        for span in spans {
            if !exists(&span[1], paths) {
                add(format!("`{}` does not exist", &span[1]));
            }
        }
    }
    findings
}

/// What a document points at exists: links, relative to its folder, and paths in backticks, relative to
/// the repository.
pub fn document_paths(document: &Source, paths: &[&str]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (index, line) in outside_fences(&document.text) {
        let links = LINK
            .captures_iter(line)
            .map(|capture| capture[1].to_owned());
        let spans = CODE_SPAN
            .captures_iter(line)
            .map(|capture| capture[1].to_owned());
        let missing = links
            .filter(|link| !link.contains("://"))
            .map(|link| linked(&document.path, &link))
            .chain(spans.filter(|span| FILE_NAME.is_match(span) && !is_built(span)))
            .filter(|path| !exists(path, paths));
        findings.extend(missing.map(|path| Finding {
            path: document.path.clone(),
            line: index + 1,
            message: format!("points at `{path}`, which does not exist"),
        }));
    }
    findings
}

/// Where a relative link in a document leads, as seen from the repository; unchanged if it leads out.
fn linked(document: &str, link: &str) -> String {
    let mut parts: Vec<&str> = document.split('/').collect();
    parts.pop();
    for part in link.split('/') {
        match part {
            "." => {}
            ".." => {
                if parts.pop().is_none() {
                    return link.to_owned();
                }
            }
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

/// Lines with their index, without those of fenced blocks: these hold examples.
fn outside_fences(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut fenced = false;
    text.lines().enumerate().filter(move |(_, line)| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    })
}

fn is_built(path: &str) -> bool {
    ["target/", "web/dist/", "tests/artefacts/", "../"]
        .iter()
        .any(|start| path.starts_with(start))
}

fn exists(path: &str, paths: &[&str]) -> bool {
    let folder = format!("{}/", path.trim_end_matches('/'));
    paths
        .iter()
        .any(|known| *known == path || known.starts_with(&folder))
}

static RUST_VERSION: LazyLock<Regex> = pattern!(r#"(?m)^rust-version = "([\d.]+)""#);
static MIN_RUST: LazyLock<Regex> = pattern!(r"(?m)^MIN_RUST=([\d.]+)$");

/// The scripts ask for the compiler that `Cargo.toml` declares.
pub fn minimum_rust(manifest: &Source, library: &Source) -> Vec<Finding> {
    let declared = RUST_VERSION
        .captures(&manifest.text)
        .map(|capture| capture[1].to_owned());
    let asked = MIN_RUST
        .captures(&library.text)
        .map(|capture| capture[1].to_owned());
    if declared.is_some() && declared == asked {
        return Vec::new();
    }
    vec![Finding {
        path: library.path.clone(),
        line: 0,
        message: format!("MIN_RUST is {asked:?}, rust-version of Cargo.toml {declared:?}"),
    }]
}
