//! The Rust mirrors against what naga reflects of the linked shaders: names, offsets, sizes, values.

use std::collections::BTreeMap;

use tyndall_shaders::types;

/// Struct name → (size, fields) over all linked shaders.
fn reflected() -> BTreeMap<String, (u32, Vec<(String, u32)>)> {
    let mut structs = BTreeMap::new();
    for shader in tyndall_shaders::all() {
        let module = naga::front::wgsl::parse_str(shader.wgsl).expect("validated at build time");
        for (_, kind) in module.types.iter() {
            let naga::TypeInner::Struct { members, span } = &kind.inner else {
                continue;
            };
            let name = kind.name.as_deref().unwrap_or_default();
            let item = name.split("__").next().unwrap_or_default().to_owned();
            let fields = members
                .iter()
                .map(|member| (member.name.clone().unwrap_or_default(), member.offset))
                .collect();
            structs.insert(item, (*span, fields));
        }
    }
    structs
}

#[test]
fn every_mirror_has_the_shader_structs_names_offsets_and_size() {
    let structs = reflected();
    let mut failures = Vec::new();
    for mirror in types::layouts() {
        let Some((span, fields)) = structs.get(mirror.name) else {
            failures.push(format!("{}: no shader uses it", mirror.name));
            continue;
        };
        let expected: Vec<(String, u32)> = mirror
            .fields
            .iter()
            .map(|(name, offset)| ((*name).to_owned(), *offset as u32))
            .collect();
        if *fields != expected {
            failures.push(format!(
                "{}: shader {fields:?}, Rust {expected:?}",
                mirror.name
            ));
        }
        if *span as usize != mirror.size {
            failures.push(format!(
                "{}: shader {span} bytes, Rust {}",
                mirror.name, mirror.size
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn every_shared_constant_has_the_same_value_on_both_sides() {
    let source = include_str!("../wesl/constants.wesl");
    let pairs = [
        ("NO_SHADOW", types::NO_SHADOW),
        ("NO_TEXTURE", types::NO_TEXTURE),
        ("LIGHT_POINT", types::LIGHT_POINT),
        ("LIGHT_SPOT", types::LIGHT_SPOT),
        ("LIGHT_DIRECTIONAL", types::LIGHT_DIRECTIONAL),
        ("MEDIUM_HOMOGENEOUS", types::MEDIUM_HOMOGENEOUS),
        ("MEDIUM_HEIGHT_FOG", types::MEDIUM_HEIGHT_FOG),
        ("MEDIUM_SPHERE", types::MEDIUM_SPHERE),
        ("MEDIUM_GRID", types::MEDIUM_GRID),
        ("ORDER_ALL", types::ORDER_ALL),
        ("ORDER_NONE", types::ORDER_NONE),
        ("ORDER_SINGLE", types::ORDER_SINGLE),
        ("ORDER_MULTIPLE", types::ORDER_MULTIPLE),
        ("WRAP_REPEAT", types::WRAP_REPEAT),
        ("WRAP_MIRRORED", types::WRAP_MIRRORED),
        ("WRAP_CLAMP", types::WRAP_CLAMP),
        ("HISTORY_TILE", types::HISTORY_TILE),
    ];
    let declared = source
        .lines()
        .filter(|line| line.contains(": u32 ="))
        .count();
    assert_eq!(
        declared,
        pairs.len(),
        "constants.wesl has u32 constants that are not compared"
    );
    for (name, value) in pairs {
        let line = source
            .lines()
            .find(|line| line.starts_with(&format!("const {name}:")))
            .unwrap_or_else(|| panic!("{name} is not in constants.wesl"));
        let text = line
            .split('=')
            .nth(1)
            .unwrap_or_default()
            .trim()
            .trim_end_matches(';')
            .trim_end_matches('u');
        let parsed = text
            .strip_prefix("0x")
            .map_or_else(|| text.parse(), |hex| u32::from_str_radix(hex, 16));
        assert_eq!(parsed, Ok(value), "{name}");
    }
}

#[test]
fn every_binding_name_is_unique_in_its_shader() {
    for shader in tyndall_shaders::all() {
        let mut names: Vec<_> = shader.bindings.iter().map(|binding| binding.name).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(
            names.len(),
            count,
            "{}: resources are bound by name",
            shader.name
        );
    }
}

#[test]
fn no_uniform_buffer_is_used() {
    // A uniform that steers a loop makes Mesa 22's software driver compile anew at every dispatch.
    for shader in tyndall_shaders::all() {
        assert!(!shader.wgsl.contains("var<uniform>"), "{}", shader.name);
    }
}
