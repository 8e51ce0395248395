//! The JSON messages of the WebSocket, version 1.
//!
//! A client says [`ClientMessage::Hello`] first; the server answers with
//! [`ServerMessage::Welcome`], the scene and the plan, then sends frames (binary, see
//! [`crate::header`]), each followed by its [`Stats`]. Every change a client makes carries an
//! input number that it counts upward; frames name the largest number that they show, which is
//! how the page measures the way from hand to picture.
//!
//! `web/src/protocol.gen.ts` is generated from these types by a test.

use serde::{Deserialize, Serialize};
use ts_rs::TS;
use tyndall_scene::{SceneDescription, SceneEdit, SceneError, parse_json};

use crate::header::{Codec, MAX_SAFE_INTEGER};
use crate::messages::messages;

pub use crate::facts::Facts;
pub use crate::navigation::{
    CameraMessage, CameraPose, DarknessCause, DarknessMessage, ExplainDarkness, NavigationMessage,
    Pick, PickedKind, PickedMessage, PickedPoint, ViewPoint,
};

/// Version of the messages that this code speaks.
pub const PROTOCOL_VERSION: u32 = 1;

messages! {
    /// What a client says.
    pub enum ClientMessage {
        /// The first message.
        "hello" => Hello(Hello),
        /// Moves the eye; only the newest counts.
        "camera" => Camera(CameraUpdate),
        /// Changes the open scene.
        "edit" => Edit(EditRequest),
        /// Opens a built-in scene.
        "open_preset" => OpenPreset(OpenPreset),
        /// Changes the size of the picture.
        "resize" => Resize(Resize),
        /// Has painted, or skipped for a newer one, a frame and all before it.
        "ack" => Ack(Ack),
        /// Has become visible or hidden; nothing is rendered for a hidden page.
        "visible" => Visible(Visible),
        /// Asks what lies under a place of the picture.
        "pick" => Pick(Pick),
        /// Asks why the picture is black.
        "explain_darkness" => ExplainDarkness(ExplainDarkness),
    }
}

/// Opens or resumes a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct Hello {
    /// [`PROTOCOL_VERSION`].
    pub protocol: u32,
    /// Codecs the client decodes; names this server does not know are skipped.
    pub accept: Vec<String>,
    /// Width of the picture wanted. Unit: device pixel.
    pub width: u32,
    /// Height of the picture wanted. Unit: device pixel.
    pub height: u32,
    /// `session` of an earlier welcome, to go on with its state.
    #[serde(default)]
    #[ts(optional = nullable)]
    pub resume: Option<String>,
}

impl Hello {
    /// The codecs of `accept` that this code knows.
    pub fn codecs(&self) -> Vec<Codec> {
        let known = |name: &String| match name.as_str() {
            "jpeg" => Some(Codec::Jpeg),
            "png" => Some(Codec::Png),
            _ => None,
        };
        self.accept.iter().filter_map(known).collect()
    }
}

/// Moves the eye.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct CameraUpdate {
    /// The client's input number.
    pub input: u64,
    /// Where to.
    pub camera: CameraPose,
    /// The eye stops before surfaces and slides along them; where it ends elsewhere than it was sent, a
    /// [`ServerMessage::Camera`] says so. Without this it goes through them.
    #[serde(default)]
    #[ts(optional, as = "Option<bool>")]
    pub stops_at_surfaces: bool,
}

/// Changes the open scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct EditRequest {
    /// The client's input number.
    pub input: u64,
    /// What to change.
    pub edit: SceneEdit,
}

/// Opens a built-in scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct OpenPreset {
    /// The client's input number.
    pub input: u64,
    /// A name of the welcome's `presets`.
    pub name: String,
}

/// Changes the size of the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct Resize {
    /// The client's input number.
    pub input: u64,
    /// Unit: device pixel.
    pub width: u32,
    /// Unit: device pixel.
    pub height: u32,
}

/// Acknowledges a frame and all before it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct Ack {
    /// `frame_id` of the header.
    pub frame: u32,
}

/// Says whether anyone can see the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct Visible {
    /// False for a hidden tab.
    pub visible: bool,
}

