/** A velocity that follows its wish with a lag: motion that starts and ends softly. */

import type { Vec3 } from './vec';
import { add, length, scale, subtract } from './vec';

/** Time after which about two thirds of a change has happened. Unit: s. */
const LAG_SECONDS = 0.09;

export class Glide {
  private velocity: Vec3 = [0, 0, 0];

  /** `still` drops the lag (the user prefers reduced motion). */
  constructor(private readonly still: () => boolean = () => false) {}

  get moving(): boolean {
    return length(this.velocity) > 0;
  }

  stop(): void {
    this.velocity = [0, 0, 0];
  }

  /**
   * The way travelled in `seconds` while the velocity decays toward `wish`, integrated exactly, so
   * that the way does not depend on the frame rate.
   */
  advance(wish: Vec3, seconds: number): Vec3 {
    if (this.still()) {
      this.velocity = wish;
      return scale(wish, seconds);
    }
    const excess = subtract(this.velocity, wish);
    const decayed = -Math.expm1(-seconds / LAG_SECONDS);
    const way = add(scale(wish, seconds), scale(excess, LAG_SECONDS * decayed));
    this.velocity = add(wish, scale(excess, 1 - decayed));
    // A tail nobody sees would keep the server from converging.
    if (length(wish) === 0 && length(this.velocity) < 1e-3) this.velocity = [0, 0, 0];
    return way;
  }
}
