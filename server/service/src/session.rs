//! One client's session: what it wants to see, and what is on its way to it.
//!
//! The session holds the wish; the render thread compares it with what it last rendered. A burst
//! of camera moves thus costs one frame, and none of them can be lost.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use tokio::sync::watch;
use tyndall_render::check_supported;
use tyndall_scene::description::{CameraDescription, Navigation};
use tyndall_scene::{
    Loaded, Scene, SceneDescription, SceneEdit, SceneError, apply_edit, check_camera, facts,
    seen_through,
};
use tyndall_stream::pacing::{Accepts, Pacing, PacingSettings};
use tyndall_stream::protocol::{
    CameraPose, ClockState, ErrorCode, ErrorMessage, Facts, SceneMessage,
};

use crate::bell::lock;
use crate::clock::Clock;
use crate::outbox::Outbox;

/// Number of the connection that opens a session.
const FIRST: u64 = 1;

/// Why a session refused a change; its state is as before.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Refusal {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    NotRenderedYet(#[from] tyndall_render::NotRenderedYet),
}

impl Refusal {
    /// The message that tells the client.
    pub(crate) fn message(&self, input: Option<u64>) -> ErrorMessage {
        let (code, path) = match self {
            Self::Scene(error) => (ErrorCode::InvalidScene, error.path()),
            Self::NotRenderedYet(_) => (ErrorCode::NotRenderedYet, None),
        };
        ErrorMessage {
            code,
            path: path.map(str::to_owned),
            message: self.to_string(),
            input,
        }
    }
}

/// What a session wants rendered now.
#[derive(Debug, Clone)]
pub(crate) struct Wish {
    pub(crate) scene: Arc<Scene>,
    pub(crate) epoch: u32,
    pub(crate) input: u64,
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Someone is connected and looking.
    pub(crate) watched: bool,
    pub(crate) accepts: Accepts,
    /// Time goes on: the next frame shows another one, see [`Session::advance`].
    pub(crate) playing: bool,
}

/// A session, connected or waiting to be resumed.
#[derive(Debug)]
pub(crate) struct Session {
    /// Counts the sessions of this process; for logs.
    pub(crate) id: u64,
    /// Secret name, for resuming.
    pub(crate) token: String,
    pub(crate) pacing: Mutex<Pacing>,
    pub(crate) outbox: Outbox,
    state: Mutex<State>,
    /// Number of the connection that owns the session.
    connection: watch::Sender<u64>,
}

#[derive(Debug)]
struct State {
    description: Arc<SceneDescription>,
    /// The camera that was steered since, which counts instead of the description's.
    steered: Option<Steered>,
    /// Counts the changes to `description` and `steered`.
    version: u64,
    warnings: Vec<String>,
    wish: Wish,
    clock: Clock,
    visible: bool,
    /// Since when nobody is connected.
    dropped: Option<Instant>,
}

/// A camera that a client steers.
#[derive(Debug, Clone)]
struct Steered {
    camera: CameraDescription,
    /// The input that it answers.
    input: u64,
    /// Whether the wish's scene is seen through it already.
    is_seen: bool,
}

impl State {
    /// The camera as the client knows it.
    fn camera(&self) -> &CameraDescription {
        let steered = self.steered.as_ref();
        steered.map_or(&self.description.camera, |steered| &steered.camera)
    }
}

impl Session {
    /// A connected session that sees `scene`.
    pub(crate) fn new(id: u64, token: String, scene: &Loaded, accepts: Accepts) -> Self {
        let wish = Wish {
            scene: Arc::new(scene.scene.clone()),
            epoch: 1,
            input: 0,
            width: scene.scene.render.width,
            height: scene.scene.render.height,
            watched: true,
            accepts,
            playing: false,
        };
        Self {
            id,
            token,
            pacing: Mutex::new(Pacing::new(PacingSettings::default())),
            outbox: Outbox::new(FIRST),
            state: Mutex::new(State {
                description: Arc::new(scene.description.clone()),
                steered: None,
                version: 0,
                warnings: scene.warnings.clone(),
                wish,
                clock: Clock::new(&scene.scene),
                visible: true,
                dropped: None,
            }),
            connection: watch::Sender::new(FIRST),
        }
    }

    /// What to render now. Copies the scene where the camera was steered: for the render thread.
    pub(crate) fn wish(&self) -> Wish {
        self.look();
        let state = lock(&self.state);
        let watched = state.visible && state.dropped.is_none();
        Wish {
            watched,
            playing: state.clock.is_running(),
            ..state.wish.clone()
        }
    }

