//! A renderer that keeps time but draws nothing, and breaks as the test says.

use std::collections::{BTreeSet, VecDeque};
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tyndall_render::{
    FailedFrame, FinishedFrame, FrameStats, PlanLimits, Prepared, RenderError, RenderOutcome,
};
use tyndall_scene::{Scene, StopRule};
use tyndall_service::ServeError;
use tyndall_service::backend::{Backend, OpenBackend, StillInMaking};
use tyndall_still::{Progress, Step};
use tyndall_stream::protocol::{Adapter, AdapterKind, Plan, PlannedPass};

/// Time of a frame on the device.
const FRAME: Duration = Duration::from_millis(2);
/// Memory of a picture. Unit: byte a pixel.
pub const BYTES_A_PIXEL: u64 = 16;

/// Switches and counters of the fake renderer.
#[derive(Debug, Default)]
pub struct Script {
    /// Calls of any kind.
    pub calls: AtomicU64,
    /// Frames started.
    pub frames: AtomicU64,
    /// Devices opened.
    pub opened: AtomicU64,
    /// The next call finds the device lost.
    pub lose: AtomicBool,
    /// No device can be opened.
    pub gone: AtomicBool,
    /// Frames of this width lose the device; 0 for none. Unit: pixel.
    pub deadly_width: AtomicU32,
    /// Deadly frames are so only beside other frames.
    pub deadly_in_company: AtomicBool,
    /// Frames of this width panic in the renderer; 0 for none. Unit: pixel.
    pub panic_width: AtomicU32,
    /// Frames of this width never come to an end: the call hangs; 0 for none. Unit: pixel.
    pub stuck_width: AtomicU32,
    /// Loop iterations after which the driver stops a shader; 0 for none.
    pub loop_cap: AtomicU32,
    /// No frame finishes.
    pub held: AtomicBool,
    /// So many frames come back as errors.
    pub unreadable: AtomicU32,
    /// Scenes of more than one medium are being prepared.
    pub preparing: AtomicBool,
    /// What a picture may have; 0 for no bound. Unit: byte.
    pub memory: AtomicU64,
    /// Pictures that were too large for it.
    pub too_large: AtomicU64,
    /// Waits for the frame that had been on the device longest.
    pub waited_for_oldest: AtomicU64,
    /// Waits for any other frame.
    pub waited_for_younger: AtomicU64,
    /// Every frame that was started.
    pub begun: Mutex<Vec<Begun>>,
}

/// A frame as it was started.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Begun {
    /// Unit: pixel.
    pub width: u32,
    pub camera_x: f64,
    pub media: usize,
    /// Frames on the device besides it.
    pub beside: usize,
}

impl Script {
    /// The frames of one width that were started. Unit: pixel.
    pub fn begun_with(&self, width: u32) -> Vec<Begun> {
        let begun = self.begun.lock().unwrap();
        begun.iter().filter(|b| b.width == width).copied().collect()
    }
}

/// Takes 2 ms a frame; converges after the scene's number of samples.
pub struct Fake {
    script: Arc<Script>,
    /// A deadly frame was begun: the device is lost.
    dead: bool,
    on_device: Numbers,
}

/// Numbers of the frames on the device, in the order of their start.
type Numbers = Arc<Mutex<BTreeSet<u64>>>;

/// One frame on the device, listed as long as it lives.
struct OnDevice {
    number: u64,
    all: Numbers,
}

impl OnDevice {
    fn new(number: u64, all: &Numbers) -> Self {
        all.lock().unwrap().insert(number);
        let all = Arc::clone(all);
        Self { number, all }
    }

    fn is_oldest(&self) -> bool {
        self.all.lock().unwrap().first() == Some(&self.number)
    }
}

impl Drop for OnDevice {
    fn drop(&mut self) {
        self.all.lock().unwrap().remove(&self.number);
    }
}

struct Flying {
    ready: Instant,
    result: Result<FinishedFrame, FailedFrame>,
    on_device: OnDevice,
}

pub struct FakeView {
    scene: Arc<Scene>,
    size: (u32, u32),
    samples: u32,
    flying: VecDeque<Flying>,
}

impl FakeView {
    fn target(&self) -> u32 {
        match self.scene.render.stop {
            StopRule::Samples(samples) => samples,
            _ => u32::MAX,
        }
    }
}

impl Fake {
    pub fn opener(script: &Arc<Script>) -> OpenBackend<Self> {
        let script = Arc::clone(script);
        Box::new(move || {
            if script.gone.load(Ordering::SeqCst) {
                return Err(ServeError::Renderer(RenderError::DeviceLost(
                    "gone".to_owned(),
                )));
            }
            script.opened.fetch_add(1, Ordering::SeqCst);
            Ok(Self {
                script: Arc::clone(&script),
                dead: false,
                on_device: Arc::default(),
            })
        })
    }

