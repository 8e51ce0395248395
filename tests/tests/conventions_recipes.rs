//! Holds the lists of files in ARCHITECTURE.md to what is in the repository. Tier *none*: needs no device.

use tyndall_tests::conventions::recipes;
use tyndall_tests::conventions::source::{self, Source};

#[test]
fn every_list_of_files_to_add_something_is_true() {
    let sources = source::sources(&source::root()).expect("the repository is readable");
    let document = sources
        .iter()
        .find(|source| source.path == "ARCHITECTURE.md");
    let found = recipes::recipes(document.expect("it is there"), &sources);
    let list: Vec<String> = found.iter().map(ToString::to_string).collect();
    assert!(
        list.is_empty(),
        "{} findings:\n{}",
        list.len(),
        list.join("\n")
    );
}

#[test]
fn plants_files_that_a_list_lacks_or_has_too_many() {
    let sources = [
        Source::new("server/a.rs", "enum E { Spot }"),
        Source::new("server/b/c.rs", "E::Spot => 1"),
        Source::new("server/d.rs", "// Spot only in a comment"),
        Source::new("tests/e.rs", "E::Spot"),
    ];
    let document = |list: &str| {
        let text = format!("## Adding things\n\n**A kind**\n<!-- found by: \\bSpot\\b -->\n{list}");
        Source::new("ARCHITECTURE.md", &text)
    };
    for (list, count) in [
        ("- `server/a.rs`: one\n- `server/b/`: two\n", 0),
        ("- `server/a.rs`: one\n", 1),
        (
            "- `server/a.rs`: one\n- `server/b/c.rs`: two\n- `server/d.rs`: three\n",
            1,
        ),
        ("", 2),
    ] {
        let found = recipes::recipes(&document(list), &sources);
        assert_eq!(found.len(), count, "{list}: {found:?}");
    }
    assert_eq!(
        recipes::recipes(&Source::new("A.md", "## Adding"), &sources).len(),
        1
    );
}