impl ClientMessage {
    /// Parses one text message.
    ///
    /// # Errors
    /// [`SceneError::Syntax`] for text that is not JSON; [`SceneError::Invalid`] with the path in
    /// the message, what was found and what is allowed for everything else.
    pub fn from_json(text: &str) -> Result<Self, SceneError> {
        let message = Self::from_members(parse_json(text)?)?;
        match message.input() {
            Some(input) if input > MAX_SAFE_INTEGER => Err(SceneError::Invalid {
                path: "input".to_owned(),
                found: input.to_string(),
                allowed: "at most 2^53 - 1".to_owned(),
            }),
            _ => Ok(message),
        }
    }

    /// The input number of messages that carry one.
    pub fn input(&self) -> Option<u64> {
        match self {
            Self::Camera(update) => Some(update.input),
            Self::Edit(request) => Some(request.input),
            Self::OpenPreset(open) => Some(open.input),
            Self::Resize(resize) => Some(resize.input),
            Self::Hello(_)
            | Self::Ack(_)
            | Self::Visible(_)
            | Self::Pick(_)
            | Self::ExplainDarkness(_) => None,
        }
    }
}

/// What the server says.
#[derive(Debug, Clone, PartialEq, Serialize, TS)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ServerMessage {
    /// Answers the hello.
    Welcome(Welcome),
    /// Another scene is open.
    Scene(Box<SceneMessage>),
    /// How to steer through the open scene.
    Navigation(NavigationMessage),
    /// A surface stopped the eye.
    Camera(CameraMessage),
    /// Answers a pick.
    Picked(PickedMessage),
    /// Answers the question why the picture is black.
    Darkness(DarknessMessage),
    /// What each frame does from now on, and why.
    Plan(PlanMessage),
    /// About the frame before it.
    Stats(Stats),
    /// The picture is not quite what was asked for, though nothing is wrong.
    Notice(Notice),
    /// Something the client asked for was refused, or something broke.
    Error(ErrorMessage),
}

/// Answers the hello.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
pub struct Welcome {
    /// [`PROTOCOL_VERSION`].
    pub protocol: u32,
    /// Version of the server.
    pub version: String,
    /// Secret name of this session, for `resume`.
    pub session: String,
    /// Whether the session that was asked for goes on.
    pub resumed: bool,
    /// What renders.
    pub adapter: Adapter,
    /// Built-in scenes, the default first.
    pub presets: Vec<Preset>,
    /// What this server allows.
    pub limits: StreamLimits,
}

/// What renders.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, TS)]
pub struct Adapter {
    /// The device's name.
    pub name: String,
    /// The driver's name and version.
    pub driver: String,
    /// Kind of device.
    pub kind: AdapterKind,
}

/// Kind of device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, TS)]
#[serde(rename_all = "snake_case")]
pub enum AdapterKind {
    /// A graphics processor.
    Gpu,
    /// The CPU, by a software driver.
    Software,
    /// Not known.
    Other,
}

/// A built-in scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, TS)]
pub struct Preset {
    /// For `open_preset` and URLs.
    pub name: String,
    /// For people.
    pub title: String,
    /// One sentence.
    pub summary: String,
}

/// What this server allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, TS)]
pub struct StreamLimits {
    /// Largest picture. Unit: pixel.
    pub max_pixels: u64,
    /// Longest side of a picture. Unit: pixel.
    pub max_side: u32,
    /// Longest message. Unit: byte.
    pub max_message_bytes: u64,
    /// How long a dropped session can be resumed. Unit: s.
    pub resume_seconds: u64,
}

/// Another scene is open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
pub struct SceneMessage {
    /// Frames of this scene carry this number.
    pub epoch: u32,
    /// The scene's name.
    pub name: String,
    /// The scene as it can be edited.
    pub description: SceneDescription,
    /// What the planner knows about it.
    pub facts: Facts,
    /// What was left out or approximated, one sentence each.
    pub warnings: Vec<String>,
    /// The clock, if something moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub clock: Option<ClockState>,
}

/// The clock of a session whose scene moves; edits set it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, TS)]
pub struct ClockState {
    /// Whether time goes on.
    pub playing: bool,
    /// The time shown. Unit: s.
    pub time_seconds: f64,
    /// After which the scene starts over or stands still. Unit: s.
    pub duration_seconds: f64,
}

