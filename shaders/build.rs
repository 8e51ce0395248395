//! Links every line of `permutations.txt` from WESL to plain WGSL, validates it with naga, and
//! writes a table of the results with their reflected bindings and workgroup sizes.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use wesl::{CompileOptions, Features, Mangler, ModulePath, StandardResolver, Wesl};

/// Keeps the item's name in front, so that reflection gives it back: `item__module_path`.
struct ItemFirst;

impl Mangler for ItemFirst {
    fn mangle(&self, path: &ModulePath, item: &str) -> String {
        format!("{item}__{}", path.components.join("_"))
    }
}

fn main() {
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("set by cargo"));
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("set by cargo"));
    println!("cargo::rerun-if-changed=wesl");
    println!("cargo::rerun-if-changed=permutations.txt");
    let list = std::fs::read_to_string(root.join("permutations.txt")).expect("permutations.txt");
    let features_known = features_used(&root.join("wesl"));
    let mut table = String::from("&[\n");
    let mut failures = Vec::new();
    let permutations: Vec<Permutation> = list.lines().flat_map(permutations_of).collect();
    let build = |permutation: &Permutation| {
        let Permutation {
            name,
            entry,
            features: on,
        } = permutation;
        let mut features = features_known.clone();
        for feature in on {
            if features.insert(feature.clone(), true).is_none() {
                return Err(format!("{name}: no source mentions the feature {feature}"));
            }
        }
        build_one(&root, name, entry, &features, &out).map_err(|error| format!("{name}: {error}"))
    };
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

/// A shader to build.
struct Permutation {
    name: String,
    entry: String,
    features: Vec<String>,
}

/// The permutations of a line: `name entry feature… [optional|alternatives]…`. Each bracket doubles
/// them, or more; what is taken of it is appended to the name.
fn permutations_of(line: &str) -> Vec<Permutation> {
    let line = line.split('#').next().unwrap_or_default();
    let mut words = line.split_whitespace();
    let Some(name) = words.next() else {
        return Vec::new();
    };
    let entry = words.next().unwrap_or_default();
    let mut found = vec![Permutation {
        name: name.to_owned(),
        entry: entry.to_owned(),
        features: Vec::new(),
    }];
    for word in words {
        let choices = word.strip_prefix('[').and_then(|w| w.strip_suffix(']'));
        let Some(choices) = choices else {
            for permutation in &mut found {
                permutation.features.push(word.to_owned());
            }
            continue;
        };
        let with = |permutation: &Permutation, choice: &str| {
            let mut features = permutation.features.clone();
            features.push(choice.to_owned());
            Permutation {
                name: format!("{}+{choice}", permutation.name),
                entry: permutation.entry.clone(),
                features,
            }
        };
        let chosen: Vec<Permutation> = choices
            .split('|')
            .flat_map(|choice| found.iter().map(move |p| with(p, choice)))
            .collect();
        found.extend(chosen);
    }
    found
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
    for entry in std::fs::read_dir(folder).expect("wesl folder") {
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

fn build_one(
    root: &Path,
    name: &str,
    entry: &str,
    features: &BTreeMap<String, bool>,
    out: &Path,
) -> Result<String, String> {
    let mut flags = Features::default();
    for (feature, on) in features {
        flags.flags.insert(feature.clone(), (*on).into());
    }
    let mut compiler =
        Wesl::new(root.join("wesl")).set_custom_resolver(StandardResolver::new(root.join("wesl")));
    compiler.set_options(CompileOptions {
        features: flags,
        ..CompileOptions::default()
    });
    compiler.set_custom_mangler(ItemFirst);
    let module: ModulePath = format!("package::{}", entry.replace('/', "::"))
        .parse()
        .map_err(|error| format!("entry {entry}: {error}"))?;
    let wgsl = compiler
        .compile(&module)
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
    let file = format!("{}.wgsl", name.replace('+', "-"));
    std::fs::write(out.join(&file), &wgsl).map_err(|error| error.to_string())?;
    Ok(row(name, &file, &parsed))
}

/// One row of the table: a `Shader` literal.
fn row(name: &str, file: &str, module: &naga::Module) -> String {
    let mut row = String::new();
    let mut bindings: Vec<(u32, u32, String)> = module
        .global_variables
        .iter()
        .filter_map(|(_, variable)| {
            let binding = variable.binding.as_ref()?;
            let mangled = variable.name.as_deref()?;
            let item = mangled.split("__").next()?.to_owned();
            Some((binding.group, binding.binding, item))
        })
        .collect();
    bindings.sort();
    writeln!(
        row,
        "Shader {{ name: {name:?}, wgsl: include_str!(concat!(env!(\"OUT_DIR\"), \"/{file}\")), entry_points: &["
    )
    .expect("a string takes everything");
    for entry in &module.entry_points {
        let [x, y, z] = entry.workgroup_size;
        writeln!(
            row,
            "EntryPoint {{ name: {:?}, stage: Stage::{:?}, workgroup_size: [{x}, {y}, {z}] }},",
            entry.name, entry.stage
        )
        .expect("a string takes everything");
    }
    row.push_str("], bindings: &[");
    for (group, binding, item) in bindings {
        writeln!(
            row,
            "Binding {{ group: {group}, binding: {binding}, name: {item:?} }},"
        )
        .expect("a string takes everything");
    }
    row.push_str("], overrides: &[");
    for (_, constant) in module.overrides.iter() {
        let item = constant.name.as_deref().unwrap_or_default();
        let item = item.split("__").next().unwrap_or_default();
        let key = constant.id.expect("every override has an @id");
        writeln!(row, "Override {{ name: {item:?}, key: \"{key}\" }},")
            .expect("a string takes everything");
    }
    row.push_str("] },\n");
    row
}
