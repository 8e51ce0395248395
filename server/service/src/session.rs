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
    Loaded, Scene, SceneDescription, SceneEdit, SceneError, apply_edit, facts, steer,
};
use tyndall_stream::pacing::{Accepts, Pacing, PacingSettings};
use tyndall_stream::protocol::{
    CameraPose, ClockState, ErrorCode, ErrorMessage, Facts, SceneMessage,
};

use crate::bell::lock;
use crate::clock::Clock;
use crate::outbox::Outbox;

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
    /// Counts the changes to `description`.
    version: u64,
    warnings: Vec<String>,
    wish: Wish,
    clock: Clock,
    visible: bool,
    /// Since when nobody is connected.
    dropped: Option<Instant>,
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
            outbox: Outbox::default(),
            state: Mutex::new(State {
                description: Arc::new(scene.description.clone()),
                version: 0,
                warnings: scene.warnings.clone(),
                wish,
                clock: Clock::new(&scene.scene),
                visible: true,
                dropped: None,
            }),
            connection: watch::Sender::new(1),
        }
    }

    /// What to render now.
    pub(crate) fn wish(&self) -> Wish {
        let state = lock(&self.state);
        let watched = state.visible && state.dropped.is_none();
        Wish {
            watched,
            playing: state.clock.is_running(),
            ..state.wish.clone()
        }
    }

    /// What to render in a frame begun at `now`: time has gone on until then.
    pub(crate) fn advance(&self, now: Instant) -> Wish {
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
        self.outbox.reconnect();
        self.connection.send_modify(|number| *number += 1);
        *self.connection.borrow()
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

    /// The message that describes the open scene.
    pub(crate) fn scene_message(&self) -> SceneMessage {
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
        drop(state);
        SceneMessage {
            epoch,
            name: scene.name.clone(),
            description: SceneDescription::clone(&description),
            facts: Facts::from(&facts(&scene)),
            warnings,
            clock,
        }
    }

    /// How the scene says that it is steered.
    pub(crate) fn declared_navigation(&self) -> Option<Navigation> {
        lock(&self.state).description.navigation
    }

    /// Moves the eye; a camera that is steered leaves its keyframes.
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
            exposure_ev: state.description.camera.exposure_ev,
            keyframes: Vec::new(),
        };
        steer(&mut state.description, &mut state.wish.scene, &camera)?;
        state.version += 1;
        state.clock.adopt(&state.wish.scene);
        state.wish.input = state.wish.input.max(input);
        drop(guard);
        lock(&self.pacing).input(now);
        Ok(())
    }

    /// Changes the open scene; on an error the old state stays. May take long, so it belongs on a
    /// blocking thread; the session stays usable meanwhile.
    pub(crate) fn edit(&self, input: u64, edit: &SceneEdit, now: Instant) -> Result<(), Refusal> {
        loop {
            let (description, scene, version) = {
                let state = lock(&self.state);
                (
                    Arc::clone(&state.description),
                    Arc::clone(&state.wish.scene),
                    state.version,
                )
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
            state.version += 1;
            state.clock.adopt(&scene);
            if let Some(seconds) = edit.time_seconds {
                state.clock.seek(seconds);
            }
            if let Some(playing) = edit.playing {
                state.clock.play(playing);
            }
            state.wish.scene = Arc::new(scene);
            state.wish.input = state.wish.input.max(input);
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
        state.version += 1;
        state.warnings.clone_from(&scene.warnings);
        state.clock = Clock::new(&opened);
        state.wish.scene = opened;
        state.wish.epoch = state.wish.epoch.wrapping_add(1);
        state.wish.input = state.wish.input.max(input);
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
mod tests {
    use tyndall_scene::{build, presets};

    use super::*;

    fn hall() -> Session {
        let description = presets::description("fogged_hall").expect("a preset");
        let loaded = build(description, None).expect("the preset is valid");
        let accepts = Accepts {
            jpeg: true,
            png: true,
        };
        Session::new(1, "token".to_owned(), &loaded, accepts)
    }

    fn pose(x: f64) -> CameraPose {
        CameraPose {
            position: [x, 1.6, 3.0],
            target: [0.0, 1.5, -4.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: 60.0,
        }
    }

    fn edit(session: &Session, pose: CameraPose) -> SceneEdit {
        let camera = CameraDescription {
            position: pose.position,
            target: pose.target,
            up: pose.up,
            vertical_fov_degrees: pose.vertical_fov_degrees,
            keyframes: Vec::new(),
            ..session.scene_message().description.camera
        };
        SceneEdit {
            camera: Some(camera),
            ..SceneEdit::default()
        }
    }

    /// The least time of several calls: what else runs on the machine only adds. Unit: µs.
    fn least_micros(mut call: impl FnMut(f64)) -> f64 {
        let times = (0..50).map(|i| {
            let start = Instant::now();
            call(f64::from(i) * 0.01);
            start.elapsed().as_secs_f64() * 1e6
        });
        times.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_camera_message_does_what_an_edit_does_without_holding_an_async_thread() {
        let (steered, edited) = (hall(), hall());
        let now = Instant::now();
        // The render thread keeps what it shows, so every camera copies the scene once.
        let steering = least_micros(|x| {
            let _shown = steered.wish();
            steered.set_camera(1, pose(x), now).expect("a valid pose");
        });
        let editing = least_micros(|x| {
            let edit = edit(&edited, pose(x));
            edited.edit(1, &edit, now).expect("a valid edit");
        });
        println!("a camera message takes {steering:.1} µs, as an edit {editing:.1} µs");
        assert!(steering < 500.0, "{steering} µs");
        assert_eq!(
            *steered.wish().scene,
            Scene {
                geometry: steered.wish().scene.geometry.clone(),
                ..Scene::clone(&edited.wish().scene)
            }
        );
        let (steered, edited) = (steered.scene_message(), edited.scene_message());
        assert_eq!(steered.description, edited.description);
    }

    #[test]
    fn a_refused_camera_leaves_everything_as_it_was() {
        let session = hall();
        let before = (session.wish(), session.scene_message());
        let upright = CameraPose {
            target: [0.0, 5.0, 3.0],
            position: [0.0, 1.0, 3.0],
            ..pose(0.0)
        };
        let refusal = session.set_camera(7, upright, Instant::now());
        let message = refusal.expect_err("it looks along up").message(Some(7));
        assert_eq!(message.path.as_deref(), Some("camera.up"));
        let after = session.wish();
        assert!(Arc::ptr_eq(&before.0.scene, &after.scene));
        assert_eq!(after.input, 0);
        assert_eq!(before.1, session.scene_message());
    }

    #[test]
    fn an_edit_on_another_thread_loses_no_camera() {
        let session = hall();
        std::thread::scope(|threads| {
            threads.spawn(|| {
                for i in 0..100 {
                    let edit = SceneEdit {
                        exposure_ev: Some(f64::from(i) * 0.01),
                        ..SceneEdit::default()
                    };
                    let edited = session.edit(1, &edit, Instant::now());
                    edited.expect("a valid edit");
                }
            });
            for i in 0..2000 {
                let steered = session.set_camera(1, pose(f64::from(i) * 1e-3), Instant::now());
                steered.expect("a valid pose");
                let at = session.wish().scene.camera.position.x;
                assert_eq!(
                    at,
                    f64::from(i) * 1e-3,
                    "an edit brought an old camera back"
                );
            }
        });
        let exposure = session.scene_message().description.camera.exposure_ev;
        assert_eq!(exposure, 0.99, "a camera brought an old exposure back");
    }
}
