/** Tells double taps and double clicks from drags, the same way for mouse, pen and finger. */

const LONGEST_TAP_MILLIS = 350;
const LONGEST_PAUSE_MILLIS = 350;
/** How far a tap may slip, and two of them lie apart. Unit: CSS pixel. */
const SLIP = 8;
const APART = 30;

interface Tap {
  x: number;
  y: number;
  time: number;
}

const distance = (a: Tap, b: Tap): number => Math.hypot(a.x - b.x, a.y - b.y);

export class Taps {
  private pressed: Tap | null = null;
  private last: Tap | null = null;

  down(x: number, y: number, time: number): void {
    this.pressed = { x, y, time };
  }

  /** A second finger, a wheel or a lost pointer: this is no tap. */
  spoil(): void {
    this.pressed = this.last = null;
  }

  /** True if this ends the second of two taps. */
  up(x: number, y: number, time: number): boolean {
    const { pressed, last } = this;
    const tap = { x, y, time };
    this.pressed = this.last = null;
    if (pressed === null) return false;
    if (distance(pressed, tap) > SLIP || time - pressed.time > LONGEST_TAP_MILLIS) return false;
    if (last !== null && pressed.time - last.time < LONGEST_PAUSE_MILLIS) {
      if (distance(last, tap) < APART) return true;
    }
    this.last = tap;
    return false;
  }
}
