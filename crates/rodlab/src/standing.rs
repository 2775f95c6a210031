//! The four standings of a test, each with its word.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Standing of a test. It has the same word on the terminal, in reports, summaries and files, and
/// determines the exit status.
///
/// The standings are ordered by severity, and a campaign has the standing of its worst test.
///
/// | standing | word | exit status |
/// |---|---|---|
/// | [`Answered`](Self::Answered) | `answered` | 0 |
/// | [`InDoubt`](Self::InDoubt) | `in doubt` | 3 |
/// | [`NotAllowed`](Self::NotAllowed) | `not allowed` | 1 |
/// | [`WrongInput`](Self::WrongInput) | `wrong input` | 2 |
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Standing {
    /// The data allow an answer, and every check passes.
    #[serde(rename = "answered")]
    Answered,
    /// There is an answer, but a check fails.
    #[serde(rename = "in doubt")]
    InDoubt,
    /// The data do not allow an answer.
    #[serde(rename = "not allowed")]
    NotAllowed,
    /// The sheet, a file or a folder is wrong, so there is no result.
    #[serde(rename = "wrong input")]
    WrongInput,
}

impl Standing {
    /// All four standings, from best to worst.
    pub const ALL: [Self; 4] = [
        Self::Answered,
        Self::InDoubt,
        Self::NotAllowed,
        Self::WrongInput,
    ];

    /// Returns the word for the standing.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Answered => "answered",
            Self::InDoubt => "in doubt",
            Self::NotAllowed => "not allowed",
            Self::WrongInput => "wrong input",
        }
    }

    /// Returns the exit status of a program with this standing.
    #[must_use]
    pub fn exit_status(self) -> u8 {
        match self {
            Self::Answered => 0,
            Self::InDoubt => 3,
            Self::NotAllowed => 1,
            Self::WrongInput => 2,
        }
    }
}

impl fmt::Display for Standing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r11_a_standing_is_written_and_read_as_its_word() {
        for standing in Standing::ALL {
            let text = serde_json::to_string(&standing).unwrap();
            assert_eq!(text, format!("\"{}\"", standing.word()));
            assert_eq!(serde_json::from_str::<Standing>(&text).unwrap(), standing);
        }
        let error = serde_json::from_str::<Standing>("\"in_doubt\"").unwrap_err();
        assert!(
            error
                .to_string()
                .contains("expected one of `answered`, `in doubt`")
        );
    }

    #[test]
    fn r11_a_wrong_sheet_is_worse_than_data_that_do_not_allow_a_result_and_these_than_doubt() {
        let worst = |of: &[Standing]| of.iter().max().map(|standing| standing.exit_status());
        use Standing::{Answered, InDoubt, NotAllowed, WrongInput};
        assert_eq!(worst(&[Answered, InDoubt, Answered]), Some(3));
        assert_eq!(worst(&[InDoubt, NotAllowed]), Some(1));
        assert_eq!(worst(&[WrongInput, InDoubt, NotAllowed]), Some(2));
        assert_eq!(worst(&[Answered]), Some(0));
    }
}
