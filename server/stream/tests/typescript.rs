//! `web/src/protocol.gen.ts` says what the Rust types say.
//!
//! `TYNDALL_BLESS=1 cargo test -p tyndall-stream typescript` writes the file.

use std::any::TypeId;
use std::collections::{BTreeMap, HashSet};
use std::path::PathBuf;

use ts_rs::{Config, TS, TypeVisitor};
use tyndall_stream::header::{Codec, HEADER_BYTES, HEADER_VERSION};
use tyndall_stream::protocol::{ClientMessage, PROTOCOL_VERSION, ServerMessage};

/// Declarations by name, so that the order in the file does not depend on the order of types.
struct Declarations {
    config: Config,
    seen: HashSet<TypeId>,
    by_name: BTreeMap<String, String>,
}

impl TypeVisitor for Declarations {
    fn visit<T: TS + 'static + ?Sized>(&mut self) {
        if T::output_path().is_none() || !self.seen.insert(TypeId::of::<T>()) {
            return;
        }
        let docs = T::docs().unwrap_or_default();
        let declaration = format!("{docs}export {}\n", T::decl(&self.config));
        let name = T::ident(&self.config);
        let old = self.by_name.insert(name.clone(), declaration);
        assert!(
            old.is_none(),
            "two Rust types are called {name} in TypeScript"
        );
        T::visit_dependencies(self);
    }
}

fn generate() -> String {
    let mut declarations = Declarations {
        config: Config::new().with_large_int("number"),
        seen: HashSet::new(),
        by_name: BTreeMap::new(),
    };
    declarations.visit::<ClientMessage>();
    declarations.visit::<ServerMessage>();
    declarations.visit::<Codec>();
    let body: Vec<String> = declarations.by_name.into_values().collect();
    format!(
        "// Generated from server/stream/src/protocol.rs and server/scene; do not edit.\n\
         // TYNDALL_BLESS=1 cargo test -p tyndall-stream typescript\n\n\
         export const PROTOCOL_VERSION = {PROTOCOL_VERSION};\n\
         export const HEADER_VERSION = {HEADER_VERSION};\n\
         export const HEADER_BYTES = {HEADER_BYTES};\n\
         export const CODEC_JPEG = {};\n\
         export const CODEC_PNG = {};\n\n{}",
        Codec::Jpeg.wire(),
        Codec::Png.wire(),
        body.join("\n")
    )
}

#[test]
fn typescript_types_have_not_drifted() {
    let path = PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../web/src/protocol.gen.ts"
    ));
    let generated = generate();
    if std::env::var_os("TYNDALL_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(&path, &generated).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == generated,
        "web/src/protocol.gen.ts does not match the Rust types; write it with \
         TYNDALL_BLESS=1 cargo test -p tyndall-stream typescript"
    );
}

#[test]
fn large_integers_are_numbers_and_nothing_is_imported() {
    let text = generate();
    assert!(!text.contains("bigint"));
    assert!(!text.contains("import "));
    for name in [
        "ClientMessage",
        "ServerMessage",
        "SceneDescription",
        "SceneEdit",
        "Stats",
    ] {
        assert!(text.contains(&format!("export type {name} =")), "{name}");
    }
}
