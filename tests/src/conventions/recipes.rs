//! The lists of files in ARCHITECTURE.md's "Adding things" against the repository.
//!
//! Each recipe gives a pattern that finds an example of its kind that exists: whatever files it is found
//! in are those that adding another takes, so they must be the list's, one by one.

use regex::Regex;

use super::Finding;
use super::source::Source;

/// Where the recipes begin.
const HEADING: &str = "## Adding things";
/// What stands before a recipe's pattern.
const PATTERN: &str = "<!-- found by: ";

/// A recipe of the document.
#[derive(Debug)]
struct Recipe {
    title: String,
    line: usize,
    pattern: String,
    /// Files, and folders that end with `/`.
    paths: Vec<String>,
}

/// Files that are missing in a list, and those that no longer belong there.
pub fn recipes(document: &Source, sources: &[Source]) -> Vec<Finding> {
    let finding = |line, message| Finding {
        path: document.path.clone(),
        line,
        message,
    };
    let recipes = read(&document.text);
    if recipes.is_empty() {
        return vec![finding(0, format!("has no recipe under `{HEADING}`"))];
    }
    let mut findings = Vec::new();
    for recipe in recipes {
        let Ok(pattern) = Regex::new(&recipe.pattern) else {
            findings.push(finding(recipe.line, "its pattern is none".to_owned()));
            continue;
        };
        let found: Vec<&Source> = sources
            .iter()
            .filter(|source| counts(source) && pattern.is_match(&source.code))
            .collect();
        let listed = |path: &str| {
            let holds = |known: &&String| {
                *known == path || (known.ends_with('/') && path.starts_with(*known))
            };
            recipe.paths.iter().any(|known| holds(&known))
        };
        for source in &found {
            if !listed(&source.path) {
                let message = format!("{}: lacks {}", recipe.title, source.path);
                findings.push(finding(recipe.line, message));
            }
        }
        for path in &recipe.paths {
            let is_found = |source: &&Source| {
                source.path == *path || (path.ends_with('/') && source.path.starts_with(path))
            };
            if !found.iter().any(is_found) {
                let message = format!("{}: nothing of its example is in {path}", recipe.title);
                findings.push(finding(recipe.line, message));
            }
        }
    }
    findings
}

/// Code that people write for the product: no tests, no generated files, no presets.
fn counts(source: &Source) -> bool {
    let code = matches!(source.extension(), "rs" | "wesl" | "ts");
    let aside = ["tests/", "/tests/", "/presets/"];
    code && !source.is_generated()
        && !aside
            .iter()
            .any(|part| source.path.starts_with(part) || source.path.contains(part))
}

fn read(text: &str) -> Vec<Recipe> {
    let mut found: Vec<Recipe> = Vec::new();
    let mut title = String::new();
    let lines = text.lines().enumerate();
    for (index, line) in lines.skip_while(|(_, line)| !line.starts_with(HEADING)) {
        if let Some(heading) = line.strip_prefix("**").and_then(|l| l.strip_suffix("**")) {
            heading.clone_into(&mut title);
        } else if let Some(rest) = line.strip_prefix(PATTERN) {
            found.push(Recipe {
                title: title.clone(),
                line: index + 1,
                pattern: rest.trim_end_matches("-->").trim().to_owned(),
                paths: Vec::new(),
            });
        } else if let Some(recipe) = found.last_mut()
            && let Some(rest) = line.strip_prefix("- `")
            && let Some((path, _)) = rest.split_once('`')
        {
            recipe.paths.push(path.to_owned());
        }
    }
    found
}
