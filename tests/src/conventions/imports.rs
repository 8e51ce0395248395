//! Which way imports go: among the files of a crate no circle may close.
//!
//! A file uses another one if its code names something that the other one defines. Names are followed
//! through `use` to the file of the definition, so a `mod.rs` that only declares its children and passes
//! their names on (`mod`, and `pub use` of what lies below it) uses none of them and closes no circle;
//! one that calls its children does use them, and they may then use nothing that it defines. Code under
//! `#[cfg(test)]` does not count: a test may look at the whole. A module written out inside a file
//! belongs to that file.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::LazyLock;

use regex::Regex;

use super::Finding;
use super::source::Source;

static TOKEN: LazyLock<Regex> = LazyLock::new(|| {
    Regex::new(r"[A-Za-z_]\w*|::|[^\s\w]").expect("the pattern is a constant that tests cover")
});

/// A module's path from the crate's root; the root's own is empty.
type Module = Vec<String>;

/// What one file uses of others: for each of them the first place that does.
type Uses = BTreeMap<Module, Place>;

/// A line of a file.
#[derive(Clone)]
struct Place {
    path: String,
    line: usize,
}

/// Modules each of which uses the next one, the last one the first, each with the place that does.
type Circle = Vec<(Module, Place)>;

/// A path that a file names.
struct Named {
    /// `["super", "geometry", "Mesh"]`; ends in `*` if it brings in everything.
    path: Module,
    /// The name it gets, if a `use` gives it one.
    binds: Option<String>,
    /// Whether it is passed on to other files.
    public: bool,
    line: usize,
}

/// What one file says of modules.
struct File {
    path: String,
    named: Vec<Named>,
    defines: BTreeSet<String>,
}

/// The files of one crate by their modules, and who uses whom.
struct Crate {
    files: BTreeMap<Module, File>,
    uses: BTreeMap<Module, Uses>,
}

/// One finding for every set of files below `root`, such as `server/scene/src/`, that use one another in
/// a circle.
pub fn circles_of_files(sources: &[Source], root: &str) -> Vec<Finding> {
    circles(&Crate::new(sources, root).uses, "files")
}

/// One finding for every set of modules beside one another that use one another in a circle, each taken
/// with everything below it: what no circle of files shows.
pub fn circles_of_folders(sources: &[Source], root: &str) -> Vec<Finding> {
    let all = Crate::new(sources, root);
    let parents: BTreeSet<&[String]> = all
        .files
        .keys()
        .filter_map(|path| Some(path.split_last()?.1))
        .collect();
    let mut findings = Vec::new();
    for parent in parents {
        let mut folders: BTreeMap<Module, Uses> = BTreeMap::new();
        for (from, uses) in &all.uses {
            for (to, place) in uses {
                if let (Some(from), Some(to)) = (child_of(parent, from), child_of(parent, to))
                    && from != to
                {
                    let uses = folders.entry(from.to_vec()).or_default();
                    uses.entry(to.to_vec()).or_insert_with(|| place.clone());
                }
            }
        }
        findings.extend(circles(&folders, "modules with all below them"));
    }
    findings
}

/// The child of `parent` that `module` is or lies below.
fn child_of<'a>(parent: &[String], module: &'a [String]) -> Option<&'a [String]> {
    let child = module.get(..=parent.len())?;
    child.starts_with(parent).then_some(child)
}

impl Crate {
    fn new(sources: &[Source], root: &str) -> Self {
        let files: BTreeMap<Module, File> = sources
            .iter()
            .filter_map(|source| {
                let inside = source.path.strip_prefix(root)?.strip_suffix(".rs")?;
                let mut path: Module = inside.split('/').map(ToOwned::to_owned).collect();
                path.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
                Some((path, File::read(source)))
            })
            .collect();
        let mut all = Self {
            files,
            uses: BTreeMap::new(),
        };
        all.uses = all
            .files
            .keys()
            .map(|path| (path.clone(), all.uses_of(path)))
            .collect();
        all
    }

    /// The files that the one of module `path` uses.
    fn uses_of(&self, path: &Module) -> Uses {
        let mut uses = Uses::new();
        for named in &self.files[path].named {
            let Some(target) = self.definition(path, &named.path, &mut Vec::new()) else {
                continue;
            };
            let passes_on = named.public && target.starts_with(path);
            if target != *path && !passes_on {
                uses.entry(target).or_insert_with(|| Place {
                    path: self.files[path].path.clone(),
                    line: named.line,
                });
            }
        }
        uses
    }

