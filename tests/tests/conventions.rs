//! Holds the repository to the conventions of `CONTRIBUTING.md`. Tier *none*: needs no device.
//!
//! Two tests a convention: `every_*` looks at the repository, `plants_*` shows that the check
//! finds a violation and lets the right spelling pass.

use std::collections::BTreeSet;

use tyndall_tests::conventions::source::{self, Source};
use tyndall_tests::conventions::{Finding, assert_none, layout, text};

fn repository() -> Vec<Source> {
    let sources = source::sources(&source::root()).expect("the repository is readable");
    assert!(
        sources.iter().any(|source| source.path == "Cargo.toml"),
        "not the repository's root"
    );
    sources
}

fn named<'a>(sources: &'a [Source], path: &str) -> &'a Source {
    sources
        .iter()
        .find(|source| source.path == path)
        .unwrap_or_else(|| panic!("{path} is missing"))
}

fn assert_everywhere(check: fn(&Source) -> Vec<Finding>) {
    assert_none(&repository().iter().flat_map(check).collect::<Vec<_>>());
}

/// Each bad sample is found and each good one is not.
fn assert_tells(check: impl Fn(&Source) -> Vec<Finding>, path: &str, bad: &[&str], good: &[&str]) {
    for sample in bad {
        assert_eq!(
            check(&Source::new(path, sample)).len(),
            1,
            "not found in {path}: {sample}"
        );
    }
    for sample in good {
        assert_none(&check(&Source::new(path, sample)));
    }
}

#[test]
fn every_one_minus_exp_is_written_stably() {
    assert_everywhere(text::one_minus_exp);
}

#[test]
fn plants_one_minus_exp() {
    assert_tells(
        text::one_minus_exp,
        "a.rs",
        &[
            "let a = 1.0 - (-x).exp();",
            "let a = 1.0 - f32::exp(-x);",
            "let a = 1. - x.neg().exp();",
            "let a = 1.0_f64-(-sigma_t * length).exp();",
            "let a = 1.0f32 - ((-x).exp());",
            "let a = (1.0 - (-x).exp()) / x;",
            "let a = 1.0\n    - (-x).exp();",
            "let a = 1.0 - (-x).exp2();",
            "let a = Vec3::ONE - (-tau).exp();",
            "let a = glam::Vec3::splat(1.0) - (-tau).map(f32::exp);",
            "let a = -f64::exp(-x) + 1.0;",
            "let a = 1.0 - libm::expf(-x);",
            "let a = (-x).exp().mul_add(-1.0, 1.0);",
            "let a = 1.0 - (-x).exp(); // allow-one-minus-exp: short",
        ],
        &[
            "let a = -(-x).exp_m1();",
            "// 1.0 - exp(-x)",
            "let a = \"1.0 - exp(-x)\";",
            "let a = r#\"1.0 - \"exp(-x)\"#;",
            "let a = 1.0 - albedo;",
            "let a = 1.0 - weight(x.exp());",
            "let a = 1.0 - exposure(x);",
            "let a = x1 - f32::exp(x);",
            "let a = 2.1 - f32::exp(x);",
            "let a = 1.0 - cosine * (-x).exp();",
            "let a = 1.0 - (-x).exp(); // allow-one-minus-exp: shows the cancellation itself",
            "// allow-one-minus-exp: shows the cancellation itself\nlet a = 1.0 - (-x).exp();",
        ],
    );
    assert_tells(
        text::one_minus_exp,
        "a.wesl",
        &[
            "let a = 1.0 - exp(-x);",
            "let a = 1 - exp(-x);",
            "let a = 1f - exp(-x);",
            "let a = 1.0 -exp2(-x);",
            "let a = vec3(1.0) - exp(-tau);",
            "let a = vec3f(1.0) - exp(-tau);",
            "let a = vec3<f32>(1.0) - exp(-tau);",
            "let a = 1.0 - (exp(-x));",
            "let a = vec3f(1.0) - transmittance_of(tau);",
            "let a = -exp(-(x + y)) + 1.0;",
        ],
        &[
            "let a = one_minus_exp_neg(x);",
            "/* 1.0 - exp(-x) */",
            "let a = 1.0 - explicit(x);",
            "let a = 1.0 - g * exp(-x);",
            "let a = -exp(-x) + 1.05;",
        ],
    );
    assert_tells(
        text::one_minus_exp,
        "notes.md",
        &[],
        &["never `1.0 - exp(-x)`"],
    );
}

#[test]
fn every_file_is_short() {
    assert_everywhere(text::file_size);
}