    fn call(&self) -> Result<(), RenderError> {
        self.script.calls.fetch_add(1, Ordering::SeqCst);
        if self.dead || self.script.lose.swap(false, Ordering::SeqCst) {
            return Err(RenderError::DeviceLost("the test took it away".to_owned()));
        }
        Ok(())
    }

    fn allocate(&self, width: u32, height: u32) -> Result<(), RenderError> {
        let needed = BYTES_A_PIXEL * u64::from(width) * u64::from(height);
        let allowed = self.script.memory.load(Ordering::SeqCst);
        if allowed == 0 || needed <= allowed {
            return Ok(());
        }
        self.script.too_large.fetch_add(1, Ordering::SeqCst);
        Err(RenderError::Memory { needed, allowed })
    }
}

/// A still that takes a frame a sample.
pub struct FakeStill {
    view: Option<FakeView>,
    scene: Arc<Scene>,
    shown: Option<FinishedFrame>,
    frames: u64,
}

impl StillInMaking for FakeStill {
    fn is_on_device(&self) -> bool {
        let view = self.view.as_ref();
        view.is_some_and(|view| !view.flying.is_empty())
    }

    fn progress(&self) -> Progress {
        let samples = self.shown.as_ref().map_or(0, |frame| frame.samples);
        let target = self.view.as_ref().map_or(1, FakeView::target);
        Progress {
            samples,
            estimated_error: None,
            fraction: samples as f32 / target as f32,
            frames: self.frames,
        }
    }

    fn shown(&self) -> Option<&FinishedFrame> {
        self.shown.as_ref()
    }
}

impl Backend for Fake {
    type View = FakeView;
    type Still = FakeStill;

    fn adapter(&self) -> Adapter {
        Adapter {
            name: "fake".to_owned(),
            driver: "none".to_owned(),
            kind: AdapterKind::Software,
        }
    }

    fn plan_limits(&self) -> PlanLimits {
        PlanLimits {
            loop_cap: Some(self.script.loop_cap.load(Ordering::SeqCst)).filter(|cap| *cap > 0),
            ..PlanLimits::default()
        }
    }

    fn prepare(
        &mut self,
        scene: &Arc<Scene>,
        _width: u32,
        _height: u32,
    ) -> Result<Prepared, RenderError> {
        self.call()?;
        if self.script.preparing.load(Ordering::SeqCst) && scene.media.len() > 1 {
            return Ok(Prepared::Pending);
        }
        Ok(Prepared::Ready)
    }

    fn create_view(
        &mut self,
        scene: Arc<Scene>,
        width: u32,
        height: u32,
    ) -> Result<FakeView, RenderError> {
        self.call()?;
        self.allocate(width, height)?;
        Ok(FakeView {
            scene,
            size: (width, height),
            samples: 0,
            flying: VecDeque::new(),
        })
    }

    fn update_view(&mut self, view: &mut FakeView, scene: Arc<Scene>) -> Result<(), RenderError> {
        self.call()?;
        if *view.scene != *scene {
            view.samples = 0;
        }
        view.scene = scene;
        Ok(())
    }

    fn resize_view(
        &mut self,
        view: &mut FakeView,
        width: u32,
        height: u32,
    ) -> Result<(), RenderError> {
        self.call()?;
        self.allocate(width, height)?;
        view.size = (width, height);
        view.samples = 0;
        Ok(())
    }

    fn render(&mut self, view: &mut FakeView, tag: u64) -> Result<RenderOutcome, RenderError> {
        self.call()?;
        if view.samples >= view.target() {
            return Ok(RenderOutcome::Converged);
        }
        let deadly = self.script.panic_width.load(Ordering::SeqCst);
        assert_ne!(view.size.0, deadly, "the test wants the renderer to panic");
        if view.size.0 == self.script.stuck_width.load(Ordering::SeqCst) {
            loop {
                std::thread::park();
            }
        }
        let number = self.script.frames.fetch_add(1, Ordering::SeqCst);
        view.samples += 1;
        let (width, height) = view.size;
        let beside = self.on_device.lock().unwrap().len();
        self.script.begun.lock().unwrap().push(Begun {
            width,
            camera_x: view.scene.camera.position.x,
            media: view.scene.media.len(),
            beside,
        });
        let needs_company = self.script.deadly_in_company.load(Ordering::SeqCst);
        if width == self.script.deadly_width.load(Ordering::SeqCst)
            && (beside > 0 || !needs_company)
        {
            self.dead = true;
        }
        let less = |left: u32| left.checked_sub(1);
        let failed = self
            .script
            .unreadable
            .fetch_update(Ordering::SeqCst, Ordering::SeqCst, less);
        let result = if failed.is_ok() {
            Err(FailedFrame {
                tag,
                reason: "the test spoilt it".to_owned(),
            })
        } else {
            Ok(FinishedFrame {
                tag,
                width,
                height,
                rgba: vec![view.samples as u8; 4 * (width * height) as usize],
                samples: view.samples,
                converged: view.samples >= view.target(),
                epoch: 0,
                stats: FrameStats::default(),
                pass_times: Vec::new(),
                render_micros: 2000,
                units: 0,
                shadow_layers: 0,
            })
        };
        view.flying.push_back(Flying {
            ready: Instant::now() + FRAME,
            result,
            on_device: OnDevice::new(number, &self.on_device),
        });
        Ok(RenderOutcome::Submitted)
    }

