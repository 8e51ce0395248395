/**
 * Brings the page's camera to where surfaces stopped it on the server, without a jump: what the user did
 * since the message that was stopped is kept on top.
 */

import type { CameraPose } from '../protocol.gen';
import { samePose } from './pose';
import type { Vec3 } from './vec';
import { add, length, subtract } from './vec';

/** Messages whose answers may still come. */
const MOST = 256;
/** Share of a step that a surface must take for the eye to be held up, and not to slide along it. */
const HELD_UP = 0.5;

interface Sent {
  input: number;
  pose: CameraPose;
  /** What the page's camera was moved by since this message left. Unit: m. */
  eye: Vec3;
  target: Vec3;
}

export class Follower {
  private sent: Sent[] = [];
  /** Where the eye was stopped last. Unit: m. */
  private last: Vec3 | null = null;
  private heldUp = false;

  /** Whether the last answer left less than half of the way since the one before. */
  get isHeldUp(): boolean {
    return this.heldUp;
  }

  /** A camera left under this number. */
  left(input: number, pose: CameraPose): void {
    this.sent.push({ input, pose, eye: [0, 0, 0], target: [0, 0, 0] });
    if (this.sent.length > MOST) this.sent.shift();
  }

  /** Another scene or connection: no answer is for this camera any more. */
  reset(): void {
    this.sent = [];
    this.last = null;
    this.heldUp = false;
  }

  /** The camera that follows from `now` when the server says where the one sent as `input` ended. */
  stopped(input: number, at: CameraPose, now: CameraPose): CameraPose {
    const answered = this.sent.find((sent) => sent.input === input);
    this.heldUp = false;
    if (answered === undefined) return now;
    this.sent = this.sent.filter((sent) => sent.input > input);
    const wished = add(answered.pose.position, answered.eye);
    const eye = subtract(at.position, wished);
    const step = this.last === null ? Number.POSITIVE_INFINITY : distance(wished, this.last);
    this.heldUp = length(eye) > HELD_UP * step;
    this.last = at.position;
    const target = subtract(at.target, add(answered.pose.target, answered.target));
    for (const later of this.sent) {
      later.eye = add(later.eye, eye);
      later.target = add(later.target, target);
    }
    // Nothing happened since: exactly what the server shows, so that nothing is sent again.
    if (samePose(answered.pose, now)) return at;
    return { ...now, position: add(now.position, eye), target: add(now.target, target) };
  }
}

function distance(a: Vec3, b: Vec3): number {
  return length(subtract(a, b));
}
