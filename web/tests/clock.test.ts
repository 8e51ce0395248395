import { describe, expect, it } from 'vitest';
import { Clock } from '../src/panel/clock';

const START = { playing: true, time_seconds: 1, duration_seconds: 6 };

describe('the clock of a scene that moves', () => {
  it('follows the pictures', () => {
    const clock = new Clock(START);
    expect(clock.shown(1, 0)).toBe(false);
    expect(clock.shown(1.5, 0)).toBe(true);
    expect(clock.seconds).toBe(1.5);
  });

  it('pauses where it is sent, and frames of the time before do not move it', () => {
    const clock = new Clock(START);
    expect(clock.seek(4, 1000)).toEqual({ playing: false, time_seconds: 4 });
    expect(clock.playing).toBe(false);
    expect(clock.shown(1.6, 1400)).toBe(false);
    expect(clock.seconds).toBe(4);
    expect(clock.play(true)).toEqual({ playing: true });
    expect(clock.shown(4.1, 1600)).toBe(true);
  });
});