    fn warm_up(&mut self, _scene: &Arc<Scene>) -> Result<(), RenderError> {
        Ok(())
    }

    fn go_on(&mut self, _view: &mut FakeView) -> Result<(), RenderError> {
        Ok(())
    }

    fn abandon(&mut self, _view: &mut FakeView) -> bool {
        false
    }

    fn trace_within(&mut self, _view: &mut FakeView, _budget: Option<Duration>) {}

    fn poll(&mut self) -> Result<(), RenderError> {
        self.call()
    }

    fn wait_for(&mut self, view: &FakeView) -> Result<(), RenderError> {
        if let Some(flying) = view.flying.front() {
            let waits = if flying.on_device.is_oldest() {
                &self.script.waited_for_oldest
            } else {
                &self.script.waited_for_younger
            };
            waits.fetch_add(1, Ordering::SeqCst);
            std::thread::sleep(flying.ready.saturating_duration_since(Instant::now()));
        }
        self.call()
    }

    fn take_finished(&mut self, view: &mut FakeView) -> Option<Result<FinishedFrame, FailedFrame>> {
        let held = self.script.held.load(Ordering::SeqCst);
        let ready = view
            .flying
            .front()
            .is_some_and(|flying| flying.ready <= Instant::now());
        if !ready || held || self.dead {
            return None;
        }
        view.flying.pop_front().map(|flying| flying.result)
    }

    fn plan(&self, view: &FakeView) -> Plan {
        Plan {
            passes: vec![PlannedPass {
                pass: "fake".to_owned(),
                variant: String::new(),
                reason: format!("{} media", view.scene.media.len()),
            }],
            skipped: Vec::new(),
        }
    }

    fn is_converged(&self, view: &FakeView) -> bool {
        view.samples >= view.target()
    }

    fn new_still(&self, scene: Arc<Scene>) -> FakeStill {
        FakeStill {
            view: None,
            scene,
            shown: None,
            frames: 0,
        }
    }

    fn step_still(
        &mut self,
        still: &mut FakeStill,
        _budget: Option<Duration>,
    ) -> Result<Step, RenderError> {
        if still.view.is_none() {
            let render = &still.scene.render;
            let (width, height) = (render.width, render.height);
            let view = self.create_view(Arc::clone(&still.scene), width, height)?;
            still.view = Some(view);
        }
        let Some(view) = &mut still.view else {
            return Ok(Step::Preparing);
        };
        if !view.flying.is_empty() {
            self.call()?;
            while let Some(frame) = self.take_finished(view) {
                still.shown = Some(frame?);
                still.frames += 1;
            }
            return Ok(Step::Waiting);
        }
        Ok(match self.render(view, 0)? {
            RenderOutcome::Submitted => Step::Submitted,
            RenderOutcome::Converged => Step::Finished,
            RenderOutcome::Busy => Step::Waiting,
        })
    }

    fn wait_for_still(&mut self, still: &FakeStill) -> Result<(), RenderError> {
        match &still.view {
            Some(view) => self.wait_for(view),
            None => Ok(()),
        }
    }

    fn finish_still(
        &mut self,
        still: FakeStill,
    ) -> Result<Option<tyndall_render::Still>, RenderError> {
        self.call()?;
        let pixel = |frame: &FinishedFrame| frame.width as usize * frame.height as usize;
        Ok(still.shown.map(|frame| tyndall_render::Still {
            radiance: vec![[frame.samples as f32; 4]; pixel(&frame)],
            variance: None,
            base: None,
            traced: None,
            square_error: None,
            samples_per_pixel: None,
            depth: None,
            normal: None,
            albedo: None,
            non_finite: 0,
            negative: 0,
            truncated: 0,
            frame,
        }))
    }
}
