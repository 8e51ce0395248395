//! A job with its files, as `multipart/form-data`: a part `job` with the JSON, parts `file` whose file names
//! are paths relative to the scene, and parts `archive`, zip files that are unpacked. In any order.

use std::io::{Seek as _, Write as _};
use std::sync::Arc;

use axum::extract::multipart::{Field, MultipartError};
use axum::extract::{FromRequest as _, Multipart, Request};
use axum::http::StatusCode;
use tyndall_jobs::upload::{Upload, UploadError};
use tyndall_jobs::{JobId, JobRequest};
use tyndall_stream::protocol::ErrorCode;

use crate::problem::Problem;
use crate::server::App;

/// A request and the files that came with it.
pub(super) struct Received {
    pub(super) request: JobRequest,
    pub(super) upload: Option<Upload>,
}

impl Received {
    /// Removes the files: they are no job's.
    pub(super) async fn discard(self) {
        if let Some(upload) = self.upload {
            discard(upload).await;
        }
    }
}

async fn discard(upload: Upload) {
    if let Err(error) = tokio::fs::remove_dir_all(upload.folder()).await {
        tracing::warn!(%error, "an upload that is no job's cannot be removed");
    }
}

impl From<UploadError> for Problem {
    fn from(error: UploadError) -> Self {
        let code = match &error {
            UploadError::Name { .. } | UploadError::Archive(_) | UploadError::Decoder(_) => {
                ErrorCode::InvalidUpload
            }
            UploadError::TooLarge { .. } => ErrorCode::TooLarge,
            UploadError::Io(_) => ErrorCode::StorageFailed,
        };
        Self::new(code, error.to_string())
    }
}

/// Receives into the folder of the job to be.
pub(super) async fn receive(
    app: &Arc<App>,
    id: &JobId,
    request: Request,
) -> Result<Received, Problem> {
    let full = "as many uploads as may be are being received";
    let permit = app.jobs.uploading.try_acquire();
    let _permit = permit.map_err(|_full| Problem::new(ErrorCode::QueueFull, full))?;
    let multipart = Multipart::from_request(request, &()).await;
    let mut multipart =
        multipart.map_err(|rejection| Problem::new(ErrorCode::Malformed, rejection.body_text()))?;
    let mut upload = Upload::new(app.jobs.upload_folder(id), app.jobs.upload_limits())?;
    match read(app, &mut multipart, &mut upload).await {
        Ok(request) => Ok(Received {
            request,
            upload: Some(upload),
        }),
        Err(problem) => {
            discard(upload).await;
            Err(problem)
        }
    }
}

async fn read(
    app: &Arc<App>,
    multipart: &mut Multipart,
    upload: &mut Upload,
) -> Result<JobRequest, Problem> {
    let mut request = None;
    while let Some(field) = within(app, multipart.next_field()).await? {
        match field.name().unwrap_or_default() {
            "job" if request.is_none() => request = Some(job(app, field).await?),
            "file" => file(app, field, upload).await?,
            "archive" => archive(app, field, upload).await?,
            other => {
                let other: String = other.chars().take(80).filter(|c| !c.is_control()).collect();
                let detail =
                    format!("a part \"{other}\": allowed are one job, and file and archive");
                return Err(Problem::new(ErrorCode::Malformed, detail));
            }
        }
    }
    let missing = "the part \"job\" with the JSON of the job is missing";
    request.ok_or_else(|| Problem::new(ErrorCode::Malformed, missing))
}

/// Waits for the next piece of a body, each within the time of a whole short one.
async fn within<T>(
    app: &App,
    next: impl Future<Output = Result<T, MultipartError>>,
) -> Result<T, Problem> {
    let limit = app.limits.body_within;
    let next = tokio::time::timeout(limit, next)
        .await
        .map_err(|_elapsed| {
            let detail = format!(
                "nothing of the body arrived within {} s",
                limit.as_secs_f32()
            );
            Problem::new(ErrorCode::TookTooLong, detail)
        })?;
    next.map_err(|error| {
        let code = if error.status() == StatusCode::PAYLOAD_TOO_LARGE {
            ErrorCode::TooLarge
        } else {
            ErrorCode::Malformed
        };
        Problem::new(code, error.body_text())
    })
}

async fn job(app: &App, mut field: Field<'_>) -> Result<JobRequest, Problem> {
    let most = app.limits.max_body_bytes;
    let mut text = Vec::new();
    while let Some(piece) = within(app, field.chunk()).await? {
        if text.len() + piece.len() > most {
            let detail = format!("at most {most} bytes of JSON are read");
            return Err(Problem::new(ErrorCode::TooLarge, detail));
        }
        text.extend_from_slice(&piece);
    }
    let text = String::from_utf8(text)
        .map_err(|_not_text| Problem::new(ErrorCode::Malformed, "the job is not UTF-8 text"))?;
    JobRequest::parse(&text).map_err(|error| Problem::from(&error))
}

async fn file(app: &App, mut field: Field<'_>, upload: &mut Upload) -> Result<(), Problem> {
    let name = field.file_name().unwrap_or_default().to_owned();
    let mut receiving = upload.begin(&name)?;
    while let Some(piece) = within(app, field.chunk()).await? {
        // Pieces are short; the page cache takes them.
        receiving.write(&piece)?;
    }
    Ok(receiving.finish()?)
}

async fn archive(app: &App, mut field: Field<'_>, upload: &mut Upload) -> Result<(), Problem> {
    let most = app.jobs.upload_limits().bytes;
    let failed = |error: std::io::Error| Problem::new(ErrorCode::StorageFailed, error.to_string());
    let mut archive = tempfile::tempfile_in(app.jobs.passing_folder()).map_err(failed)?;
    let mut length = 0_u64;
    while let Some(piece) = within(app, field.chunk()).await? {
        length += piece.len() as u64;
        if length > most {
            let detail = format!("the archive is longer than {most} bytes");
            return Err(Problem::new(ErrorCode::TooLarge, detail));
        }
        archive.write_all(&piece).map_err(failed)?;
    }
    archive.rewind().map_err(failed)?;
    // Unpacking takes long enough to need a thread that may block.
    tokio::task::block_in_place(|| upload.unpack(archive, length))?;
    Ok(())
}
