/** The life of the page: connect, show pictures, send what the user does. */

import { fitFieldOfView } from './camera/frame';
import { poseOf } from './camera/pose';
import { CameraRig } from './camera/rig';
import { Chrome } from './chrome';
import { Connection } from './connection';
import type { DebugState } from './debug';
import { byId } from './dom';
import { Figures } from './figures';
import { FramePainter, type PaintedFrame } from './frames';
import { Hint } from './hint';
import { CameraInput } from './input';
import { LatencyTracker } from './latency';
import { Outbox, type Size } from './outbox';
import { Overlay } from './overlay';
import { type OwnValues, ownValues } from './own';
import { field } from './panel/field';
import { Panel, presetOf } from './panel/panel';
import {
  type CameraMessage,
  type CameraPose,
  type ClientMessage,
  type ErrorMessage,
  PROTOCOL_VERSION,
  type SceneMessage,
  type ServerMessage,
  type Welcome,
} from './protocol.gen';
import { Quick } from './quick';
import { Rate } from './rate';
import { RefusedDialog } from './refused';
import { Restore } from './restore';
import { type Kept, keep, takeKept, unsaved, withKept } from './resume';
import { devicePixels, pictureSize, type ResolutionScale } from './size';
import { Steering } from './steering';
import { Toasts } from './toast';
import { streamUrl, tokenOf } from './token';
import { PictureWatch } from './watch';

const RESIZE_DEBOUNCE_MILLIS = 150;
const OVERLAY_MILLIS = 250;
const READOUT_MILLIS = 100;
/** A tab that slept must not jump. Unit: s. */
const LONGEST_STEP = 0.1;

/** Before the first scene there is nothing to see. */
const START_POSE: CameraPose = {
  position: [0, 1, 5],
  target: [0, 1, 0],
  up: [0, 1, 0],
  vertical_fov_degrees: 50,
};

export class Application {
  private readonly rig: CameraRig;
  private readonly steering: Steering;
  private readonly panel: Panel;
  private readonly quick: Quick;
  private readonly overlay: Overlay;
  private readonly figures = new Figures(byId('figures'));
  private readonly chrome: Chrome;
  private readonly watch: PictureWatch;
  private readonly refusal = new RefusedDialog();
  private readonly toasts = new Toasts(byId('toasts'));
  private readonly hint = new Hint(byId('hint'), 'Fly through', () => this.steering.setMode('fly'));
  private readonly painter: FramePainter;
  private readonly connection: Connection;
  private readonly latency = new LatencyTracker();
  private readonly frameRate = new Rate(4000);
  private readonly byteRate = new Rate(2000);
  private readonly restore = new Restore();
  private readonly kept = takeKept();
  private readonly outbox = new Outbox(this.kept?.lastInput ?? 0);
  private readonly debug: DebugState;

  private welcome: Welcome | null = null;
  private scene: SceneMessage | null = null;
  private session = this.kept?.session ?? null;
  private deepLink = new URLSearchParams(location.search).get('preset');
  private home: CameraPose | null = null;
  private own: OwnValues | null = null;
  private sentPose: CameraPose = START_POSE;
  private adoptCamera = true;
  private device: Size = { width: 16, height: 16 };
  private askedSize: Size = { width: 0, height: 0 };
  private resolution: ResolutionScale = 'auto';
  private resizeTimer: ReturnType<typeof setTimeout> | undefined;
  private bytesSeen = 0;
  private lastTick = 0;
  private overlayDue = 0;
  private readoutDue = 0;

