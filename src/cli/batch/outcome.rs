//! The result of a job.

use std::time::Duration;

use marraztu_io::LoadError;
use serde::{Deserialize, Serialize};

use super::dataset::DatasetImage;
use super::jobs::Job;
use super::tars::Member;
use crate::cli::cameras::CameraFrame;
use crate::cli::failure::Failure;

/// The status of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Status {
    /// The picture is there.
    Done,
    /// The model or the options cannot be drawn. Another attempt gives the same result.
    Invalid,
    /// The picture could not be written, or the program failed.
    Failed,
    /// The time limit was reached.
    Timeout,
    /// The batch ended before.
    Cancelled,
}

/// The reason why there is no picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The model or the options are invalid.
    Input(String),
    /// The picture could not be written.
    Output(String),
    /// The program failed.
    Program(String),
    /// Reading or drawing this file took longer than the time limit.
    Timeout(String),
    /// The batch ended.
    Cancelled,
}

impl Fault {
    /// Classifies the failure of a command.
    pub(super) fn of(failure: &Failure) -> Self {
        match failure {
            Failure::Load(LoadError::Cancelled) => Self::Cancelled,
            Failure::Save(_) | Failure::Write(..) | Failure::Output(_) => {
                Self::Output(failure.to_string())
            }
            Failure::Measure(_) | Failure::Plot(_) => Self::Program(failure.to_string()),
            #[cfg(feature = "desktop")]
            Failure::Start(_) => Self::Program(failure.to_string()),
            #[cfg(feature = "desktop")]
            Failure::Unparsed(_) => Self::Input(failure.to_string()),
            Failure::Usage(_)
            | Failure::Told
            | Failure::Status(_)
            | Failure::Absent(_)
            | Failure::Load(_)
            | Failure::Scene(_)
            | Failure::Refused(_) => Self::Input(failure.to_string()),
        }
    }

    /// Returns the status of a picture with this fault.
    pub(super) const fn status(&self) -> Status {
        match self {
            Self::Input(_) => Status::Invalid,
            Self::Output(_) | Self::Program(_) => Status::Failed,
            Self::Timeout(_) => Status::Timeout,
            Self::Cancelled => Status::Cancelled,
        }
    }

    /// Returns the reason for a report.
    pub(super) fn reason(&self) -> String {
        match self {
            Self::Input(reason) | Self::Output(reason) => reason.clone(),
            Self::Program(reason) => format!("the program failed: {reason}"),
            Self::Timeout(file) => format!("{file}: the time limit was reached"),
            Self::Cancelled => "the batch ended before".to_owned(),
        }
    }
}

/// A finished picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Drawn {
    /// The files; the first one has the name of the picture.
    pub(super) files: Vec<FileSum>,
    /// The camera, if the picture has layers.
    pub(super) camera: Option<Box<CameraFrame>>,
    /// The entries in the tables of a data set.
    pub(super) image: Option<Box<DatasetImage>>,
    /// The findings of the model, if a report needs them.
    pub(super) findings: Vec<String>,
    /// The files in an archive.
    pub(super) members: Vec<Member>,
    /// Whether an earlier run has drawn it.
    pub(super) unchanged: bool,
}

/// A file of a picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct FileSum {
    pub(super) out: String,
    /// The SHA-256, if a report needs it.
    #[serde(rename = "out_sha256")]
    pub(super) sha256: Option<String>,
    pub(super) bytes: u64,
}

/// The time that a picture took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Spent {
    /// Reading files.
    pub(super) load: Duration,
    /// Drawing.
    pub(super) draw: Duration,
    /// Encoding and writing.
    pub(super) encode: Duration,
}

impl Outcome {
    /// Returns the result of a job that the end of the batch has prevented.
    pub(super) fn cancelled(job: Job) -> Self {
        let result = Err(Fault::Cancelled);
        Self { job, result, in_sha256: None, spent: Spent::default() }
    }
}

/// The result of a job.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub(super) job: Job,
    pub(super) result: Result<Drawn, Fault>,
    /// The SHA-256 of the model, if a report needs it and it could be read.
    pub(super) in_sha256: Option<String>,
    pub(super) spent: Spent,
}