/// What each frame does.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, TS)]
pub struct PlanMessage {
    /// The plan.
    pub plan: Plan,
}

/// Passes that run and passes that don't.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, TS)]
pub struct Plan {
    /// In the order of execution.
    pub passes: Vec<PlannedPass>,
    /// With the reason why not.
    pub skipped: Vec<PlannedPass>,
}

/// A pass and why it runs or does not.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, TS)]
pub struct PlannedPass {
    /// Name of the pass, as in pass times and metrics.
    pub pass: String,
    /// Which of its shaders.
    pub variant: String,
    /// Why.
    pub reason: String,
}

/// About one frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
pub struct Stats {
    /// `frame_id` of the header.
    pub frame: u32,
    /// Accumulated samples a pixel.
    pub samples: u32,
    /// Whether the picture is final until something changes.
    pub converged: bool,
    /// Mean over pixels and channels of the transmittance to the first surface. Range: 0 to 1.
    pub mean_transmittance: f32,
    /// Mean luminance after exposure and curve, before encoding. Range: 0 to 1.
    pub mean_luminance: f32,
    /// Pixels that were not finite; anything above 0 is a fault.
    pub non_finite: u32,
    /// Pixels that were negative; anything above 0 is a fault.
    pub negative: u32,
    /// Pixels that a named clamp changed.
    pub clamped: u32,
    /// Time of each pass on the device.
    pub pass_times: Vec<PassTime>,
    /// Time of the whole frame on the device. Unit: µs.
    pub render_micros: u32,
    /// Time of the encoder. Unit: µs.
    pub encode_micros: u32,
    /// Length of the frame message. Unit: byte.
    pub bytes: u64,
    /// What transported the light.
    pub technique: String,
    /// The scene's time that it shows, if something moves. Unit: s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub time_seconds: Option<f64>,
    /// Smoothed time from sending a frame to its acknowledgement. Unit: µs.
    #[ts(optional)]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub round_trip_micros: Option<u64>,
}

/// Time of a pass on the device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
pub struct PassTime {
    /// Name of the pass.
    pub name: String,
    /// Unit: µs.
    pub micros: f32,
}

/// Something that the user may wonder about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, TS)]
pub struct Notice {
    /// One sentence for people.
    pub message: String,
}

/// Why something was refused or broke.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, TS)]
pub struct ErrorMessage {
    /// Stable name of the cause.
    pub code: ErrorCode,
    /// JSON path in the scene or message, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub path: Option<String>,
    /// One sentence for people.
    pub message: String,
    /// Input number of the message that was refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub input: Option<u64>,
}

/// Stable names of causes, shared by the WebSocket and by HTTP problems.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, TS)]
#[serde(rename_all = "snake_case")]
pub enum ErrorCode {
    /// The request or message cannot be read.
    Malformed,
    /// No such address or preset.
    NotFound,
    /// The address does not take this method.
    MethodNotAllowed,
    /// The token is missing or wrong.
    Unauthorized,
    /// Too many wrong tokens came from the same address.
    TooManyAttempts,
    /// The page that asks is not served by this server.
    OriginRefused,
    /// The request or message is too long.
    TooLarge,
    /// The body is not JSON by its content type.
    UnsupportedMediaType,
    /// The scene is wrong at `path`.
    InvalidScene,
    /// The scene is right, but this version cannot render part of it.
    NotRenderedYet,
    /// The size is zero or above the limits.
    InvalidSize,
    /// The other side speaks another version.
    ProtocolVersion,
    /// The first message was not a hello, or came too late.
    HelloExpected,
    /// None of the client's codecs is known.
    NoCommonCodec,
    /// Every session is taken.
    TooManySessions,
    /// Another connection took the session over.
    TakenOver,
    /// The renderer is not ready, or the server is going down.
    NotReady,
    /// The request took longer than it may.
    TookTooLong,
    /// The renderer failed.
    RenderFailed,
    /// A fault of the server.
    Internal,
    /// What is asked for contradicts what is there.
    Conflict,
    /// As many jobs wait as may, or as many uploads are being received.
    QueueFull,
    /// A file that was uploaded is unfit.
    InvalidUpload,
    /// The range lies outside the file.
    RangeNotSatisfiable,
    /// What is stored cannot be read or written.
    StorageFailed,
}
