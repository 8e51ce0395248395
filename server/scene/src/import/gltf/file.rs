//! A file of `geometry`, and the errors of what is wrong in it.

use crate::error::SceneError;

/// A file and the JSON path that names it.
pub(super) struct File<'a> {
    pub(super) path: String,
    /// As the scene names it.
    pub(super) name: &'a str,
}

impl File<'_> {
    /// The error of something wrong at a place in the file.
    pub(super) fn refused(
        &self,
        location: impl Into<String>,
        message: impl Into<String>,
    ) -> SceneError {
        SceneError::Model {
            path: self.path.clone(),
            file: self.name.to_owned(),
            location: location.into(),
            message: message.into(),
        }
    }

    /// The element at `index` of an array of the file.
    pub(super) fn element<'r, T>(
        &self,
        array: &'r [T],
        name: &str,
        index: usize,
        location: &str,
    ) -> Result<&'r T, SceneError> {
        array.get(index).ok_or_else(|| {
            let count = array.len();
            self.refused(
                location,
                format!("{name}[{index}] does not exist, there are {count}"),
            )
        })
    }
}
