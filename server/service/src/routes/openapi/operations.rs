//! Each operation with what it takes and answers.

use schemars::generate::SchemaGenerator;
use serde_json::{Value, json};
use tyndall_jobs::JobRequest;
use tyndall_scene::SceneDescription;

use super::{Operation, content, in_header, in_path, of_type, query};
use crate::jobs::{JobPage, JobResult, JobStatus};
use crate::routes::jobs::{CreateParameters, Created, ListParameters};

/// Names of jobs.
const JOB: &str = "^[0-9a-f]{32}$";
/// Names of files and presets.
const NAME: &str = "^[0-9A-Za-z_.]+$";

pub(super) fn all(schemas: &mut SchemaGenerator) -> Vec<Operation> {
    let mut all = jobs(schemas);
    all.extend(results(schemas));
    all.extend(scenes(schemas));
    all.extend(server());
    all
}

fn job() -> Value {
    in_path("id", "The job", JOB)
}

fn jobs(schemas: &mut SchemaGenerator) -> Vec<Operation> {
    let request = schemas.subschema_for::<JobRequest>().to_value();
    let files = json!({ "type": "array", "items": { "type": "string", "format": "binary" } });
    let body = json!({
        "required": true,
        "content": {
            "application/json": { "schema": request },
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["job"],
                    "additionalProperties": false,
                    "properties": { "job": request, "file": files, "archive": files },
                },
                "encoding": { "job": { "contentType": "application/json" } },
            },
        },
    });
    let mut create = query::<CreateParameters>(schemas);
    let mut key = in_header(
        "Idempotency-Key",
        "The same request with the same key is accepted once only",
    );
    key["schema"] = json!({ "type": "string", "pattern": "^[ -~]{1,255}$" });
    create.push(key);
    let mut accepted = of_type::<Created>(schemas, "The job is queued");
    accepted["headers"] = json!({ "Location": {
        "description": "Where the job is", "schema": { "type": "string" } } });
    vec![
        Operation {
            method: "post",
            path: "/v1/jobs",
            id: "createJob",
            tag: "jobs",
            summary: "Renders a scene in the background; its files come as parts of a form",
            parameters: create,
            body: Some(body),
            answers: vec![
                (
                    200,
                    of_type::<Created>(schemas, "The job would be accepted"),
                ),
                (202, accepted),
            ],
        },
        Operation {
            method: "get",
            path: "/v1/jobs",
            id: "listJobs",
            tag: "jobs",
            summary: "Lists jobs, newest first",
            parameters: query::<ListParameters>(schemas),
            body: None,
            answers: vec![(200, of_type::<JobPage>(schemas, "A part of the list"))],
        },
        Operation {
            method: "get",
            path: "/v1/jobs/{id}",
            id: "getJob",
            tag: "jobs",
            summary: "Tells how a job stands",
            parameters: vec![job()],
            body: None,
            answers: vec![(200, of_type::<JobStatus>(schemas, "The job"))],
        },
        Operation {
            method: "delete",
            path: "/v1/jobs/{id}",
            id: "cancelJob",
            tag: "jobs",
            summary: "Cancels a job, unless it is over; what there is of it is kept",
            parameters: vec![job()],
            body: None,
            answers: vec![(200, of_type::<JobStatus>(schemas, "The job"))],
        },
    ]
}