    /// The module whose file defines what `named` says in the file of `module`; `None` if that is not of
    /// this crate. `seen` are the steps so far: two files may pass each other's names on.
    fn definition(
        &self,
        module: &Module,
        named: &[String],
        seen: &mut Vec<(Module, Module)>,
    ) -> Option<Module> {
        let step = (module.clone(), named.to_vec());
        if seen.contains(&step) {
            return None;
        }
        seen.push(step);
        let mut at = module.clone();
        let mut rest = named;
        match rest.first()?.as_str() {
            "crate" => (at, rest) = (Module::new(), &rest[1..]),
            "self" => rest = &rest[1..],
            "super" => {}
            first if self.is_child(&at, first) || self.binds(&at, first) => {}
            _ => return None,
        }
        while rest.first().is_some_and(|name| name == "super") {
            at.pop();
            rest = &rest[1..];
        }
        while let Some((name, after)) = rest.split_first() {
            if self.is_child(&at, name) {
                at.push(name.clone());
                rest = after;
                continue;
            }
            let file = self.files.get(&at)?;
            if name == "*" || file.defines.contains(name) {
                break;
            }
            let found = file.named.iter().find_map(|used| {
                if used.binds.as_ref() == Some(name) {
                    return self.definition(&at, &used.path, seen);
                }
                let (_, folder) = used.path.split_last().filter(|(last, _)| *last == "*")?;
                let found =
                    self.definition(&at, &[folder, std::slice::from_ref(name)].concat(), seen)?;
                self.files[&found].defines.contains(name).then_some(found)
            });
            match found {
                Some(found) => (at, rest) = (found, after),
                None if self.binds(&at, name) => return None,
                // A variant, a method, or made by a macro: it is of this file.
                None => break,
            }
        }
        Some(at)
    }

    fn is_child(&self, module: &Module, name: &str) -> bool {
        let mut child = module.clone();
        child.push(name.to_owned());
        self.files.contains_key(&child)
    }

    /// Whether a `use` in the file of `module` gives something this name.
    fn binds(&self, module: &Module, name: &str) -> bool {
        let named = self.files.get(module).map_or(&[][..], |file| &file.named);
        named.iter().any(|used| used.binds.as_deref() == Some(name))
    }
}

impl File {
    fn read(source: &Source) -> Self {
        let tokens = TOKEN.find_iter(&source.code);
        let tokens: Vec<(&str, usize)> = tokens.map(|t| (t.as_str(), t.start())).collect();
        let tokens = without_tests(&tokens);
        let word = |at: usize| tokens.get(at).map_or("", |(token, _)| *token);
        let (mut named, mut defines) = (Vec::new(), BTreeSet::new());
        let mut at = 0;
        while at < tokens.len() {
            let line = source.line_of(tokens[at].1);
            let before = at.checked_sub(1).map_or("", word);
            match word(at) {
                "use" => {
                    let public =
                        before == "pub" || (before == ")" && word(at.saturating_sub(4)) == "pub");
                    at += 1;
                    tree(&tokens, &mut at, &[], &mut |path, binds| {
                        named.push(Named {
                            path,
                            binds,
                            public,
                            line,
                        });
                    });
                }
                "struct" | "enum" | "union" | "trait" | "fn" | "type" | "const" | "static" => {
                    defines.insert(word(at + 1).to_owned());
                }
                "macro_rules" => {
                    defines.insert(word(at + 2).to_owned());
                }
                first
                    if is_name(first)
                        && word(at + 1) == "::"
                        && !["::", ".", "in"].contains(&before) =>
                {
                    let mut path = vec![first.to_owned()];
                    while word(at + 1) == "::" && is_name(word(at + 2)) {
                        path.push(word(at + 2).to_owned());
                        at += 2;
                    }
                    named.push(Named {
                        path,
                        binds: None,
                        public: false,
                        line,
                    });
                }
                _ => {}
            }
            at += 1;
        }
        Self {
            path: source.path.clone(),
            named,
            defines,
        }
    }
}

fn is_name(token: &str) -> bool {
    token.starts_with(|first: char| first.is_alphabetic() || first == '_')
}

/// Reads one tree of a `use` behind `prefix`, and stops at the token after it.
fn tree(
    tokens: &[(&str, usize)],
    at: &mut usize,
    prefix: &[String],
    add: &mut impl FnMut(Module, Option<String>),
) {
    let mut path = prefix.to_vec();
    while let Some((token, _)) = tokens.get(*at) {
        *at += 1;
        match *token {
            "::" => {}
            "{" => {
                while tokens.get(*at).is_some_and(|(token, _)| *token != "}") {
                    tree(tokens, at, &path, add);
                    if tokens.get(*at).is_some_and(|(token, _)| *token == ",") {
                        *at += 1;
                    }
                }
                *at += 1;
                return;
            }
            "as" => {
                let name = tokens.get(*at).map(|(name, _)| (*name).to_owned());
                *at += 1;
                return add(path, name);
            }
            "," | ";" | "}" => {
                *at -= 1;
                break;
            }
            name => path.push(name.to_owned()),
        }
    }
    // `{self, …}` names the module before the braces.
    path.pop_if(|last| last == "self");
    let name = path.last().filter(|name| *name != "*").cloned();
    add(path, name);
}

