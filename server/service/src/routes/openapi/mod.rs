//! `/openapi.json`: what this server answers, made from the types that it reads and writes; `/docs` shows it
//! without any other server.

mod operations;

use std::sync::LazyLock;

use aide::redoc::Redoc;
use axum::Json;
use axum::http::header;
use axum::response::{Html, IntoResponse};
use schemars::JsonSchema;
use schemars::generate::{SchemaGenerator, SchemaSettings};
use serde::Serialize;
use serde_json::{Map, Value, json};

/// An error as `application/problem+json` (RFC 9457).
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Problem")]
struct ProblemDocument {
    /// Stable name of the cause.
    code: String,
    /// The cause in words, the same for every occurrence.
    title: String,
    /// HTTP status.
    #[schemars(range(min = 400, max = 599))]
    status: u16,
    /// This occurrence in one sentence.
    detail: String,
    /// JSON path of what is wrong, where there is one.
    path: Option<String>,
}

static DOCUMENT: LazyLock<Value> = LazyLock::new(document);
/// The page without its script, and the script: browsers are told to run none that stands in a page.
static PAGE: LazyLock<(String, String)> = LazyLock::new(|| {
    const START: &str = "<script>";
    const END: &str = "</script>";
    let html = Redoc::new("/openapi.json").with_title("Tyndall").html();
    let parts = html
        .split_once(START)
        .and_then(|(before, rest)| Some((before, rest.rsplit_once(END)?)));
    let Some((before, (script, after))) = parts else {
        return (html, String::new());
    };
    let page = format!("{before}<script src=\"/docs.js\"></script>{after}");
    (page, script.to_owned())
});

/// The document: `GET /openapi.json`.
pub(super) async fn json() -> Json<&'static Value> {
    Json(&DOCUMENT)
}

/// The document for people: `GET /docs`.
pub(super) async fn page() -> Html<&'static str> {
    Html(&PAGE.0)
}

/// What shows it: `GET /docs.js`.
pub(super) async fn script() -> impl IntoResponse {
    let kind = "text/javascript; charset=utf-8";
    ([(header::CONTENT_TYPE, kind)], PAGE.1.as_str())
}

/// An operation: a method of a path.
struct Operation {
    method: &'static str,
    path: &'static str,
    /// Stable: generated clients call it so.
    id: &'static str,
    tag: &'static str,
    summary: &'static str,
    /// Parameters in the query, in the path and in headers.
    parameters: Vec<Value>,
    body: Option<Value>,
    /// Answers by status, besides problems.
    answers: Vec<(u16, Value)>,
}

fn document() -> Value {
    let mut settings = SchemaSettings::draft2020_12();
    settings.definitions_path = "/components/schemas".into();
    settings.meta_schema = None;
    let mut schemas = settings.into_generator();
    let problem = schemas.subschema_for::<ProblemDocument>().to_value();
    let default = json!({
        "description": "What went wrong",
        "content": { "application/problem+json": { "schema": problem } },
    });
    let mut paths = Map::new();
    for operation in operations::all(&mut schemas) {
        let answers = operation.answers.into_iter();
        let mut responses: Map<String, Value> = answers
            .map(|(status, answer)| (status.to_string(), answer))
            .collect();
        responses.insert("default".to_owned(), default.clone());
        let mut described = json!({
            "operationId": operation.id,
            "tags": [operation.tag],
            "summary": operation.summary,
            "responses": responses,
        });
        if !operation.parameters.is_empty() {
            described["parameters"] = operation.parameters.into();
        }
        if let Some(body) = operation.body {
            described["requestBody"] = body;
        }
        let path = paths.entry(operation.path).or_insert_with(|| json!({}));
        path[operation.method] = described;
    }
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "Tyndall",
            "version": env!("CARGO_PKG_VERSION"),
            "summary": "Renders participating media",
            "license": { "name": "MIT OR Apache-2.0", "identifier": "MIT OR Apache-2.0" },
        },
        "tags": [
            { "name": "jobs", "description": "Pictures and animations, rendered in the background" },
            { "name": "scenes", "description": "Built-in scenes, their format, and what they would do" },
            { "name": "server", "description": "What runs here, and whether it is well" },
        ],
        "security": [{}, { "token": [] }],
        "paths": paths,
        "components": {
            "schemas": schemas.take_definitions(true),
            "securitySchemes": { "token": { "type": "http", "scheme": "bearer" } },
        },
    })
}

