//! A union of messages tagged by `type`, whose parse errors keep their exact path.
//!
//! Serde's own internal tagging buffers the message and loses the path inside it, so the tag comes off
//! the parsed object first and picks the type of the rest.

/// Defines an enum of messages from one line a message: its tag, its variant, what it carries.
macro_rules! messages {
    (
        $(#[$meta:meta])*
        pub enum $name:ident {
            $($(#[$variant_meta:meta])* $tag:literal => $variant:ident($inner:ty)),+ $(,)?
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize, ts_rs::TS)]
        #[serde(tag = "type")]
        #[allow(
            clippy::large_enum_variant,
            reason = "messages are taken one at a time and never kept"
        )]
        pub enum $name {
            $($(#[$variant_meta])* #[serde(rename = $tag)] $variant($inner)),+
        }

        impl $name {
            /// Every tag.
            const TAGS: &[&str] = &[$($tag),+];

            /// Takes the tag out of a parsed object and reads the rest as what it stands for.
            fn from_members(
                mut members: serde_json::Map<String, serde_json::Value>,
            ) -> Result<Self, tyndall_scene::SceneError> {
                let tag = members.remove("type").unwrap_or_default();
                let rest = serde_json::Value::Object(members);
                match tag.as_str() {
                    $(Some($tag) => tyndall_scene::parse_value(rest).map(Self::$variant),)+
                    _ => Err(tyndall_scene::SceneError::Invalid {
                        path: "type".to_owned(),
                        found: tag.to_string().chars().take(80).collect(),
                        allowed: format!("one of {}", Self::TAGS.join(", ")),
                    }),
                }
            }
        }
    };
}
pub(crate) use messages;
