//! What lies below the techniques knows none of them.

use super::Finding;
use super::source::Source;

/// Folders that techniques are built on.
const BELOW: [&str; 7] = [
    "server/render/src/engine/",
    "server/render/src/gpu_scene/",
    "server/render/src/stages/",
    "shaders/wesl/geometry/",
    "shaders/wesl/lights/",
    "shaders/wesl/medium/",
    "shaders/wesl/stages/",
];

/// Lines of what techniques are built on that name one.
pub fn mentions_techniques(source: &Source) -> Vec<Finding> {
    if !BELOW.iter().any(|folder| source.path.starts_with(folder)) {
        return Vec::new();
    }
    let lines = source.code.lines().enumerate();
    lines
        .filter(|(_, line)| line.contains("techniques::"))
        .map(|(index, _)| Finding {
            path: source.path.clone(),
            line: index + 1,
            message: "names a technique; techniques use what lies here, never the other way".into(),
        })
        .collect()
}