fn results(schemas: &mut SchemaGenerator) -> Vec<Operation> {
    let binary = json!({ "type": "string", "format": "binary" });
    let file = |description: &str| content(description, "*/*", &binary);
    let text = json!({ "type": "string" });
    let empty = |description: &str| json!({ "description": description });
    vec![
        Operation {
            method: "get",
            path: "/v1/jobs/{id}/events",
            id: "streamJobEvents",
            tag: "jobs",
            summary: "Tells how a job stands as it changes, until it is over",
            parameters: vec![
                job(),
                in_header("Last-Event-ID", "The event that was seen last"),
            ],
            body: None,
            answers: vec![
                (
                    200,
                    content(
                        "Events `status`, each a whole status",
                        "text/event-stream",
                        &text,
                    ),
                ),
                (204, empty("The job is over and its last event was seen")),
            ],
        },
        Operation {
            method: "get",
            path: "/v1/jobs/{id}/preview",
            id: "getJobPreview",
            tag: "jobs",
            summary: "Shows the picture that is being made",
            parameters: vec![job()],
            body: None,
            answers: vec![(200, content("The picture", "image/jpeg", &binary))],
        },
        Operation {
            method: "get",
            path: "/v1/jobs/{id}/results",
            id: "listJobResults",
            tag: "jobs",
            summary: "Lists the files of a job",
            parameters: vec![job()],
            body: None,
            answers: vec![(200, of_type::<Vec<JobResult>>(schemas, "The files"))],
        },
        Operation {
            method: "get",
            path: "/v1/jobs/{id}/results/{name}",
            id: "getJobResult",
            tag: "jobs",
            summary: "Gives a file of a job, or a range of it",
            parameters: vec![
                job(),
                in_path("name", "The file", NAME),
                in_header("Range", "Bytes that are wanted, such as bytes=0-99"),
                in_header("If-None-Match", "The tag of the file that is there already"),
                in_header("If-Range", "The tag of the file that the range is of"),
            ],
            body: None,
            answers: vec![
                (200, file("The file")),
                (206, file("The range")),
                (304, empty("It is there already")),
            ],
        },
    ]
}

fn scenes(schemas: &mut SchemaGenerator) -> Vec<Operation> {
    let object = json!({ "type": "object" });
    let plan = || content("Passes and their reasons", "application/json", &object);
    let scene = schemas.subschema_for::<SceneDescription>().to_value();
    let array = json!({ "type": "array", "items": object });
    let preset = json!({ "name": "preset", "in": "query", "required": true,
        "schema": { "type": "string" } });
    vec![
        Operation {
            method: "get",
            path: "/v1/presets",
            id: "listPresets",
            tag: "scenes",
            summary: "Lists the built-in scenes",
            parameters: Vec::new(),
            body: None,
            answers: vec![(200, content("The scenes", "application/json", &array))],
        },
        Operation {
            method: "get",
            path: "/v1/presets/{name}",
            id: "getPreset",
            tag: "scenes",
            summary: "Gives a built-in scene",
            parameters: vec![in_path("name", "The scene", NAME)],
            body: None,
            answers: vec![(200, content("The scene", "application/json", &object))],
        },
        Operation {
            method: "get",
            path: "/v1/plan",
            id: "planPreset",
            tag: "scenes",
            summary: "Tells which passes a built-in scene needs, and why",
            parameters: vec![preset],
            body: None,
            answers: vec![(200, plan())],
        },
        Operation {
            method: "post",
            path: "/v1/plan",
            id: "planScene",
            tag: "scenes",
            summary: "Tells which passes a scene needs, and why",
            parameters: Vec::new(),
            body: Some(json!({
                "required": true, "content": { "application/json": { "schema": scene } } })),
            answers: vec![(200, plan())],
        },
        Operation {
            method: "get",
            path: "/v1/schema",
            id: "getSceneSchema",
            tag: "scenes",
            summary: "Gives the JSON Schema of scenes",
            parameters: Vec::new(),
            body: None,
            answers: vec![(
                200,
                content("The schema", "application/schema+json", &object),
            )],
        },
    ]
}

fn server() -> Vec<Operation> {
    let object = json!({ "type": "object" });
    let text = json!({ "type": "string" });
    let plain = |description: &str| content(description, "text/plain", &text);
    let simple = |path, id, summary, status, answer| Operation {
        method: "get",
        path,
        id,
        tag: "server",
        summary,
        parameters: Vec::new(),
        body: None,
        answers: vec![(status, answer)],
    };
    vec![
        simple(
            "/v1/access",
            "getAccess",
            "Says whether the token is right",
            204,
            json!({ "description": "It is" }),
        ),
        simple(
            "/version",
            "getVersion",
            "Says what runs here",
            200,
            content("Version and adapter", "application/json", &object),
        ),
        simple(
            "/livez",
            "getLiveness",
            "Says that the process lives",
            200,
            plain("It lives"),
        ),
        simple(
            "/readyz",
            "getReadiness",
            "Says whether there is a device to render on",
            200,
            plain("There is"),
        ),
        simple(
            "/metrics",
            "getMetrics",
            "Gives what is counted, for Prometheus",
            200,
            plain("Counters, gauges and histograms"),
        ),
    ]
}