  constructor(private readonly canvas: HTMLCanvasElement) {
    const motion = window.matchMedia('(prefers-reduced-motion: reduce)');
    this.rig = new CameraRig(START_POSE, () => motion.matches);
    this.steering = new Steering(this.rig, {
      send: (message) => this.connection.send(message),
      onMode: (mode) => {
        this.chrome.showMode(mode);
        this.debug.mode = mode;
        this.debug.navigation = this.steering.navigation;
        this.hint.hide();
      },
      onHeldUp: () => this.hint.show('A surface is in the way.'),
    });
    this.connection = new Connection(streamUrl(location.href, tokenOf(location.search)), {
      onOpen: () => this.hello(),
      onMessage: (message) => this.receive(message),
      onPicture: (message) => void this.painter.receive(message),
      onBroken: (reason) => this.complain(reason),
      mayConnect: () => this.refusal.ask(),
    });
    this.painter = new FramePainter(canvas, {
      onAcknowledge: (frame) => this.connection.send({ type: 'ack', frame }),
      onPainted: (frame) => this.painted(frame),
      onBroken: (reason) => this.complain(reason),
    });
    this.overlay = new Overlay(byId('overlay'));
    const onHome = () => this.steering.goHome();
    const onFrameAll = () => this.steering.frameAll(canvas.clientWidth / canvas.clientHeight);
    this.chrome = new Chrome({
      onHome,
      onFrameAll,
      onNextMode: () => this.steering.nextMode(),
      onOverlay: (open) => this.overlay.setOpen(open),
    });
    this.chrome.showMode(this.rig.mode);
    this.watch = new PictureWatch(byId('unseen'), canvas, {
      ask: (message) => void this.connection.send(message),
      onHome,
      onFrameAll,
      exposure: () => this.quick.exposures(),
      onExposure: (ev) => this.quick.setExposure(ev),
      onVisible: (visible, cause) => {
        this.debug.darkness = cause;
        this.debug.overexposed = visible === 'bright';
      },
    });
    const resolution = field<ResolutionScale>(
      () => this.resolution,
      (value) => {
        this.resolution = value;
        this.requestSize();
      },
    );
    this.panel = new Panel(byId('panel-body'), this.rig, resolution, {
      onEdit: (edit) => {
        this.outbox.addEdit(edit);
        this.watch.changed(performance.now());
      },
      onPreset: (name) => this.openPreset(name),
      onValues: () => this.quick.refresh(),
    });
    this.quick = new Quick(byId('quick'), {
      onPreset: (name) => this.openPreset(name),
      onChanged: () => this.panel.refresh(),
    });
    this.debug = window.__tyndall = {
      connection: 'connecting',
      welcome: null,
      connections: 0,
      sceneName: '',
      framesPainted: 0,
      lastHeader: null,
      stats: null,
      plan: null,
      latency: null,
      lastInput: 0,
      camera: null,
      mode: null,
      navigation: null,
      darkness: null,
      overexposed: false,
      errors: [],
      drop: () => this.connection.drop(),
    };
  }

  start(): void {
    new CameraInput(this.canvas, this.rig, (place) => this.steering.goTo(place));
    this.connection.state.watch((state) => {
      this.chrome.showState(state);
      this.debug.connection = state;
      if (state === 'connected') this.refusal.close();
      else this.latency.reset();
    });
    document.addEventListener('visibilitychange', () => this.tellVisibility());
    window.addEventListener('pagehide', () => this.keepSession());
    this.observeSize();
    requestAnimationFrame((now) => this.tick(now));
  }

  /** Connects once the size of the canvas is known: the first picture should fit. */
  private observeSize(): void {
    let connected = false;
    const observer = new ResizeObserver(([entry]) => {
      if (entry === undefined) return;
      this.device = devicePixels(entry);
      clearTimeout(this.resizeTimer);
      if (!connected) {
        connected = true;
        this.connection.open();
        return;
      }
      this.resizeTimer = setTimeout(() => this.requestSize(), RESIZE_DEBOUNCE_MILLIS);
    });
    try {
      observer.observe(this.canvas, { box: 'device-pixel-content-box' });
    } catch {
      observer.observe(this.canvas);
    }
  }

  private wantedSize(): Size {
    return pictureSize({
      device: this.device,
      scale: this.resolution,
      // Until the server has said what it is, as if it were slow: growing later costs nothing.
      maxPixels: this.welcome?.limits.max_pixels ?? Number.POSITIVE_INFINITY,
      maxSide: this.welcome?.limits.max_side ?? 8192,
    });
  }

  private requestSize(): void {
    const size = this.wantedSize();
    if (size.width === this.askedSize.width && size.height === this.askedSize.height) return;
    this.askedSize = size;
    this.outbox.setSize(size);
  }

  private hello(): ClientMessage {
    this.painter.reset();
    this.outbox.reconnected();
    this.askedSize = this.wantedSize();
    return {
      type: 'hello',
      protocol: PROTOCOL_VERSION,
      accept: ['jpeg', 'png'],
      ...this.askedSize,
      resume: this.session,
    };
  }