    /// Lets the wish's scene be seen through the camera that was steered last. The copy is made outside the
    /// lock, which connections wait for.
    fn look(&self) {
        let (scene, steered) = {
            let state = lock(&self.state);
            let unseen = state.steered.as_ref().filter(|steered| !steered.is_seen);
            let Some(steered) = unseen else { return };
            (Arc::clone(&state.wish.scene), steered.clone())
        };
        let seen = Arc::new(seen_through(&scene, &steered.camera));
        let mut guard = lock(&self.state);
        let state = &mut *guard;
        // Another scene was opened meanwhile; it is seen as it is.
        if !Arc::ptr_eq(&state.wish.scene, &scene) {
            return;
        }
        state.clock.adopt(&seen);
        state.wish.scene = seen;
        state.wish.input = state.wish.input.max(steered.input);
        if let Some(newest) = &mut state.steered {
            newest.is_seen = newest.camera == steered.camera;
            if newest.is_seen {
                state.wish.input = state.wish.input.max(newest.input);
            }
        }
    }

    /// The newest input that was accepted.
    pub(crate) fn input(&self) -> u64 {
        let state = lock(&self.state);
        let steered = state.steered.as_ref().map_or(0, |steered| steered.input);
        state.wish.input.max(steered)
    }

    /// What to render in a frame begun at `now`: time has gone on until then.
    pub(crate) fn advance(&self, now: Instant) -> Wish {
        self.look();
        let mut state = lock(&self.state);
        let seconds = state.clock.tick(now);
        match state.wish.scene.at(seconds) {
            Ok(scene) => state.wish.scene = Arc::new(scene),
            // The clock stays where the scene is defined.
            Err(error) => tracing::error!(session = self.id, %error, "a clock ran away"),
        }
        drop(state);
        // Motion counts as input: what is gone at once needs no sharper picture.
        lock(&self.pacing).input(now);
        self.wish()
    }

    /// Gives the session to another connection and returns that connection's number.
    pub(crate) fn connect(&self, accepts: Accepts) -> u64 {
        let mut state = lock(&self.state);
        state.wish.accepts = accepts;
        state.wish.epoch = state.wish.epoch.wrapping_add(1);
        state.visible = true;
        state.dropped = None;
        drop(state);
        lock(&self.pacing).reconnect();
        let number = *self.connection.borrow() + 1;
        self.outbox.reconnect(number);
        self.connection.send_replace(number);
        number
    }

    /// The connection has ended; false when another one owns the session by now.
    pub(crate) fn disconnect(&self, connection: u64, now: Instant) -> bool {
        let owns = *self.connection.borrow() == connection;
        if owns {
            let mut state = lock(&self.state);
            state.dropped = Some(now);
            state.clock.hold();
        }
        owns
    }

    /// Since when nobody is connected; `None` while somebody is.
    pub(crate) fn dropped(&self) -> Option<Instant> {
        lock(&self.state).dropped
    }

    /// The number of the connection that owns the session.
    pub(crate) fn connection(&self) -> u64 {
        *self.connection.borrow()
    }

    /// Returns once another connection owns the session.
    pub(crate) async fn taken_from(&self, connection: u64) {
        let mut receiver = self.connection.subscribe();
        // The sender lives as long as `self`, so this ends only by a change.
        if receiver
            .wait_for(|&owner| owner != connection)
            .await
            .is_err()
        {
            std::future::pending::<()>().await;
        }
    }

    /// The message that describes the open scene. Copies its description, so it belongs on a blocking
    /// thread.
    pub(crate) fn scene_message(&self) -> SceneMessage {
        self.look();
        let state = lock(&self.state);
        let (description, scene) = (
            Arc::clone(&state.description),
            Arc::clone(&state.wish.scene),
        );
        let (epoch, warnings, clock) = (
            state.wish.epoch,
            state.warnings.clone(),
            clock_state(&state),
        );
        let camera = state.camera().clone();
        drop(state);
        SceneMessage {
            epoch,
            name: scene.name.clone(),
            description: SceneDescription {
                camera,
                ..SceneDescription::clone(&description)
            },
            facts: Facts::from(&facts(&scene)),
            warnings,
            clock,
        }
    }

    /// How the scene says that it is steered.
    pub(crate) fn declared_navigation(&self) -> Option<Navigation> {
        lock(&self.state).description.navigation
    }

