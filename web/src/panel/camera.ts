/** Field of view, where the eye is, how fast it flies. */

import type { GUI } from 'lil-gui';
import { reach } from '../camera/pose';
import type { CameraRig } from '../camera/rig';
import type { Vec3 } from '../camera/vec';
import { significant } from '../format';
import type { CameraPose } from '../protocol.gen';
import { field } from './field';
import { addButton, addReadout, addSlider } from './rows';

export interface CameraFolder {
  show(pose: CameraPose): void;
}

export function addCamera(folder: GUI, rig: CameraRig): CameraFolder {
  const fov = field(
    () => rig.current.vertical_fov_degrees,
    (value) => rig.setFov(Math.min(170, Math.max(0.1, value))),
  );
  const fovRow = addSlider(folder, fov, 'Field of view', { min: 10, max: 120, step: 1, unit: '°' });
  const speed = field(
    () => rig.speed,
    (value) => {
      rig.speed = Math.max(0, value);
    },
  );
  addSlider(folder, speed, 'Flight speed', { min: 0.05, max: 100, log: true, unit: 'm/s' });
  const position = addReadout(folder, 'Position');
  const target = addReadout(folder, 'Target');
  const distance = addReadout(folder, 'Distance');
  addButton(folder, 'Reset camera', () => rig.goHome());
  return {
    show: (pose) => {
      position.set(coordinates(pose.position));
      target.set(coordinates(pose.target));
      distance.set(`${significant(reach(pose))} m`);
      fovRow.updateDisplay();
    },
  };
}

function coordinates(point: Vec3): string {
  return point.map((value) => value.toFixed(2).replace('-', '−')).join('  ');
}