  private receive(message: ServerMessage): void {
    switch (message.type) {
      case 'welcome':
        this.welcomed(message);
        break;
      case 'scene':
        this.showScene(message);
        break;
      case 'navigation':
        // The scene before may have been known late.
        if (message.epoch === this.scene?.epoch) this.steering.advised(message);
        break;
      case 'camera':
        this.stopped(message);
        break;
      case 'picked':
        this.steering.picked(message);
        break;
      case 'darkness':
        this.watch.answered(message);
        break;
      case 'plan':
        this.debug.plan = message.plan;
        break;
      case 'stats':
        this.debug.stats = message;
        if (message.time_seconds !== undefined) this.panel.showTime(message.time_seconds);
        break;
      case 'notice':
        this.toasts.show(message.message);
        break;
      case 'error':
        this.refused(message);
        break;
    }
  }

  private welcomed(welcome: Welcome): void {
    if (this.welcome !== null && this.welcome.version !== welcome.version) {
      this.toasts.show(`the server is now version ${welcome.version}: reload this page`);
    }
    const state = this.panel.state();
    if (this.scene !== null && state !== null) {
      this.restore.begin(this.scene.name, state);
    }
    this.adoptCamera = !welcome.resumed || this.scene === null;
    this.welcome = welcome;
    this.session = welcome.session;
    this.debug.welcome = welcome;
    this.debug.connections += 1;
    this.figures.showDevice(welcome.adapter);
    this.steering.connected();
    this.requestSize();
    if (document.hidden) this.tellVisibility();
  }

  private showScene(scene: SceneMessage): void {
    this.outbox.sceneOpened();
    const presets = this.welcome?.presets ?? [];
    const another = this.scene === null || this.scene.name !== scene.name;
    // A resumed session knows better which scene is open; a new one gets the page's.
    const wanted = this.scene !== null && !this.welcome?.resumed ? this.scene : null;
    const step = this.restore.onScene(scene.name, wanted && this.presetName(wanted));
    if (step !== null && 'open' in step) {
      this.outbox.openPreset(step.open);
      return;
    }
    const epochChanged = this.scene?.epoch !== scene.epoch;
    this.scene = scene;
    this.debug.sceneName = scene.name;
    this.chrome.showScene(presetOf(scene, presets)?.title ?? scene.name);
    if (step !== null) {
      // The same scene after a reconnection: the page's state wins, nothing is rebuilt.
      this.outbox.addEdit(step.edit);
      this.outbox.setCamera(this.rig.current);
      this.adoptCamera = false;
      return;
    }
    const kept = another && this.home === null ? this.keptOf(scene) : null;
    if (another || epochChanged || this.adoptCamera) this.takeCamera(scene, another);
    this.adoptCamera = false;
    // What was edited last may not have reached the server before the page was reloaded.
    const edited = kept === null ? null : unsaved(scene.description, kept);
    if (edited !== null) this.outbox.addEdit(edited);
    this.own = kept?.own ?? ownValues(scene.description);
    this.panel.show(kept === null ? scene : withKept(scene, kept), presets);
    const { working } = this.panel;
    if (working !== null) this.quick.show(scene, presets, working, this.own);
    this.panel.showCamera(this.rig.current);
    this.followDeepLink(presets.map(({ name }) => name));
  }

  /** What this tab kept of the scene before it was reloaded, if the session goes on. */
  private keptOf(scene: SceneMessage): Kept | null {
    const resumed = this.welcome?.resumed === true && this.kept?.sceneName === scene.name;
    return resumed ? this.kept : null;
  }

  private takeCamera(scene: SceneMessage, another: boolean): void {
    const pose = poseOf(scene.description.camera);
    const kept = this.keptOf(scene);
    if (another && kept !== null && this.home === null) {
      this.home = kept.home;
      this.rig.adopt(pose, this.home);
    } else {
      this.home = fitFieldOfView(pose, this.canvas.clientWidth / this.canvas.clientHeight);
      this.rig.adopt(this.home);
    }
    if (another) {
      this.debug.mode = null;
      this.steering.opened(kept?.mode ?? null);
      this.watch.reset();
    }
    this.sentPose = pose;
  }

  private presetName(scene: SceneMessage): string | null {
    return presetOf(scene, this.welcome?.presets ?? [])?.name ?? null;
  }

  private openPreset(name: string): void {
    this.restore.cancel();
    this.outbox.openPreset(name);
  }

