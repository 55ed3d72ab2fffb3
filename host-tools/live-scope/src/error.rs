//! Why a wish is not done, a recording is not all there, or a device is gone.

use bench::NoModel;
use device_link::LinkError;
use device_link::told::ToldError;
use remedy::sentence;
use std::io;
use std::path::PathBuf;

/// Why a wish is not done.
#[derive(Debug, thiserror::Error)]
pub enum Undone {
    /// A recording is under way.
    #[error("{} is being recorded", path.display())]
    Recording {
        /// Where it will be.
        path: PathBuf,
    },
    /// No recording can begin.
    #[error("{}: no recording can be written there: {error}", folder.display())]
    NoRecording {
        /// Where recordings go.
        folder: PathBuf,
        /// What the operating system says.
        error: io::Error,
    },
    /// The recording that was to end is not all there.
    #[error(transparent)]
    Unkept(#[from] Unkept),
    /// There is no displacement to be called anything.
    #[error(transparent)]
    NoModel(#[from] NoModel),
    /// The link fails, or the device refuses.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The device does something else, in words.
    #[error("{0}")]
    NotEstimating(String),
    /// The device was not told its displacement.
    #[error(transparent)]
    Told(#[from] ToldError),
    /// Another wish is being done.
    #[error("it was not done, since the device is busy with another wish: ask again")]
    Busy,
    /// Nobody has said so in time.
    #[error("the device is busy, and whether it was done is unknown: look, and ask again if not")]
    Unknown,
    /// There is no device.
    #[error(transparent)]
    Gone(#[from] Gone),
}

impl Undone {
    /// The sentence that the user reads.
    pub fn told(&self) -> String {
        match self {
            Self::NoModel(error) => sentence(error),
            Self::Link(error) => sentence(error),
            Self::Told(error) => sentence(error),
            _ => self.to_string(),
        }
    }
}

/// Why a recording is not all there.
#[derive(Debug, thiserror::Error)]
pub enum Unkept {
    /// Nothing of it is.
    #[error("{}: cannot be written: {error}", path.display())]
    Lost {
        /// Where it was to be.
        path: PathBuf,
        /// What the operating system says.
        error: io::Error,
    },
    /// Its end is missing.
    #[error("{}: cannot be written: {error}; {} holds what was written until then", path.display(), kept.display())]
    Cut {
        /// Where it was to be.
        path: PathBuf,
        /// What the operating system says.
        error: io::Error,
        /// Where the rest is.
        kept: PathBuf,
    },
}

/// There is no device to be shown.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub struct Gone(
    /// Why, as the sentence that the user reads.
    pub String,
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_other_parts_find_wrong_comes_with_its_remedy() {
        let port = "tcp:127.0.0.1:4740".parse().unwrap();
        let silent = Undone::from(LinkError::Silent { port });
        assert!(silent.told().contains("`piezo flash`") && !silent.to_string().contains("`piezo flash`"), "{silent}");
        assert!(Undone::from(NoModel).told().ends_with("`piezo install` make one"));
        assert_eq!(Undone::Busy.told(), Undone::Busy.to_string());
    }
}
