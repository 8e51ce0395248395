//! A shader as a line of Rust.

use std::fmt::Write as _;

/// One row of the table: a `Shader` literal.
pub(crate) fn row(name: &str, file: &str, module: &naga::Module) -> String {
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