#[test]
fn plants_long_files() {
    let lines = |count| "//\n".repeat(count);
    assert_tells(text::file_size, "a.rs", &[&lines(501)], &[&lines(500)]);
    assert_tells(text::file_size, "a.ts", &[&lines(501)], &[&lines(500)]);
    assert_tells(text::file_size, "a.wesl", &[&lines(251)], &[&lines(250)]);
    assert_tells(text::file_size, "protocol.gen.ts", &[], &[&lines(900)]);
}

#[test]
fn every_task_left_is_an_issue() {
    assert_everywhere(text::unfinished_work);
}

#[test]
fn plants_unfinished_work() {
    let (first, second) = (concat!("// TO", "DO: later"), concat!("// FIX", "ME"));
    assert_tells(
        text::unfinished_work,
        "a.wesl",
        &[first, second],
        &["// methodology"],
    );
}

#[test]
fn every_normalize_is_safe() {
    assert_everywhere(text::bare_normalize);
}

#[test]
fn plants_bare_normalize() {
    assert_tells(
        text::bare_normalize,
        "shaders/wesl/a.wesl",
        &["let n = normalize(v);", "let n = -normalize (v);"],
        &["let n = safe_normalize(v);", "// normalize(v)"],
    );
}

#[test]
fn every_value_in_shaders_is_finite() {
    assert_everywhere(text::sentinel);
}

#[test]
fn plants_sentinels() {
    assert_tells(
        text::sentinel,
        "shaders/wesl/a.wesl",
        &[
            "let far = bitcast<f32>(0x7f800000u);",
            "let far = bitcast<f32>(0xFF800000);",
            "let nan = bitcast<f32>(0x7fc00000u);",
            "let far = 1e39;",
            "let far = 1.0e+40f;",
            "let far = 1.0 / 0.0;",
            "let far = x / 0;",
            "if (isnan(x)) {}",
        ],
        &[
            "let far = 1e30;",
            "let a = x / 0.5;",
            "let a = 3.4e38;",
            "let mask = 0x7fu;",
            "let a = b & 0x7f800000u; // allow-float-bits: the test of finiteness itself",
            "// 1e39",
        ],
    );
}

#[test]
fn every_file_has_a_head() {
    assert_everywhere(text::head_comment);
}

#[test]
fn plants_missing_heads() {
    assert_tells(
        text::head_comment,
        "a.rs",
        &["use std::io;", "// x"],
        &["//! What.\nuse a;"],
    );
    assert_tells(
        text::head_comment,
        "a.wesl",
        &["fn f() {}"],
        &["// What.\nfn f() {}"],
    );
    assert_tells(
        text::head_comment,
        "a.ts",
        &["import x;"],
        &["/** What. */", "// What."],
    );
    assert_tells(
        text::head_comment,
        "a.gen.ts",
        &[],
        &["export type A = number;"],
    );
}

#[test]
fn every_file_is_free_of_local_addresses() {
    assert_everywhere(text::local_address);
}

#[test]
fn plants_local_addresses() {
    assert_tells(
        text::local_address,
        "a.md",
        &[
            concat!("see /wo", "rk/main/x"),
            concat!("\"/wo", "rk/shared\""),
            concat!("https://registry.npm", "js.org/x"),
            concat!("URIs: http://deb.deb", "ian.org/debian"),
            concat!("cp /tmp/ba", "sh_jobs/x"),
        ],
        &[
            "the network/ folder",
            "../shared/data",
            "https://rustup.rs",
            "/tmp/picture.png",
        ],
    );
}

#[test]
fn every_crate_takes_the_lints_of_the_workspace() {
    assert_everywhere(text::crate_lints);
}

#[test]
fn plants_a_crate_without_lints() {
    assert_tells(
        text::crate_lints,
        "server/a/Cargo.toml",
        &["[package]\nname = \"a\"", "[lints]\nworkspace = false"],
        &["[lints]\nworkspace = true\n"],
    );
}

#[test]
fn every_technique_has_one_name_in_rust_and_wesl() {
    let sources = repository();
    let paths: Vec<&str> = sources.iter().map(|source| source.path.as_str()).collect();
    let (rust, wesl) = layout::technique_names(&paths);
    assert!(
        rust.contains("screen_space"),
        "the check looks at the wrong folder: {rust:?}"
    );
    assert!(
        wesl.contains("screen_space"),
        "the check looks at the wrong folder: {wesl:?}"
    );
    assert_none(&layout::technique_pairs(&paths));
}

#[test]
fn plants_a_technique_with_two_names() {
    let good = [
        "server/render/src/techniques/mod.rs",
        "server/render/src/techniques/surfaces/mod.rs",
        "shaders/wesl/techniques/surfaces/shade.wesl",
    ];
    assert_none(&layout::technique_pairs(&good));
    let mut bad = good.to_vec();
    bad.push("shaders/wesl/techniques/fog/march.wesl");
    bad.push("server/render/src/techniques/mist/mod.rs");
    assert_eq!(layout::technique_pairs(&bad).len(), 1);
}

