/**
 * Brings the page's camera to where surfaces stopped it on the server, without a jump: what the user did
 * since the message that was stopped is kept on top.
 */

import type { CameraPose } from '../protocol.gen';
import { samePose } from './pose';
import type { Vec3 } from './vec';
import { add, subtract } from './vec';

/** Messages whose answers may still come. */
const MOST = 256;

interface Sent {
  input: number;
  pose: CameraPose;
  /** What the page's camera was moved by since this message left. Unit: m. */
  eye: Vec3;
  target: Vec3;
}

export class Follower {
  private sent: Sent[] = [];

  /** A camera left under this number. */
  left(input: number, pose: CameraPose): void {
    this.sent.push({ input, pose, eye: [0, 0, 0], target: [0, 0, 0] });
    if (this.sent.length > MOST) this.sent.shift();
  }

  /** Another scene or connection: no answer is for this camera any more. */
  reset(): void {
    this.sent = [];
  }

  /** The camera that follows from `now` when the server says where the one sent as `input` ended. */
  stopped(input: number, at: CameraPose, now: CameraPose): CameraPose {
    const answered = this.sent.find((sent) => sent.input === input);
    if (answered === undefined) return now;
    this.sent = this.sent.filter((sent) => sent.input > input);
    const eye = subtract(at.position, add(answered.pose.position, answered.eye));
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