  /** `?preset=name` opens that preset, once. */
  private followDeepLink(known: readonly string[]): void {
    const name = this.deepLink;
    this.deepLink = null;
    if (name === null || this.welcome?.resumed === true) return;
    if (!known.includes(name)) this.toasts.show(`there is no preset "${name}"`);
    else if (this.scene !== null && this.presetName(this.scene) !== name) this.openPreset(name);
  }

  private refused(error: ErrorMessage): void {
    this.complain(error.message, error.path);
    // Another tab goes on with that session; this one gets its own, and brings its state along.
    if (error.code === 'taken_over') this.session = null;
    if (error.input === undefined) return;
    this.latency.forget(error.input);
    this.outbox.refused(error.input);
    this.panel.refuse(error.input);
  }

  private painted({ header, painted, decodeMillis }: PaintedFrame): void {
    this.chrome.hideWaiting();
    this.frameRate.add(painted);
    this.latency.painted({
      appliedInput: header.appliedInput,
      painted,
      renderMillis: header.renderMicros / 1000,
      encodeMillis: header.encodeMicros / 1000,
      decodeMillis,
    });
    this.panel.settle(header.appliedInput);
    this.watch.painted();
    this.debug.framesPainted += 1;
    this.debug.lastHeader = header;
  }

  /** Once an animation frame: move the camera, send what changed, now and then show figures. */
  private tick(now: number): void {
    const seconds = Math.min(LONGEST_STEP, Math.max(0, (now - this.lastTick) / 1000));
    this.lastTick = now;
    if (this.rig.tick(seconds, this.sentPose)) {
      this.sentPose = this.rig.current;
      this.outbox.setCamera(this.sentPose, !this.rig.takeThrough());
      this.watch.changed(now);
    }
    this.watch.tick(now);
    if (this.connection.state.value === 'connected') this.flush();
    if (now >= this.readoutDue) {
      this.readoutDue = now + READOUT_MILLIS;
      this.showPose();
    }
    if (now >= this.overlayDue) {
      this.overlayDue = now + OVERLAY_MILLIS;
      this.showFigures();
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  private flush(): void {
    this.outbox.flush((message) => {
      if (!this.connection.send(message)) return false;
      // Opening a scene or a new size is not a motion.
      const motion = message.type === 'camera' || message.type === 'edit';
      if (motion) this.latency.sent(message.input, performance.now());
      if (message.type === 'edit') this.panel.editSent(message.input);
      if (message.type === 'camera') this.steering.left(message.input, message.camera);
      this.debug.lastInput = message.input;
      return true;
    });
  }

  /** A surface stopped the eye: the page's camera follows. */
  private stopped(message: CameraMessage): void {
    if (!this.steering.stopped(message)) return;
    this.sentPose = this.rig.current;
    this.outbox.dropCamera();
  }

  private showPose(): void {
    if (this.debug.camera === this.rig.current) return;
    this.debug.camera = this.rig.current;
    this.panel.showCamera(this.rig.current);
  }

  private showFigures(): void {
    const now = performance.now();
    this.byteRate.add(now, this.connection.bytesReceived - this.bytesSeen);
    this.bytesSeen = this.connection.bytesReceived;
    this.debug.latency = this.latency.summary();
    this.figures.show(this.debug.lastHeader, this.frameRate.frequency(now));
    this.overlay.show({
      header: this.debug.lastHeader,
      stats: this.debug.stats,
      plan: this.debug.plan,
      latency: this.debug.latency,
      latencyHistory: this.latency.history(),
      framesPerSecond: this.frameRate.frequency(now),
      bytesPerSecond: this.byteRate.perSecond(now),
    });
  }

  private tellVisibility(): void {
    this.connection.send({ type: 'visible', visible: !document.hidden });
  }

  private keepSession(): void {
    const edit = this.panel.state();
    const { session, own, home } = this;
    if (session === null || this.scene === null || home === null) return;
    if (own === null || edit === null) return;
    keep({
      session,
      lastInput: this.outbox.newestInput,
      sceneName: this.scene.name,
      home,
      mode: this.rig.mode,
      edit,
      own,
    });
  }

  private complain(message: string, path?: string): void {
    this.debug.errors.push(message);
    if (this.debug.errors.length > 100) this.debug.errors.shift();
    this.toasts.show(message, path);
  }
}