/// An answer with a JSON body.
fn of_type<T: JsonSchema>(schemas: &mut SchemaGenerator, description: &str) -> Value {
    let schema = schemas.subschema_for::<T>().to_value();
    content(description, "application/json", &schema)
}

/// An answer with a body of a media type.
fn content(description: &str, kind: &str, schema: &Value) -> Value {
    json!({ "description": description, "content": { kind: { "schema": schema } } })
}

/// The parameters in a query that is read as this type.
fn query<T: JsonSchema>(schemas: &mut SchemaGenerator) -> Vec<Value> {
    let schema = schemas.root_schema_for::<T>().to_value();
    let properties = schema["properties"]
        .as_object()
        .cloned()
        .unwrap_or_default();
    let parameter = |(name, mut schema): (String, Value)| {
        let description = schema
            .as_object_mut()
            .and_then(|schema| schema.remove("description"));
        let description = description.unwrap_or_else(|| "".into());
        json!({ "name": name, "in": "query", "required": false,
            "description": description, "schema": schema })
    };
    properties.into_iter().map(parameter).collect()
}

/// A part of the path.
fn in_path(name: &str, description: &str, pattern: &str) -> Value {
    json!({
        "name": name, "in": "path", "required": true, "description": description,
        "schema": { "type": "string", "pattern": pattern },
    })
}

/// A header of the request.
fn in_header(name: &str, description: &str) -> Value {
    json!({
        "name": name, "in": "header", "required": false, "description": description,
        "schema": { "type": "string" },
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_document_is_openapi_with_one_name_for_each_operation() {
        let document = document();
        let text = document.to_string();
        let parsed: aide::openapi::OpenApi = serde_json::from_str(&text).unwrap();
        assert!(parsed.paths.is_some() && parsed.components.is_some());
        let mut ids = BTreeSet::new();
        for (_, path) in document["paths"].as_object().unwrap() {
            for (_, operation) in path.as_object().unwrap() {
                assert!(ids.insert(operation["operationId"].as_str().unwrap().to_owned()));
            }
        }
        let names: Vec<&str> = ids.iter().map(String::as_str).collect();
        assert_eq!(
            names,
            [
                "cancelJob",
                "createJob",
                "getAccess",
                "getJob",
                "getJobPreview",
                "getJobResult",
                "getLiveness",
                "getMetrics",
                "getPreset",
                "getReadiness",
                "getSceneSchema",
                "getVersion",
                "listJobResults",
                "listJobs",
                "listPresets",
                "planPreset",
                "planScene",
                "streamJobEvents",
            ],
            "clients are generated from these names"
        );
    }

    #[test]
    fn every_reference_leads_somewhere() {
        fn references<'a>(value: &'a Value, found: &mut Vec<&'a str>) {
            match value {
                Value::Object(members) => {
                    found.extend(members.get("$ref").and_then(Value::as_str));
                    members.values().for_each(|value| references(value, found));
                }
                Value::Array(values) => values.iter().for_each(|value| references(value, found)),
                _ => {}
            }
        }
        let document = document();
        let mut found = Vec::new();
        references(&document, &mut found);
        assert!(found.len() > 20);
        for reference in found {
            let pointer = reference.strip_prefix('#').unwrap();
            assert!(document.pointer(pointer).is_some(), "{reference}");
        }
    }
}
