//! Holds imports to one direction. Tier *none*: needs no device.

use tyndall_tests::conventions::source::{self, Source};
use tyndall_tests::conventions::{assert_none, imports, layers};

/// Crates in which imports have one direction.
const ONE_DIRECTION: [&str; 3] = [
    "server/bench/src/",
    "server/render/src/",
    "server/scene/src/",
];

#[test]
fn every_import_has_one_direction() {
    let sources = source::sources(&source::root()).expect("the repository is readable");
    for root in ONE_DIRECTION {
        assert_none(&imports::circles_of_files(&sources, root));
        assert_none(&imports::circles_of_folders(&sources, root));
    }
}

#[test]
fn every_stage_knows_no_technique() {
    let sources = source::sources(&source::root()).expect("the repository is readable");
    for source in &sources {
        assert_none(&layers::mentions_techniques(source));
    }
}

#[test]
fn plants_stages_that_import_a_technique() {
    for (path, code, findings) in [
        (
            "server/render/src/stages/film.rs",
            "use crate::techniques::reference;",
            1,
        ),
        (
            "server/render/src/engine/pool.rs",
            "fn f() { crate::techniques::of(0); }",
            1,
        ),
        (
            "shaders/wesl/stages/film.wesl",
            "import package::techniques::a::b;",
            1,
        ),
        (
            "server/render/src/stages/film.rs",
            "// crate::techniques::reference",
            0,
        ),
        ("server/render/src/plan.rs", "use crate::techniques;", 0),
    ] {
        let source = Source::new(path, code);
        let found = layers::mentions_techniques(&source);
        assert_eq!(found.len(), findings, "{path}: {code}");
    }
}

#[test]
fn plants_imports_in_a_circle() {
    // `a` declares its child `b` and passes it on to `c`. With what is added to each, so many circles.
    let calls = "pub struct A; fn f() { b::run(); }";
    for (a, b, c, files, folders) in [
        ("", "", "", 0, 0),
        (calls, "", "use crate::{B as D, a};", 0, 0),
        ("pub struct A;", "use super::A;", "", 0, 0),
        (calls, "use super::A;", "", 1, 0),
        (calls, "fn f(_: crate::a::A) {}", "", 1, 0),
        (calls, "vec![super::A];", "", 1, 0),
        ("", "use crate::c::c;", "", 1, 1),
        ("", "use crate::c; fn f() { c::c(); }", "", 1, 1),
        ("", "use crate::{B, c::*};", "", 1, 1),
        ("use crate::c::c;", "", "", 0, 1),
        ("", "#[cfg(test)] mod tests { use crate::c::c; }", "", 0, 0),
        (
            "",
            "// crate::c::c\nconst S: &str = \"crate::c::c\";",
            "",
            0,
            0,
        ),
        ("", "use std::c::c;", "", 0, 0),
    ] {
        let sources = [
            Source::new("x/lib.rs", "mod a; mod c; pub use a::B;"),
            Source::new("x/a/mod.rs", &format!("mod b; pub use b::B; {a}")),
            Source::new("x/a/b.rs", &format!("pub struct B; {b}")),
            Source::new("x/c.rs", &format!("use crate::a::B; pub fn c() {{}} {c}")),
        ];
        let found = imports::circles_of_files(&sources, "x/");
        assert_eq!(found.len(), files, "{a} {b} {c}: {found:?}");
        let found = imports::circles_of_folders(&sources, "x/");
        assert_eq!(found.len(), folders, "{a} {b} {c}: {found:?}");
    }
}
