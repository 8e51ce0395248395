/** One folder a participating medium. */

import type { GUI } from 'lil-gui';
import type { Vec3 } from '../camera/vec';
import { titled, words } from '../format';
import type { MediumDescription } from '../protocol.gen';
import { toVec3 } from './colour';
import { field } from './field';
import { addColourToggle, addSlider, addSpectrum } from './rows';
import { VectorController } from './vector';

const PER_METRE = 'm⁻¹';
/** From haze over kilometres to milk. */
const COEFFICIENT = { min: 1e-4, max: 100, unit: PER_METRE };

export function addMedium(
  parent: GUI,
  medium: MediumDescription,
  index: number,
  changed: () => void,
): void {
  const folder = parent.addFolder(mediumTitle(medium, index));
  const touch = <T>(get: () => T, set: (value: T) => void) =>
    field(get, (value: T) => {
      set(value);
      changed();
    });

  const scattering = touch<Vec3>(
    () => toVec3(medium.sigma_s),
    (value) => {
      medium.sigma_s = value;
    },
  );
  const absorption = touch<Vec3>(
    () => toVec3(medium.sigma_a),
    (value) => {
      medium.sigma_a = value;
    },
  );
  const scatteringRows = addSpectrum(folder, scattering, 'Scattering σₛ', 'σₛ colour', COEFFICIENT);
  const absorptionRows = addSpectrum(folder, absorption, 'Absorption σₐ', 'σₐ colour', COEFFICIENT);
  addColourToggle(folder, [
    { target: scattering, colour: scatteringRows.colour },
    { target: absorption, colour: absorptionRows.colour },
  ]);
  // A phase function of its own takes the place of g, and is edited in the scene's file.
  if (medium.phase === undefined) {
    const anisotropy = touch(
      () => medium.g,
      (value) => {
        medium.g = value;
      },
    );
    addSlider(folder, anisotropy, 'Anisotropy g', { min: -0.95, max: 0.95, step: 0.01 });
  }
  const density = touch(
    () => medium.density_scale,
    (value) => {
      medium.density_scale = value;
    },
  );
  addSlider(folder, density, 'Density', { min: 0.01, max: 100, log: true, zero: true, unit: '×' });
  addShape(folder, medium, touch);
}

type Touch = <T>(get: () => T, set: (value: T) => void) => { value: T };

function addShape(folder: GUI, medium: MediumDescription, touch: Touch): void {
  if (medium.kind === 'height_fog') {
    const falloff = touch(
      () => medium.falloff,
      (value) => {
        medium.falloff = value;
      },
    );
    const range = { min: 1e-3, max: 10, log: true, zero: true, unit: PER_METRE };
    addSlider(folder, falloff, 'Height falloff', range);
    const base = touch<Vec3>(
      () => medium.origin,
      (value) => {
        medium.origin = value;
      },
    );
    new VectorController(folder, base, 'Base', 'm', 0.05);
  }
  if (medium.kind === 'sphere') {
    const radius = touch(
      () => medium.radius,
      (value) => {
        medium.radius = value;
      },
    );
    addSlider(folder, radius, 'Radius', { min: 0.01, max: 100, log: true, unit: 'm' });
    const center = touch<Vec3>(
      () => medium.center,
      (value) => {
        medium.center = value;
      },
    );
    new VectorController(folder, center, 'Centre', 'm', 0.02);
  }
}

function mediumTitle(medium: MediumDescription, index: number): string {
  return titled(medium.name ?? `${words(medium.kind)} ${index + 1}`);
}