    /// Moves the eye; a camera that is steered leaves its keyframes. Looks at the camera alone: the scene is
    /// seen through it when the next frame begins.
    pub(crate) fn set_camera(
        &self,
        input: u64,
        pose: CameraPose,
        now: Instant,
    ) -> Result<(), Refusal> {
        let mut guard = lock(&self.state);
        let state = &mut *guard;
        let camera = CameraDescription {
            position: pose.position,
            target: pose.target,
            up: pose.up,
            vertical_fov_degrees: pose.vertical_fov_degrees,
            exposure_ev: state.camera().exposure_ev,
            keyframes: Vec::new(),
        };
        check_camera(&camera)?;
        let before = state.steered.as_ref().map_or(0, |steered| steered.input);
        state.steered = Some(Steered {
            camera,
            input: input.max(before),
            is_seen: false,
        });
        state.version += 1;
        drop(guard);
        lock(&self.pacing).input(now);
        Ok(())
    }

    /// Changes the open scene; on an error the old state stays. May take long, so it belongs on a
    /// blocking thread; the session stays usable meanwhile.
    pub(crate) fn edit(&self, input: u64, edit: &SceneEdit, now: Instant) -> Result<(), Refusal> {
        loop {
            let (description, steered, scene, version) = {
                let state = lock(&self.state);
                (
                    Arc::clone(&state.description),
                    state.steered.clone(),
                    Arc::clone(&state.wish.scene),
                    state.version,
                )
            };
            let steered_edit;
            let edit = match (steered, &edit.camera) {
                (Some(steered), None) => {
                    steered_edit = SceneEdit {
                        camera: Some(steered.camera),
                        ..edit.clone()
                    };
                    &steered_edit
                }
                _ => edit,
            };
            let (description, scene) = apply_edit(&description, &scene, edit)?;
            check_supported(&scene)?;
            let mut state = lock(&self.state);
            // Something else changed the scene meanwhile: the edit belongs on top of that.
            if state.version != version {
                continue;
            }
            let shown = state.wish.scene.time_seconds;
            let moved_on = edit.time_seconds.is_none() && scene.time_seconds != shown;
            let scene = if moved_on { scene.at(shown)? } else { scene };
            state.description = Arc::new(description);
            let before = state.steered.take().map_or(0, |steered| steered.input);
            state.version += 1;
            state.clock.adopt(&scene);
            if let Some(seconds) = edit.time_seconds {
                state.clock.seek(seconds);
            }
            if let Some(playing) = edit.playing {
                state.clock.play(playing);
            }
            state.wish.scene = Arc::new(scene);
            state.wish.input = state.wish.input.max(input).max(before);
            drop(state);
            lock(&self.pacing).input(now);
            return Ok(());
        }
    }

    /// Opens another scene.
    pub(crate) fn open(&self, input: u64, scene: &Loaded, now: Instant) -> Result<(), Refusal> {
        check_supported(&scene.scene)?;
        let description = Arc::new(scene.description.clone());
        let opened = Arc::new(scene.scene.clone());
        let mut state = lock(&self.state);
        state.description = description;
        let before = state.steered.take().map_or(0, |steered| steered.input);
        state.version += 1;
        state.warnings.clone_from(&scene.warnings);
        state.clock = Clock::new(&opened);
        state.wish.scene = opened;
        state.wish.epoch = state.wish.epoch.wrapping_add(1);
        state.wish.input = state.wish.input.max(input).max(before);
        drop(state);
        lock(&self.pacing).input(now);
        Ok(())
    }

    /// Changes the size of the picture. Unit: pixel. The caller has checked the limits.
    pub(crate) fn resize(&self, input: u64, width: u32, height: u32, now: Instant) {
        let mut state = lock(&self.state);
        state.wish.width = width;
        state.wish.height = height;
        state.wish.input = state.wish.input.max(input);
        drop(state);
        lock(&self.pacing).input(now);
    }

    /// Says whether anyone is looking.
    pub(crate) fn set_visible(&self, visible: bool) {
        let mut state = lock(&self.state);
        state.visible = visible;
        if !visible {
            state.clock.hold();
        }
    }
}

/// The clock as the protocol says it, if something moves.
fn clock_state(state: &State) -> Option<ClockState> {
    let scene = &state.wish.scene;
    Some(ClockState {
        playing: state.clock.is_playing(),
        time_seconds: scene.time_seconds,
        duration_seconds: scene.duration_seconds()?,
    })
}

#[cfg(test)]
mod tests;
