/** The camera the user steers: takes intents, gives one pose an animation frame. */

import type { CameraPose, Navigation } from '../protocol.gen';
import { type FlightWish, flightVelocity, fly } from './fly';
import { Glide } from './glide';
import { look, metresPerPixel, orbit, pan, zoom } from './orbit';
import { basis, reach, samePose } from './pose';
import { Travel } from './travel';
import type { Vec3 } from './vec';
import { add, length, scale, subtract } from './vec';
import { approach, levelDirection, shift } from './walk';

/** Keys held down, each −1, 0 or +1. */
export interface HeldKeys extends FlightWish {
  turnLeft: number;
  turnUp: number;
  nearer: number;
}

export const NO_KEYS: HeldKeys = {
  right: 0,
  up: 0,
  forward: 0,
  fast: false,
  turnLeft: 0,
  turnUp: 0,
  nearer: 0,
};

/** A drag over the picture's whole height turns an orbit by half a circle. Unit: rad. */
const ORBIT_PER_HEIGHT = Math.PI;
/** A drag over the picture's whole height turns the head by this many fields of view. */
const LOOK_PER_HEIGHT = 1.5;
/** Unit: rad/s. */
const KEY_TURN_RATE = 1.2;
/** Natural logarithm of the distance a second. */
const KEY_ZOOM_RATE = 1.4;
/** A notch of the wheel changes an orbit's distance by an eighth. */
const ZOOM_PER_NOTCH = Math.log(1.125);
/** A notch of the wheel is so much walking. Unit: s. */
const WALK_PER_NOTCH = 0.35;
/** A pinch to twice the distance of the fingers is so much walking. Unit: s. */
const WALK_PER_PINCH = 2;
/** The share of a wheel's way still to come falls by 1/e in this time. Unit: s. */
const WHEEL_LAG_SECONDS = 0.06;
/** Walking speed as a share of the scene's size. Unit: 1/s. */
const SPEED_PER_EXTENT = 0.06;
/** A sidestep moves what is no farther than this share of the scene's size along with the pointer. */
const SIDESTEP_REACH = 0.25;

export class CameraRig {
  /** Unit: m/s. */
  speed = 2;
  keys: HeldKeys = NO_KEYS;
  private steering: Navigation = 'orbit';
  private pose: CameraPose;
  private home: CameraPose;
  /** Size of what is worth looking at. Unit: m. */
  private extent = 10;
  private travel: Travel | null = null;
  /** Wheel notches still to come, and the direction they walk in. */
  private pending = 0;
  private aim: Vec3 = [0, 0, -1];
  /** Since the last `takeThrough`, something moved that surfaces don't stop. */
  private through = false;
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

  get mode(): Navigation {
    return this.steering;
  }

  set mode(mode: Navigation) {
    this.halt();
    this.steering = mode;
  }

  get homePose(): CameraPose {
    return this.home;
  }

  /** Takes over a scene's camera, without an animation. */
  adopt(pose: CameraPose, home: CameraPose = pose): void {
    this.pose = pose;
    this.home = home;
    this.halt();
  }

  /** Takes over how large the scene is. Unit: m. */
  setExtent(extent: number): void {
    this.extent = Math.max(extent, 1e-3);
    this.speed = Math.min(50, Math.max(0.02, SPEED_PER_EXTENT * this.extent));
  }

  /** Follows where a surface stopped the eye; what moves goes on. */
  correct(pose: CameraPose): void {
    this.pose = pose;
  }

  setFov(degrees: number): void {
    this.pose = { ...this.pose, vertical_fov_degrees: degrees };
  }

  /** Puts the pivot at a distance along the view, which changes no picture. Unit: m. */
  setPivotDistance(distance: number): void {
    if (Math.abs(distance - reach(this.pose)) < 1e-9 * distance) return;
    const target = add(this.pose.position, scale(basis(this.pose).forward, distance));
    if (samePose(this.pose, this.home)) this.home = { ...this.home, target };
    this.pose = { ...this.pose, target };
  }

  /** Drag of (dx, dy) pixels over a picture `height` pixels high. */
  drag(dx: number, dy: number, height: number): void {
    this.travel = null;
    const pixels = Math.max(1, height);
    if (this.steering === 'orbit' && !this.flight.moving) {
      const turn = ORBIT_PER_HEIGHT / pixels;
      this.pose = orbit(this.pose, dx * turn, dy * turn);
    } else {
      const fov = (this.pose.vertical_fov_degrees / 180) * Math.PI;
      const turn = (LOOK_PER_HEIGHT * fov) / pixels;
      this.pose = look(this.pose, dx * turn, dy * turn);
    }
  }

