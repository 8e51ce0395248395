/** One folder a light. */

import type { GUI } from 'lil-gui';
import type { Vec3 } from '../camera/vec';
import { titled, words } from '../format';
import type { LightDescription } from '../protocol.gen';
import { toVec3 } from './colour';
import { field } from './field';
import { addCheckbox, addDirection, addSlider, addSpectrum } from './rows';
import { VectorController } from './vector';

const INTENSITY = { min: 0.01, max: 1e4, unit: 'W/sr' };
const IRRADIANCE = { min: 0.01, max: 1e4, unit: 'W/m²' };
const RADIANCE = { min: 1e-3, max: 1e3, unit: 'W/m²sr' };

export function addLight(
  parent: GUI,
  light: LightDescription,
  index: number,
  changed: () => void,
): void {
  const folder = parent.addFolder(lightTitle(light, index));
  const touch = <T>(get: () => T, set: (value: T) => void) =>
    field(get, (value: T) => {
      set(value);
      changed();
    });

  if (light.kind === 'environment') {
    const radiance = touch<Vec3>(
      () => toVec3(light.radiance),
      (value) => {
        light.radiance = value;
      },
    );
    addSpectrum(folder, radiance, 'Radiance', 'Colour', RADIANCE);
    return;
  }
  const moves = (light.keyframes?.length ?? 0) > 0;
  if (light.kind === 'directional') {
    const irradiance = touch<Vec3>(
      () => toVec3(light.irradiance),
      (value) => {
        light.irradiance = value;
      },
    );
    addSpectrum(folder, irradiance, 'Irradiance', 'Colour', IRRADIANCE);
  } else {
    const intensity = touch<Vec3>(
      () => toVec3(light.intensity),
      (value) => {
        light.intensity = value;
      },
    );
    addSpectrum(folder, intensity, 'Intensity', 'Colour', INTENSITY);
    const position = touch<Vec3>(
      () => light.position,
      (value) => {
        light.position = value;
      },
    );
    // Keyframes replace the pose.
    if (!moves) new VectorController(folder, position, 'Position', 'm', 0.05);
  }
  if (light.kind !== 'point' && !moves) {
    const direction = touch<Vec3>(
      () => light.direction,
      (value) => {
        light.direction = value;
      },
    );
    addDirection(folder, direction, light.kind === 'directional');
  }
  if (light.kind === 'spot') addCone(folder, light, touch);
  if (light.kind !== 'directional') {
    const radius = touch(
      () => light.radius,
      (value) => {
        light.radius = value;
      },
    );
    addSlider(folder, radius, 'Radius', { min: 0.001, max: 1, log: true, unit: 'm' });
  }
  const shadows = touch(
    () => light.casts_shadows,
    (value) => {
      light.casts_shadows = value;
    },
  );
  addCheckbox(folder, shadows, 'Casts shadows');
}

function lightTitle(light: LightDescription, index: number): string {
  return titled(light.name ?? `${words(light.kind)} light ${index + 1}`);
}

/** The server wants the inner angle below the outer: moving one pushes the other. Degrees. */
const GAP = 0.5;

function addCone(
  folder: GUI,
  light: Extract<LightDescription, { kind: 'spot' }>,
  touch: <T>(get: () => T, set: (value: T) => void) => { value: T },
): void {
  const inner = touch(
    () => light.inner_angle_degrees,
    (value) => {
      light.inner_angle_degrees = value;
      light.outer_angle_degrees = Math.max(light.outer_angle_degrees, value + GAP);
    },
  );
  const outer = touch(
    () => light.outer_angle_degrees,
    (value) => {
      light.outer_angle_degrees = value;
      light.inner_angle_degrees = Math.min(light.inner_angle_degrees, Math.max(0, value - GAP));
    },
  );
  const unit = '°';
  const innerRow = addSlider(folder, inner, 'Inner angle', { min: 0, max: 89, step: 0.5, unit });
  const outerRow = addSlider(folder, outer, 'Outer angle', { min: 1, max: 89.5, step: 0.5, unit });
  innerRow.onChange(() => outerRow.updateDisplay());
  outerRow.onChange(() => innerRow.updateDisplay());
}
