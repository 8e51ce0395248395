/** What the page knows of the clock of a scene that moves. Times in ms are the page's own. */

import type { ClockState, SceneEdit } from '../protocol.gen';

/** Frames on their way still show the time before a seek: they don't count. Unit: ms. */
const SEEK_MILLIS = 500;

export class Clock {
  playing: boolean;
  /** The time shown. Unit: s. */
  seconds: number;
  private sought = Number.NEGATIVE_INFINITY;

  constructor(state: ClockState) {
    this.playing = state.playing;
    this.seconds = state.time_seconds;
  }

  play(playing: boolean): SceneEdit {
    this.playing = playing;
    return { playing };
  }

  /** Goes to a time and stays there. */
  seek(seconds: number, now: number): SceneEdit {
    this.playing = false;
    this.seconds = seconds;
    this.sought = now;
    return { playing: false, time_seconds: seconds };
  }

  /** A picture shows this time; whether the clock moved. */
  shown(seconds: number, now: number): boolean {
    if (seconds === this.seconds || now - this.sought < SEEK_MILLIS) return false;
    this.seconds = seconds;
    return true;
  }
}