#[test]
fn every_technique_stands_alone() {
    let sources = repository();
    let paths: Vec<&str> = sources.iter().map(|source| source.path.as_str()).collect();
    let (rust, wesl) = layout::technique_names(&paths);
    let names: BTreeSet<String> = rust.union(&wesl).cloned().collect();
    let findings: Vec<Finding> = sources
        .iter()
        .flat_map(|source| layout::technique_imports(source, &names))
        .collect();
    assert_none(&findings);
}

#[test]
fn plants_techniques_that_import_one_another() {
    let names = ["surfaces", "reference"].map(ToOwned::to_owned).into();
    let check = |source: &Source| layout::technique_imports(source, &names);
    assert_tells(
        check,
        "server/render/src/techniques/surfaces/mod.rs",
        &[
            "use crate::techniques::reference::Passes;",
            "use super::reference;",
            "use super::{Inputs, reference::Passes};",
        ],
        &[
            "use crate::techniques::surfaces::A;",
            "use super::Inputs;",
            "// techniques::reference",
        ],
    );
    assert_tells(
        check,
        "shaders/wesl/techniques/reference/trace.wesl",
        &[
            "import package::techniques::surfaces::shade::a;",
            "import super::super::surfaces::a;",
        ],
        &[
            "import package::techniques::reference::a;",
            "import package::numeric::b;",
        ],
    );
    assert_tells(
        check,
        "server/render/src/techniques/mod.rs",
        &[],
        &["use crate::techniques::reference::A;"],
    );
}

#[test]
fn every_heading_of_the_architecture_is_a_file() {
    let sources = repository();
    let paths: Vec<&str> = sources.iter().map(|source| source.path.as_str()).collect();
    assert_none(&layout::heading_paths(
        named(&sources, "ARCHITECTURE.md"),
        &paths,
    ));
}

#[test]
fn plants_headings_without_files() {
    let check = |source: &Source| layout::heading_paths(source, &["server/scene/src/lib.rs"]);
    assert_tells(
        check,
        "ARCHITECTURE.md",
        &["# Title\n\n## `server/gone.rs`: x", "## No file"],
        &[
            "# Title\n\n## 1. `server/scene/src/lib.rs`: x",
            "```\n## no heading\n```",
        ],
    );
}

#[test]
fn every_path_in_the_documents_exists() {
    let sources = repository();
    // Pictures are linked too, and `sources` holds text only.
    let paths = source::paths(&source::root()).unwrap();
    let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
    let documents: Vec<&Source> = sources
        .iter()
        .filter(|source| source.extension() == "md")
        .collect();
    assert!(documents.len() > 5);
    let findings: Vec<Finding> = documents
        .iter()
        .flat_map(|document| layout::document_paths(document, &paths))
        .collect();
    assert_none(&findings);
}

#[test]
fn plants_documents_that_point_nowhere() {
    let check = |source: &Source| layout::document_paths(source, &["docs/a.png", "server/x.rs"]);
    assert_tells(
        check,
        "README.md",
        &[
            "![x](docs/b.png)",
            "see `server/gone.rs`",
            "see `server/gone/`",
        ],
        &[
            "![x](docs/a.png)",
            "[x](https://example.org/a)",
            "`server/x.rs`, `server/`, `a/b`, `image/png`, `target/debug/x.bin`",
        ],
    );
    assert_tells(
        check,
        "docs/a.md",
        &["![x](docs/a.png)", "[x](../../x.rs)", "see `x.rs/gone.rs`"],
        &["![x](a.png)", "[x](../server/x.rs)", "`server/x.rs`"],
    );
}

#[test]
fn every_licence_is_there() {
    let sources = repository();
    assert!(
        named(&sources, "LICENSE-MIT")
            .text
            .starts_with("MIT License")
    );
    assert!(
        named(&sources, "LICENSE-APACHE")
            .text
            .contains("Version 2.0, January 2004")
    );
    assert!(
        named(&sources, "Cargo.toml")
            .text
            .contains("license = \"MIT OR Apache-2.0\"")
    );
}

#[test]
fn every_script_asks_for_the_declared_compiler() {
    let sources = repository();
    let (manifest, library) = (
        named(&sources, "Cargo.toml"),
        named(&sources, "deploy/lib.sh"),
    );
    assert_none(&layout::minimum_rust(manifest, library));
    let older = Source::new("deploy/lib.sh", "MIN_RUST=1.80\n");
    assert_eq!(layout::minimum_rust(manifest, &older).len(), 1);
}
