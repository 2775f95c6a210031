//! Origin of samples, so that a result can be traced to the bytes it was computed from.

use std::fmt;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// SHA-256 of the bytes of a file: equal hashes mean equal files.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct ContentHash([u8; 32]);

impl ContentHash {
    /// Computes the hash of `bytes`.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        Self(Sha256::digest(bytes).into())
    }

    /// The 32 bytes of the hash.
    #[must_use]
    pub fn bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ContentHash({self})")
    }
}

/// Origin of the samples of a record.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Provenance {
    /// Read from a file.
    File {
        /// Path as given.
        path: PathBuf,
        /// Name of the format, for example `npy`.
        format: &'static str,
        /// Hash of all bytes of the file, if they were in memory together.
        hash: Option<ContentHash>,
    },
    /// Read from bytes without a name.
    Bytes {
        /// Name of the format.
        format: &'static str,
        /// Hash of the bytes, if they were in memory together.
        hash: Option<ContentHash>,
    },
    /// Computed.
    Computed {
        /// Name of the generator, which must not use the same method as the inversion of the
        /// record.
        generator: String,
    },
}

impl Provenance {
    /// Creates the provenance of a computed record with the name of its generator.
    #[must_use]
    pub fn computed(generator: impl Into<String>) -> Self {
        Self::Computed {
            generator: generator.into(),
        }
    }

    /// Creates the provenance of bytes without a name, with their hash.
    #[must_use]
    pub fn of_bytes(format: &'static str, bytes: &[u8]) -> Self {
        Self::Bytes {
            format,
            hash: Some(ContentHash::of(bytes)),
        }
    }

    /// Creates the provenance of a file with the hash of its `bytes`.
    #[must_use]
    pub fn of_file(path: &Path, format: &'static str, bytes: &[u8]) -> Self {
        Self::of_bytes(format, bytes).found_at(path)
    }

    /// Creates the provenance of a file that is read in parts and has no hash.
    #[must_use]
    pub fn file(path: &Path, format: &'static str) -> Self {
        Self::File {
            path: path.to_path_buf(),
            format,
            hash: None,
        }
    }

    /// Replaces the variant for bytes by that for the file at `path`; other variants are unchanged.
    #[must_use]
    pub fn found_at(self, path: &Path) -> Self {
        match self {
            Self::Bytes { format, hash } => Self::File {
                path: path.to_path_buf(),
                format,
                hash,
            },
            other => other,
        }
    }

    /// The hash of the bytes, if there is one.
    #[must_use]
    pub fn hash(&self) -> Option<ContentHash> {
        match self {
            Self::File { hash, .. } | Self::Bytes { hash, .. } => *hash,
            Self::Computed { .. } => None,
        }
    }
}

impl fmt::Display for Provenance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { path, format, .. } => write!(f, "{} ({format})", path.display())?,
            Self::Bytes { format, .. } => write!(f, "bytes ({format})")?,
            Self::Computed { generator } => write!(f, "computed by {generator}")?,
        }
        match self.hash() {
            Some(hash) => write!(f, ", sha256 {hash}"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_sha_256() {
        // the one-block message from the examples of FIPS 180-4
        assert_eq!(
            ContentHash::of(b"abc").to_string(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }

    #[test]
    fn bytes_keep_their_hash_when_their_file_is_named() {
        let path = Path::new("tests/hit_1.npy");
        let named = Provenance::of_bytes("npy", b"abc").found_at(path);
        assert_eq!(named, Provenance::of_file(path, "npy", b"abc"));
        assert_ne!(named, Provenance::of_file(path, "npy", b"abd"));
        let text = named.to_string();
        assert!(
            text.starts_with("tests/hit_1.npy (npy), sha256 ba78"),
            "{text}"
        );
    }
}
