//! Results: written once, whole or not at all, never changed.

use std::fmt::Write as _;
use std::io;
use std::ops::Range;
use std::path::Path as FilePath;
use std::sync::Arc;

use bytes::Bytes;
use futures_util::stream::BoxStream;
use futures_util::{StreamExt as _, TryStreamExt as _};
use object_store::local::LocalFileSystem;
use object_store::path::Path;
use object_store::{Error, GetOptions, ObjectStore, ObjectStoreExt as _, PutMode, PutOptions};
use sha2::{Digest as _, Sha256};

use crate::state::StoredObject;

/// Why a result cannot be stored or had.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// The folder cannot be used.
    #[error("{folder}: {source}")]
    Folder {
        /// The folder.
        folder: String,
        /// The system's reason.
        source: io::Error,
    },
    /// It is not there.
    #[error("{key} is not stored")]
    Missing {
        /// The name.
        key: String,
    },
    /// The store failed.
    #[error("the store of results failed: {0}")]
    Store(String),
}

/// A store of results.
#[derive(Debug, Clone)]
pub struct Results {
    store: Arc<dyn ObjectStore>,
}

impl Results {
    /// Results in a folder, which is made if it is not there.
    ///
    /// # Errors
    /// [`ResultsError::Folder`] and [`ResultsError::Store`].
    pub fn local(folder: &FilePath) -> Result<Self, ResultsError> {
        std::fs::create_dir_all(folder).map_err(|source| ResultsError::Folder {
            folder: folder.display().to_string(),
            source,
        })?;
        let store = LocalFileSystem::new_with_prefix(folder)
            .map_err(|error| ResultsError::Store(error.to_string()))?
            .with_fsync(true);
        Ok(Self {
            store: Arc::new(store),
        })
    }

    /// Results in any store.
    pub fn new(store: Arc<dyn ObjectStore>) -> Self {
        Self { store }
    }

    /// Stores an object under a name that has none yet. Where one is stored already, by an earlier attempt
    /// at the same, that one stays and is the answer.
    ///
    /// # Errors
    /// [`ResultsError::Store`].
    pub async fn put_new(&self, key: &str, bytes: Vec<u8>) -> Result<StoredObject, ResultsError> {
        let object = described(key, &bytes);
        let options = PutOptions {
            mode: PutMode::Create,
            ..PutOptions::default()
        };
        let path = Path::from(key);
        match self.store.put_opts(&path, bytes.into(), options).await {
            Ok(_) => Ok(object),
            Err(Error::AlreadyExists { .. }) => Ok(described(key, &self.get(key).await?)),
            Err(error) => Err(failed(key, &error)),
        }
    }

    /// Whether an object is there with the content that it had.
    ///
    /// # Errors
    /// [`ResultsError::Store`].
    pub async fn is_intact(&self, object: &StoredObject) -> Result<bool, ResultsError> {
        match self.get(&object.key).await {
            Ok(bytes) => Ok(described(&object.key, &bytes) == *object),
            Err(ResultsError::Missing { .. }) => Ok(false),
            Err(other) => Err(other),
        }
    }

    /// A whole object.
    ///
    /// # Errors
    /// [`ResultsError::Missing`] and [`ResultsError::Store`].
    pub async fn get(&self, key: &str) -> Result<Bytes, ResultsError> {
        let got = self.store.get(&Path::from(key)).await;
        let got = got.map_err(|error| failed(key, &error))?;
        got.bytes().await.map_err(|error| failed(key, &error))
    }

    /// Part of an object, piece by piece.
    ///
    /// # Errors
    /// [`ResultsError::Missing`] and [`ResultsError::Store`].
    pub async fn stream(
        &self,
        key: &str,
        range: Range<u64>,
    ) -> Result<BoxStream<'static, io::Result<Bytes>>, ResultsError> {
        if range.is_empty() {
            return Ok(futures_util::stream::empty().boxed());
        }
        let options = GetOptions::new().with_range(Some(range));
        let got = self.store.get_opts(&Path::from(key), options).await;
        let got = got.map_err(|error| failed(key, &error))?;
        Ok(got.into_stream().map_err(io::Error::other).boxed())
    }

    /// Part of an object.
    ///
    /// # Errors
    /// [`ResultsError::Missing`] and [`ResultsError::Store`].
    pub async fn get_range(&self, key: &str, range: Range<u64>) -> Result<Bytes, ResultsError> {
        let got = self.store.get_range(&Path::from(key), range).await;
        got.map_err(|error| failed(key, &error))
    }

    /// Removes an object; one that is not there is no error.
    ///
    /// # Errors
    /// [`ResultsError::Store`].
    pub async fn remove(&self, key: &str) -> Result<(), ResultsError> {
        match self.store.delete(&Path::from(key)).await {
            Ok(()) | Err(Error::NotFound { .. }) => Ok(()),
            Err(error) => Err(failed(key, &error)),
        }
    }
}

fn described(key: &str, bytes: &[u8]) -> StoredObject {
    StoredObject {
        key: key.to_owned(),
        bytes: bytes.len() as u64,
        sha256: sha256(bytes),
    }
}

fn failed(key: &str, error: &Error) -> ResultsError {
    match error {
        Error::NotFound { .. } => ResultsError::Missing {
            key: key.to_owned(),
        },
        other => ResultsError::Store(other.to_string()),
    }
}

/// SHA-256 in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes in hexadecimal.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a string can't fail.
        write!(text, "{byte:02x}").unwrap_or_default();
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_result_is_written_once_and_found_whole() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::local(&folder.path().join("new/results")).unwrap();
        let stored = results
            .put_new("frames/a.png", vec![1, 2, 3])
            .await
            .unwrap();
        let again = results
            .put_new("frames/a.png", vec![1, 2, 3])
            .await
            .unwrap();
        assert_eq!(stored, again);
        let later = results.put_new("frames/a.png", vec![4]).await.unwrap();
        assert_eq!(stored, later, "the first one stays");
        assert_eq!(results.get("frames/a.png").await.unwrap()[..], [1, 2, 3]);
        assert_eq!(
            results.get_range("frames/a.png", 1..2).await.unwrap()[..],
            [2]
        );
        assert!(results.is_intact(&stored).await.unwrap());
        std::fs::write(folder.path().join("new/results/frames/a.png"), [1, 2]).unwrap();
        assert!(!results.is_intact(&stored).await.unwrap(), "it was cut");
        results.remove("frames/a.png").await.unwrap();
        results.remove("frames/a.png").await.unwrap();
        assert!(!results.is_intact(&stored).await.unwrap());
        let missing = results.get("frames/a.png").await;
        assert!(
            matches!(missing, Err(ResultsError::Missing { .. })),
            "{missing:?}"
        );
    }
}
