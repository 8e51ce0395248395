/** The folder of a scene that moves: play or pause, and a slider that follows and seeks. */

import type { GUI } from 'lil-gui';
import type { ClockState, SceneEdit } from '../protocol.gen';
import { Clock } from './clock';
import { field } from './field';
import { addCheckbox, addSlider } from './rows';

export interface TimeFolder {
  /** A picture shows this time. Unit: s. */
  show(seconds: number): void;
}

export function addTime(
  folder: GUI,
  state: ClockState,
  send: (edit: SceneEdit) => void,
): TimeFolder {
  const clock = new Clock(state);
  const play = field(
    () => clock.playing,
    (value) => send(clock.play(value)),
  );
  const time = field(
    () => clock.seconds,
    (value) => {
      send(clock.seek(value, performance.now()));
      playRow.updateDisplay();
    },
  );
  const playRow = addCheckbox(folder, play, 'Play');
  const max = Math.max(state.duration_seconds, 0.01);
  const timeRow = addSlider(folder, time, 'Time', { min: 0, max, step: 0.01, unit: 's' });
  return {
    show: (seconds) => {
      if (clock.shown(seconds, performance.now())) timeRow.updateDisplay();
    },
  };
}
