//! Check that few test binaries hold every test: cargo builds no file that none of them names.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use regex::Regex;

use super::Finding;
use super::source::Source;

/// A pattern of this module: written here, tested here, so it always compiles.
macro_rules! pattern {
    ($text:expr) => {
        LazyLock::new(|| Regex::new($text).expect("the pattern is a constant that tests cover"))
    };
}

static NO_SEARCH: LazyLock<Regex> = pattern!(r"(?m)^autotests = false$");
static ROOT: LazyLock<Regex> = pattern!(r#"(?m)^path = "(tests/[\w/]+\.rs)"$"#);
static MODULE: LazyLock<Regex> = pattern!(r"(?m)^\s*(?:pub(?:\([\w: ]+\))? )?mod (\w+);");

/// Test files that no binary holds, and crates where cargo makes a binary of each file.
pub fn test_files(sources: &[Source]) -> Vec<Finding> {
    sources
        .iter()
        .filter_map(|source| Some((source, source.path.strip_suffix("Cargo.toml")?)))
        .flat_map(|(manifest, folder)| of_crate(manifest, folder, sources))
        .collect()
}

fn of_crate(manifest: &Source, folder: &str, sources: &[Source]) -> Vec<Finding> {
    let tests = format!("{folder}tests/");
    let files: Vec<&Source> = sources
        .iter()
        .filter(|source| source.path.starts_with(&tests) && source.extension() == "rs")
        .filter(|source| !is_other_crate(source, folder, sources))
        .collect();
    let listed = NO_SEARCH.is_match(&manifest.text);
    let roots: Vec<String> = if listed {
        let paths = ROOT.captures_iter(&manifest.text);
        paths.map(|path| format!("{folder}{}", &path[1])).collect()
    } else {
        let paths = files.iter().map(|file| file.path.clone());
        paths.filter(|path| is_found(path, &tests)).collect()
    };
    let mut findings = Vec::new();
    if !listed && roots.len() > 1 {
        findings.push(Finding {
            path: manifest.path.clone(),
            line: 0,
            message: format!(
                "{} test files are linked one by one: make them modules of `tests/main.rs`",
                roots.len()
            ),
        });
    }
    let mut held = BTreeSet::new();
    for root in &roots {
        let beside = root.rsplit_once('/').map_or("", |(beside, _)| beside);
        hold(root, beside, &files, &mut held);
    }
    findings.extend(
        files
            .iter()
            .filter(|file| !held.contains(file.path.as_str()))
            .map(|file| Finding {
                path: file.path.clone(),
                line: 0,
                message: "no test binary holds this file: name it with `mod`".to_owned(),
            }),
    );
    findings
}

/// Whether a crate deeper in the repository owns the file: the workspace's own manifest owns none.
fn is_other_crate(source: &Source, folder: &str, sources: &[Source]) -> bool {
    sources
        .iter()
        .filter_map(|other| other.path.strip_suffix("Cargo.toml"))
        .any(|other| other.len() > folder.len() && source.path.starts_with(other))
}

/// Whether cargo finds a test binary's root here by itself.
fn is_found(path: &str, tests: &str) -> bool {
    let rest = path.strip_prefix(tests).unwrap_or_default();
    match rest.split_once('/') {
        None => true,
        Some((_, name)) => name == "main.rs",
    }
}

/// Adds a file and the modules that it names, which lie in the folder `beside`.
fn hold<'a>(path: &str, beside: &str, files: &[&'a Source], held: &mut BTreeSet<&'a str>) {
    let Some(file) = files.iter().find(|file| file.path == path) else {
        return;
    };
    if !held.insert(&file.path) {
        return;
    }
    for module in MODULE.captures_iter(&file.code) {
        let inside = format!("{beside}/{}", &module[1]);
        hold(&format!("{inside}.rs"), &inside, files, held);
        hold(&format!("{inside}/mod.rs"), &inside, files, held);
    }
}
