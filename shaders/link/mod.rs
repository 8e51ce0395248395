//! Links every line of some lists from WESL to plain WGSL, validates it with naga, and writes a table of the
//! results with their reflected bindings and workgroup sizes.
//!
//! A part of two build scripts, the product's and the tests': each has its lists, so that no shader of a
//! test is built into the product.

mod list;
mod row;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use list::Permutation;
use wesl::{CompileOptions, Features, Mangler, ModulePath, Router, StandardResolver, Wesl};

/// Where shaders come from.
#[derive(Debug)]
pub struct Sources {
    /// The lists of shaders to build; `shaders/wesl/permutations.md` says what a line holds.
    pub lists: Vec<PathBuf>,
    /// Folder that `package::` stands for.
    pub root: PathBuf,
    /// More folders, each with the module name under `package::` that stands for it.
    pub mounts: Vec<(String, PathBuf)>,
}

/// Builds every shader of `sources` into the build script's `OUT_DIR`: one WGSL file each, and
/// `table.rs`, a slice of `Shader` literals. Tells cargo what the result depends on.
///
/// Panics with the errors of all shaders: a build script has nobody else to tell.
pub fn link(sources: &Sources) {
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("set by cargo"));
    let folders: Vec<&PathBuf> = std::iter::once(&sources.root)
        .chain(sources.mounts.iter().map(|(_, folder)| folder))
        .collect();
    for path in folders.iter().copied().chain(&sources.lists) {
        println!("cargo::rerun-if-changed={}", path.display());
    }
    let read = |path| std::fs::read_to_string(path).expect("the list is readable");
    let lists: Vec<String> = sources.lists.iter().map(read).collect();
    let mut known = BTreeMap::new();
    for folder in folders {
        known.append(&mut features_used(folder));
    }
    let lines = lists.iter().flat_map(|list| list.lines());
    let permutations: Vec<Permutation> = lines.flat_map(list::permutations_of).collect();
    let build = |permutation: &Permutation| {
        let name = &permutation.name;
        let mut features = known.clone();
        for feature in &permutation.features {
            if features.insert(feature.clone(), true).is_none() {
                return Err(format!("{name}: no source mentions the feature {feature}"));
            }
        }
        build_one(sources, permutation, &features, &out).map_err(|error| format!("{name}: {error}"))
    };
    let mut table = String::from("&[\n");
    let mut failures = Vec::new();
    for result in in_parallel(&permutations, build) {
        match result {
            Ok(row) => table.push_str(&row),
            Err(error) => failures.push(error),
        }
    }
    table.push_str("]\n");
    assert!(
        failures.is_empty(),
        "{} shaders failed:\n\n{}",
        failures.len(),
        failures.join("\n\n")
    );
    std::fs::write(out.join("table.rs"), table).expect("OUT_DIR is writable");
}

/// Results of `work` on every item, in order, on all cores.
fn in_parallel<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let chunk = items.len().div_ceil(cores).max(1);
    let work = &work;
    std::thread::scope(|scope| {
        let threads: Vec<_> = items
            .chunks(chunk)
            .map(|part| scope.spawn(move || part.iter().map(work).collect::<Vec<R>>()))
            .collect();
        let done = threads
            .into_iter()
            .map(|thread| thread.join().expect("a builder panicked"));
        done.flatten().collect()
    })
}

/// Every feature named in an `@if` of some source, all off.
fn features_used(folder: &Path) -> BTreeMap<String, bool> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("readable folder").path();
        if path.is_dir() {
            found.append(&mut features_used(&path));
        } else {
            let text = std::fs::read_to_string(&path).expect("readable source");
            for rest in text.split("@if(").skip(1) {
                let condition = rest.split(')').next().unwrap_or_default();
                for word in condition.split(|c: char| !c.is_alphanumeric() && c != '_') {
                    if !word.is_empty() {
                        found.insert(word.to_owned(), false);
                    }
                }
            }
        }
    }
    found
}

/// Keeps the item's name in front, so that reflection gives it back: `item__module_path`.
struct ItemFirst;

impl Mangler for ItemFirst {
    fn mangle(&self, path: &ModulePath, item: &str) -> String {
        format!("{item}__{}", path.components.join("_"))
    }
}

/// Finds `package::` in the root, and what starts with a mount's name in its folder.
fn resolver(sources: &Sources) -> Result<Router, String> {
    let mut router = Router::new();
    for (name, folder) in &sources.mounts {
        router.mount_resolver(module_path(name)?, StandardResolver::new(folder));
    }
    router.mount_fallback_resolver(StandardResolver::new(&sources.root));
    Ok(router)
}

fn module_path(path: &str) -> Result<ModulePath, String> {
    format!("package::{}", path.replace('/', "::"))
        .parse()
        .map_err(|error| format!("module {path}: {error}"))
}

/// Links and validates one shader, writes its WGSL and returns its row of the table.
fn build_one(
    sources: &Sources,
    permutation: &Permutation,
    features: &BTreeMap<String, bool>,
    out: &Path,
) -> Result<String, String> {
    let mut flags = Features::default();
    for (feature, on) in features {
        flags.flags.insert(feature.clone(), (*on).into());
    }
    let mut compiler = Wesl::new(&sources.root).set_custom_resolver(resolver(sources)?);
    compiler.set_options(CompileOptions {
        features: flags,
        ..CompileOptions::default()
    });
    compiler.set_custom_mangler(ItemFirst);
    let wgsl = compiler
        .compile(&module_path(&permutation.entry)?)
        .map_err(|error| error.to_string())?
        .to_string();
    let parsed =
        naga::front::wgsl::parse_str(&wgsl).map_err(|error| error.emit_to_string(&wgsl))?;
    naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    )
    .validate(&parsed)
    .map_err(|error| error.emit_to_string(&wgsl))?;
    let file = format!("{}.wgsl", permutation.name.replace('+', "-"));
    std::fs::write(out.join(&file), &wgsl).map_err(|error| error.to_string())?;
    Ok(row::row(&permutation.name, &file, &parsed))
}