  dragPan(dx: number, dy: number, height: number): void {
    this.travel = null;
    const far = Math.max(1e-9, reach(this.pose));
    const near = this.steering === 'orbit' ? far : Math.min(far, SIDESTEP_REACH * this.extent);
    const metres = (metresPerPixel(this.pose, height) * near) / far;
    this.pose = pan(this.pose, -dx * metres, dy * metres);
    this.noteFlight();
  }

  /** The wheel, positive away from the user, at a direction in the world. */
  wheel(notches: number, aim: Vec3): void {
    this.travel = null;
    this.aim = aim;
    if (this.reducedMotion()) this.wheelBy(notches);
    else this.pending += notches;
  }

  /** Two fingers moved apart by `factor`. */
  pinch(factor: number, aim: Vec3): void {
    this.travel = null;
    this.aim = aim;
    const notches = Math.log(factor);
    if (this.steering === 'orbit') this.pose = zoom(this.pose, 1 / factor);
    else this.wheelBy((notches * WALK_PER_PINCH) / WALK_PER_NOTCH);
  }

  goHome(): void {
    this.go(this.home, true);
  }

  /** Goes to a pose softly, through surfaces or stopped by them. */
  go(pose: CameraPose, through: boolean): void {
    this.halt();
    if (this.reducedMotion()) {
      this.pose = pose;
      this.through ||= through;
    } else this.travel = new Travel(this.pose, pose, through);
  }

  /** What a double click on a point means: turn about it, or walk up to it. */
  goTo(point: Vec3, normal: Vec3 | null): void {
    if (this.steering === 'orbit') this.go({ ...this.pose, target: point }, false);
    else this.go(approach(this.pose, point, normal), this.steering === 'fly');
  }

  /** Advances by `seconds`; true when the pose differs from `before`. */
  tick(seconds: number, before: CameraPose): boolean {
    this.stepTravel(seconds);
    this.stepWheel(seconds);
    this.stepKeys(seconds);
    return !samePose(before, this.pose);
  }

  /** Whether surfaces let the camera through, asked once a message. */
  takeThrough(): boolean {
    const { through } = this;
    this.through = false;
    return through;
  }

  private halt(): void {
    this.travel = null;
    this.pending = 0;
    this.flight.stop();
    this.turning.stop();
  }

  private noteFlight(): void {
    if (this.steering === 'fly') this.through = true;
  }

  private stepTravel(seconds: number): void {
    if (this.travel === null) return;
    const { travel } = this;
    const before = travel.at;
    const next = travel.advance(seconds);
    if (travel.through) this.pose = next;
    else {
      // Step by step, so that a surface on the way keeps what it took.
      const step = (from: Vec3, to: Vec3, now: Vec3) => add(now, subtract(to, from));
      this.pose = {
        ...next,
        position: step(before.position, next.position, this.pose.position),
        target: step(before.target, next.target, this.pose.target),
      };
    }
    this.through ||= travel.through;
    if (travel.done) this.travel = null;
  }

  private stepWheel(seconds: number): void {
    if (this.pending === 0) return;
    let part = this.pending * -Math.expm1(-seconds / WHEEL_LAG_SECONDS);
    if (Math.abs(this.pending) < 1e-2) part = this.pending;
    this.pending -= part;
    this.wheelBy(part);
  }

  private wheelBy(notches: number): void {
    if (this.steering === 'orbit') {
      this.pose = zoom(this.pose, Math.exp(-notches * ZOOM_PER_NOTCH));
      return;
    }
    const way =
      this.steering === 'fly' ? basis(this.pose).forward : levelDirection(this.pose, this.aim);
    this.pose = shift(this.pose, way, notches * WALK_PER_NOTCH * this.speed);
    this.noteFlight();
  }

  private stepKeys(seconds: number): void {
    const { keys } = this;
    const velocity = flightVelocity(keys, this.speed);
    if (length(velocity) > 0 || this.flight.moving) {
      this.travel = null;
      this.through = true;
      this.pose = fly(this.pose, this.flight.advance(velocity, seconds));
    }
    const wish: Vec3 = [keys.turnLeft * KEY_TURN_RATE, keys.turnUp * KEY_TURN_RATE, keys.nearer];
    if (length(wish) > 0 || this.turning.moving) {
      this.travel = null;
      const [left, up, nearer] = this.turning.advance(wish, seconds);
      if (this.steering === 'orbit') {
        this.pose = zoom(orbit(this.pose, left, up), Math.exp(-nearer * KEY_ZOOM_RATE));
      } else {
        this.pose = look(this.pose, left, up);
        this.aim = basis(this.pose).forward;
        this.wheelBy(nearer / WALK_PER_NOTCH);
      }
    }
  }
}