/// The tokens without the items that stand under `#[cfg(test)]`.
fn without_tests<'a>(tokens: &[(&'a str, usize)]) -> Vec<(&'a str, usize)> {
    const TEST: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let mut kept = Vec::with_capacity(tokens.len());
    let mut at = 0;
    while at < tokens.len() {
        let here = tokens[at..].iter().map(|(token, _)| *token);
        if !here.clone().take(TEST.len()).eq(TEST) {
            kept.push(tokens[at]);
            at += 1;
            continue;
        }
        // The item ends with its block, or without one with a semicolon.
        let mut depth = 0_usize;
        let end = here.skip(TEST.len()).position(|token| {
            match token {
                "{" => depth += 1,
                "}" => depth = depth.saturating_sub(1),
                _ => {}
            }
            depth == 0 && ["}", ";"].contains(&token)
        });
        at = end.map_or(tokens.len(), |end| at + TEST.len() + end + 1);
    }
    kept
}

/// One finding for every set of nodes that reach one another; `what` are they.
fn circles(uses: &BTreeMap<Module, Uses>, what: &str) -> Vec<Finding> {
    let mut shortest: Vec<Circle> = uses
        .keys()
        .filter_map(|node| circle_through(uses, node))
        .collect();
    shortest.sort_by_key(Vec::len);
    let mut sets: Vec<(usize, Circle)> = Vec::new();
    for circle in shortest {
        let node = &circle[0].0;
        let of_set = |(_, other): &&mut (usize, Circle)| {
            let other = &other[0].0;
            way(uses, node, other).is_some() && way(uses, other, node).is_some()
        };
        match sets.iter_mut().find(of_set) {
            Some((count, _)) => *count += 1,
            None => sets.push((1, circle)),
        }
    }
    let findings = sets.iter();
    findings
        .map(|(count, circle)| finding(*count, what, circle))
        .collect()
}

/// What is wrong with `count` things of kind `what`, of whose circles `circle` is a shortest one.
fn finding(count: usize, what: &str, circle: &Circle) -> Finding {
    let name = |(module, _): &(Module, Place)| match module.as_slice() {
        [] => "crate".to_owned(),
        path => path.join("::"),
    };
    let steps: Vec<String> = circle
        .iter()
        .zip(circle.iter().cycle().skip(1))
        .map(|(from, to)| {
            let Place { path, line } = &from.1;
            format!("{} uses {} ({path}:{line})", name(from), name(to))
        })
        .collect();
    Finding {
        path: circle[0].1.path.clone(),
        line: circle[0].1.line,
        message: format!(
            "{count} {what} use one another in circles, for one {}: move what both need below them",
            steps.join(", ")
        ),
    }
}

/// A shortest circle that starts at `node`, if there is one.
fn circle_through(uses: &BTreeMap<Module, Uses>, node: &Module) -> Option<Circle> {
    let ways = uses[node].keys().filter_map(|next| way(uses, next, node));
    let back = ways.min_by_key(Vec::len)?;
    let steps: Vec<&Module> = std::iter::once(node)
        .chain(back[..back.len() - 1].iter().copied())
        .collect();
    let next = |i: usize| steps[(i + 1) % steps.len()];
    Some(
        steps
            .iter()
            .enumerate()
            .map(|(i, step)| ((*step).clone(), uses[*step][next(i)].clone()))
            .collect(),
    )
}

/// The nodes of a shortest way from one node to another, both included.
fn way<'a>(
    uses: &'a BTreeMap<Module, Uses>,
    from: &'a Module,
    to: &Module,
) -> Option<Vec<&'a Module>> {
    let mut before: BTreeMap<&Module, &Module> = BTreeMap::from([(from, from)]);
    let mut queue = VecDeque::from([from]);
    while let Some(node) = queue.pop_front() {
        if node == to {
            let mut way = vec![node];
            while way[way.len() - 1] != from {
                way.push(before[way[way.len() - 1]]);
            }
            way.reverse();
            return Some(way);
        }
        for next in uses.get(node).into_iter().flat_map(BTreeMap::keys) {
            before.entry(next).or_insert_with(|| {
                queue.push_back(next);
                node
            });
        }
    }
    None
}
