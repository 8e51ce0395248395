/** A short way from one pose to another, eased at both ends. */

import type { CameraPose } from '../protocol.gen';
import { between } from './pose';

const SECONDS = 0.4;

export class Travel {
  /** Where the way has come to. */
  at: CameraPose;
  private elapsed = 0;

  /** `through` surfaces, or stopped by them. */
  constructor(
    private readonly from: CameraPose,
    private readonly to: CameraPose,
    readonly through: boolean,
  ) {
    this.at = from;
  }

  get done(): boolean {
    return this.elapsed >= SECONDS;
  }

  /** The pose after `seconds` more. */
  advance(seconds: number): CameraPose {
    this.elapsed += seconds;
    const t = Math.min(1, this.elapsed / SECONDS);
    this.at = t === 1 ? this.to : between(this.from, this.to, t * t * (3 - 2 * t));
    return this.at;
  }
}
