/** The camera the user steers: takes intents, gives one pose an animation frame. */

import type { CameraPose } from '../protocol.gen';
import { type FlightWish, flightVelocity, fly } from './fly';
import { Glide } from './glide';
import { look, metresPerPixel, orbit, pan, zoom } from './orbit';
import { between, reach, samePose } from './pose';
import { length } from './vec';

/** Keys held down, each −1, 0 or +1. */
export interface HeldKeys extends FlightWish {
  orbitLeft: number;
  orbitUp: number;
  zoomIn: number;
}

export const NO_KEYS: HeldKeys = {
  right: 0,
  up: 0,
  forward: 0,
  fast: false,
  orbitLeft: 0,
  orbitUp: 0,
  zoomIn: 0,
};

/** A drag over the picture's whole height turns by half a circle. Unit: rad. */
const TURN_PER_HEIGHT = Math.PI;
/** Unit: rad/s. */
const KEY_TURN_RATE = 1.2;
/** Natural logarithm of the distance a second. */
const KEY_ZOOM_RATE = 1.4;
/** The share of a wheel's zoom still to come falls by 1/e in this time. Unit: s. */
const ZOOM_LAG_SECONDS = 0.06;
const RETURN_SECONDS = 0.35;

export class CameraRig {
  /** Unit: m/s. */
  speed = 2;
  keys: HeldKeys = NO_KEYS;
  private pose: CameraPose;
  private home: CameraPose;
  private returning: { from: CameraPose; elapsed: number } | null = null;
  private pendingZoom = 0;
  private readonly flight: Glide;
  private readonly turning: Glide;

  constructor(
    pose: CameraPose,
    private readonly reducedMotion: () => boolean,
  ) {
    this.pose = this.home = pose;
    this.flight = new Glide(reducedMotion);
    this.turning = new Glide(reducedMotion);
  }

  get current(): CameraPose {
    return this.pose;
  }

  /** Takes over a scene's camera, without an animation. */
  adopt(pose: CameraPose, home: CameraPose = pose): void {
    this.pose = pose;
    this.home = home;
    this.speed = Math.min(50, Math.max(0.1, reach(home) * 0.35));
    this.halt();
  }

  setFov(degrees: number): void {
    this.pose = { ...this.pose, vertical_fov_degrees: degrees };
  }

  /** Drag of (dx, dy) pixels over a picture `height` pixels high. */
  dragOrbit(dx: number, dy: number, height: number): void {
    this.returning = null;
    const turn = TURN_PER_HEIGHT / Math.max(1, height);
    this.pose = orbit(this.pose, dx * turn, dy * turn);
  }

  dragLook(dx: number, dy: number, height: number): void {
    this.returning = null;
    const fov = (this.pose.vertical_fov_degrees / 180) * Math.PI;
    const turn = (1.5 * fov) / Math.max(1, height);
    this.pose = look(this.pose, -dx * turn, -dy * turn);
  }

  dragPan(dx: number, dy: number, height: number): void {
    this.returning = null;
    const metres = metresPerPixel(this.pose, height);
    this.pose = pan(this.pose, -dx * metres, dy * metres);
  }

  /** Multiplies the distance by `factor`, at once (pinch) or softly (wheel). */
  zoomBy(factor: number, soft: boolean): void {
    this.returning = null;
    if (soft && !this.reducedMotion()) this.pendingZoom += Math.log(factor);
    else this.pose = zoom(this.pose, factor);
  }

  goHome(): void {
    this.halt();
    if (this.reducedMotion()) this.pose = this.home;
    else this.returning = { from: this.pose, elapsed: 0 };
  }

  /** Advances by `seconds`; true when the pose differs from that of the last call. */
  tick(seconds: number, before: CameraPose): boolean {
    if (this.returning !== null) this.stepHome(this.returning, seconds);
    this.stepZoom(seconds);
    this.stepKeys(seconds);
    return !samePose(before, this.pose);
  }

  private halt(): void {
    this.returning = null;
    this.pendingZoom = 0;
    this.flight.stop();
    this.turning.stop();
  }

  private stepHome(state: { from: CameraPose; elapsed: number }, seconds: number): void {
    state.elapsed += seconds;
    const t = Math.min(1, state.elapsed / RETURN_SECONDS);
    const eased = t * t * (3 - 2 * t);
    this.pose = t === 1 ? this.home : between(state.from, this.home, eased);
    if (t === 1) this.returning = null;
  }

  private stepZoom(seconds: number): void {
    if (this.pendingZoom === 0) return;
    let part = this.pendingZoom * -Math.expm1(-seconds / ZOOM_LAG_SECONDS);
    if (Math.abs(this.pendingZoom) < 1e-3) part = this.pendingZoom;
    this.pendingZoom -= part;
    this.pose = zoom(this.pose, Math.exp(part));
  }

  private stepKeys(seconds: number): void {
    const { keys } = this;
    const velocity = flightVelocity(keys, this.speed);
    if (length(velocity) > 0 || this.flight.moving) {
      this.returning = null;
      this.pose = fly(this.pose, this.flight.advance(velocity, seconds));
    }
    const turn: [number, number, number] = [
      keys.orbitLeft * KEY_TURN_RATE,
      keys.orbitUp * KEY_TURN_RATE,
      keys.zoomIn * KEY_ZOOM_RATE,
    ];
    if (length(turn) > 0 || this.turning.moving) {
      this.returning = null;
      const [left, up, closer] = this.turning.advance(turn, seconds);
      this.pose = zoom(orbit(this.pose, left, up), Math.exp(-closer));
    }
  }
}
