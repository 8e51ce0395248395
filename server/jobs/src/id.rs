//! Names of jobs: sortable by time, unguessable.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Digits of a name.
const DIGITS: usize = 32;

/// Name of a job: 12 hexadecimal digits of the time in ms, then 20 random ones.
#[derive(
    Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(try_from = "String", into = "String")]
#[schemars(extend("pattern" = "^[0-9a-f]{32}$"))]
pub struct JobId(String);

/// A text that names no job.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a job's name has {DIGITS} hexadecimal digits in lower case")]
pub struct NoJobId;

impl JobId {
    /// A new name at a time. Unit: ms since 1970.
    ///
    /// # Errors
    /// When the system has no random numbers.
    pub fn new(now: u64) -> Result<Self, getrandom::Error> {
        let mut random = [0; 10];
        getrandom::fill(&mut random)?;
        let digits = random.iter().map(|byte| format!("{byte:02x}"));
        let time = now & 0xffff_ffff_ffff;
        Ok(Self(format!("{time:012x}{}", digits.collect::<String>())))
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for JobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromStr for JobId {
    type Err = NoJobId;

    fn from_str(text: &str) -> Result<Self, NoJobId> {
        let digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        if text.len() == DIGITS && text.bytes().all(digit) {
            Ok(Self(text.to_owned()))
        } else {
            Err(NoJobId)
        }
    }
}

impl TryFrom<String> for JobId {
    type Error = NoJobId;

    fn try_from(text: String) -> Result<Self, NoJobId> {
        text.parse()
    }
}

impl From<JobId> for String {
    fn from(id: JobId) -> Self {
        id.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_sort_by_time_and_only_names_are_read() {
        let (first, second) = (JobId::new(1000).unwrap(), JobId::new(2000).unwrap());
        assert!(first < second);
        assert_eq!(first.as_str().parse(), Ok(first.clone()));
        for other in ["", "../../etc/passwd", "ABCDEF0123456789ABCDEF0123456789"] {
            assert_eq!(other.parse::<JobId>(), Err(NoJobId), "{other}");
        }
    }
}
