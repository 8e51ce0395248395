//! Few test binaries hold every test file. Tier *none*: needs no device.

use tyndall_tests::conventions::source::{self, Source};
use tyndall_tests::conventions::test_files::test_files;

#[test]
fn every_test_file_is_in_one_of_few_binaries() {
    let sources = source::sources(&source::root()).unwrap();
    let path = "tests/tests/conventions_test_files.rs";
    assert!(
        sources.iter().any(|source| source.path == path),
        "this file is not among the sources"
    );
    let findings: Vec<String> = test_files(&sources)
        .iter()
        .map(ToString::to_string)
        .collect();
    assert!(findings.is_empty(), "{}", findings.join("\n"));
}

#[test]
fn plants_test_files_that_no_binary_holds_and_too_many_binaries() {
    let manifest = "autotests = false\n[[test]]\nname = \"all\"\npath = \"tests/main.rs\"\n";
    let searched = "[package]\nname = \"a\"\n";
    let found = |manifest: &str, files: &[(&str, &str)]| {
        let mut sources = vec![Source::new("a/Cargo.toml", manifest)];
        sources.extend(files.iter().map(|(path, text)| Source::new(path, text)));
        let findings = test_files(&sources);
        findings.into_iter().map(|f| f.path).collect::<Vec<_>>()
    };
    let none: [&str; 0] = [];
    let whole = [
        ("a/tests/main.rs", "mod one;\npub(crate) mod two;\n"),
        ("a/tests/one.rs", ""),
        ("a/tests/two/mod.rs", "mod three;\n"),
        ("a/tests/two/three.rs", ""),
    ];
    assert_eq!(found(manifest, &whole), none);
    let commented = [("a/tests/main.rs", "// mod one;\n"), ("a/tests/one.rs", "")];
    assert_eq!(found(manifest, &commented), ["a/tests/one.rs"]);
    let deep = [
        ("a/tests/main.rs", "mod two;\n"),
        ("a/tests/two/mod.rs", ""),
        ("a/tests/two/three.rs", ""),
    ];
    assert_eq!(found(manifest, &deep), ["a/tests/two/three.rs"]);
    let two = [("a/tests/one.rs", ""), ("a/tests/two/main.rs", "")];
    assert_eq!(found(searched, &two), ["a/Cargo.toml"]);
    assert_eq!(found(searched, &two[..1]), none);
    let lost = [("a/tests/one.rs", ""), ("a/tests/two/mod.rs", "")];
    assert_eq!(found(searched, &lost), ["a/tests/two/mod.rs"]);
}
