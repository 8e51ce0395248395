//! Steering through a scene: where steps end, what lies under the pointer, why a picture is black.

use std::sync::Arc;

use glam::DVec3;
use tokio::task::{JoinHandle, spawn_blocking};
use tyndall_render::{Darkness, Guide, NavigationFacts, Picked, Stand};
use tyndall_scene::Aabb;
use tyndall_scene::description::Bounds;
use tyndall_stream::protocol::{
    CameraMessage, CameraPose, CameraUpdate, DarknessCause, DarknessMessage, ExplainDarkness,
    NavigationMessage, Pick, PickedKind, PickedMessage, PickedPoint, ViewPoint,
};

use crate::server::App;
use crate::session::Session;

/// A view closer to the vertical than this has no left and right. Sine of the angle.
const LEAST_SINE: f64 = 1e-3;
/// A step that keeps the distance to a target that stays, to this share of it, turns about it.
const SAME_DISTANCE: f64 = 1e-6;
/// Steps that end this near to where they were meant to were not stopped. Unit: share of the way.
const ARRIVED: f64 = 1e-9;

/// The guide of the session's scene, or its construction.
pub(super) struct Steering {
    app: Arc<App>,
    session: Arc<Session>,
    guide: Option<Arc<Guide>>,
    building: Option<JoinHandle<Option<Arc<Guide>>>>,
}

impl Steering {
    /// Starts building the guide of the session's scene.
    pub(super) fn new(app: &Arc<App>, session: &Arc<Session>) -> Self {
        let mut steering = Self {
            app: Arc::clone(app),
            session: Arc::clone(session),
            guide: None,
            building: None,
        };
        steering.scene_opened();
        steering
    }

    /// Another scene is open.
    pub(super) fn scene_opened(&mut self) {
        let (app, scene) = (Arc::clone(&self.app), self.session.wish().scene);
        let declared = self.session.declared_navigation();
        self.guide = None;
        self.building = Some(tokio::spawn(async move {
            app.guides.guide(scene, declared).await
        }));
    }

    /// What the page is told once the guide is there; never before, and once a scene.
    pub(super) async fn known(&mut self) -> NavigationMessage {
        loop {
            let Some(building) = &mut self.building else {
                return std::future::pending().await;
            };
            let built = building.await;
            self.building = None;
            if let Ok(Some(guide)) = built {
                let told = navigation(self.session.wish().epoch, guide.facts());
                self.guide = Some(guide);
                return told;
            }
        }
    }

    /// The camera that a message leads to, and what to tell the page if a surface stopped it.
    pub(super) fn stopped(&self, update: &CameraUpdate) -> Option<CameraMessage> {
        let guide = self.guide.as_ref().filter(|_| update.stops_at_surfaces)?;
        let shown = self.session.wish().scene.camera;
        let wished = update.camera;
        let (from, to) = (shown.position, DVec3::from_array(wished.position));
        let pivot = DVec3::from_array(wished.target);
        let turns = pivot == shown.target && {
            let (before, after) = (from.distance(pivot), to.distance(pivot));
            (before - after).abs() <= SAME_DISTANCE * before
        };
        let at = if turns {
            guide.turn(from, to, pivot)
        } else {
            guide.walk(from, to)
        };
        if at.distance(to) <= ARRIVED * from.distance(to) {
            return None;
        }
        let camera = stopped_at(at, &wished, shown.target);
        Some(CameraMessage {
            input: update.input,
            camera: if is_upright(&camera) {
                camera
            } else {
                stopped_at(from, &wished, shown.target)
            },
        })
    }

    /// What lies under a place of the picture.
    pub(super) async fn pick(&self, pick: Pick) -> PickedMessage {
        let [x, y] = pick.place;
        let is_place = (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y);
        let Some(guide) = self.guide.clone().filter(|_| is_place) else {
            return PickedMessage {
                request: pick.request,
                hit: None,
            };
        };
        let (scene, aspect) = self.view();
        let picked = spawn_blocking(move || guide.pick(&scene, aspect, pick.place)).await;
        PickedMessage {
            request: pick.request,
            hit: picked.ok().flatten().map(point),
        }
    }

    /// Why the picture is black; `None` where that is not known.
    pub(super) async fn darkness(&self, question: ExplainDarkness) -> Option<DarknessMessage> {
        let guide = self.guide.clone()?;
        let (scene, aspect) = self.view();
        let cause = spawn_blocking(move || guide.darkness(&scene, aspect)).await;
        Some(DarknessMessage {
            request: question.request,
            cause: cause_of(cause.ok()?),
        })
    }

    /// The scene shown, and the picture's ratio of width to height.
    fn view(&self) -> (Arc<tyndall_scene::Scene>, f64) {
        let wish = self.session.wish();
        let aspect = f64::from(wish.width.max(1)) / f64::from(wish.height.max(1));
        (wish.scene, aspect)
    }
}

/// The wished view from where the eye was stopped. A target that stayed is still looked at; one that moved
/// along is moved as far as the eye.
fn stopped_at(at: DVec3, wished: &CameraPose, target_before: DVec3) -> CameraPose {
    let target = DVec3::from_array(wished.target);
    let stays = target == target_before;
    let shift = at - DVec3::from_array(wished.position);
    CameraPose {
        position: at.to_array(),
        target: if stays { target } else { target + shift }.to_array(),
        ..*wished
    }
}

/// Whether a camera's view differs from its up.
fn is_upright(camera: &CameraPose) -> bool {
    let view = DVec3::from_array(camera.target) - DVec3::from_array(camera.position);
    let up = DVec3::from_array(camera.up);
    view.cross(up).length() > LEAST_SINE * view.length() * up.length()
}

fn navigation(epoch: u32, facts: &NavigationFacts) -> NavigationMessage {
    let Aabb { min, max } = facts.bounds;
    let stand = |stand: Stand| ViewPoint {
        position: stand.position.to_array(),
        target: stand.target.to_array(),
    };
    NavigationMessage {
        epoch,
        mode: facts.mode,
        bounds: Bounds {
            min: min.to_array(),
            max: max.to_array(),
        },
        pivot: facts.pivot.to_array(),
        overview: facts.overview.map(stand),
    }
}

fn point(picked: Picked) -> PickedPoint {
    match picked {
        Picked::Surface { point, normal } => PickedPoint {
            kind: PickedKind::Surface,
            point: point.to_array(),
            normal: Some(normal.to_array()),
        },
        Picked::Medium { point } => PickedPoint {
            kind: PickedKind::Medium,
            point: point.to_array(),
            normal: None,
        },
    }
}

fn cause_of(darkness: Darkness) -> DarknessCause {
    match darkness {
        Darkness::NoLight => DarknessCause::NoLight,
        Darkness::InsideSolid => DarknessCause::InsideSolid,
        Darkness::AtSurface => DarknessCause::AtSurface,
        Darkness::LooksAway => DarknessCause::LooksAway,
        Darkness::Unlit => DarknessCause::Unlit,
    }
}
