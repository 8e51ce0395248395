/** Technique and quality. */

import type { GUI } from 'lil-gui';
import { words } from '../format';
import type { CorrectionMode, RenderDescription, ShadowMode, Technique } from '../protocol.gen';
import type { ResolutionScale } from '../size';
import { type Field, field } from './field';
import { addCheckbox, addSelect, addSlider } from './rows';
import { addScreenSpace } from './screen_space';

const TECHNIQUES: readonly Technique[] = [
  'auto',
  'single_scattering',
  'instant_vpl',
  'principal_ordinates',
  'screen_space',
  'reference',
];
/** What this version of the server renders; it refuses the others by name. */
const RENDERED: ReadonlySet<Technique> = new Set([
  'auto',
  'single_scattering',
  'screen_space',
  'reference',
]);

export function addTechnique(folder: GUI, render: RenderDescription, changed: () => void): void {
  const technique = field<Technique>(
    () => render.technique,
    (value) => {
      render.technique = value;
      show();
      changed();
    },
  );
  const options = TECHNIQUES.map((value) => {
    const disabled = !RENDERED.has(value);
    return { value, label: words(value) + (disabled ? ' – not rendered yet' : ''), disabled };
  });
  addSelect(folder, technique, 'Technique', options);
  const filter = folder.addFolder('Screen space');
  addScreenSpace(filter, render.screen_space, changed);
  const show = () => filter.show(render.technique === 'screen_space');
  show();
}

export function addQuality(
  folder: GUI,
  render: RenderDescription,
  resolution: Field<ResolutionScale>,
  changed: () => void,
): void {
  const touch = <T>(get: () => T, set: (value: T) => void) =>
    field(get, (value: T) => {
      set(value);
      changed();
    });
  const correction = touch<CorrectionMode>(
    () => render.correction ?? (render.technique === 'reference' ? 'off' : 'always'),
    (value) => {
      render.correction = value;
    },
  );
  addSelect(folder, correction, 'Correction', [
    { value: 'always', label: 'always' },
    { value: 'at_rest', label: 'at rest' },
    { value: 'off', label: 'off' },
  ]);
  const march = render.single_scattering;
  const steps = touch(
    () => march.steps,
    (value) => {
      march.steps = Math.max(1, Math.round(value));
    },
  );
  addSlider(folder, steps, 'March steps', { min: 1, max: 256, step: 1 });
  const jitter = touch(
    () => march.jitter,
    (value) => {
      march.jitter = value;
    },
  );
  addCheckbox(folder, jitter, 'Jitter');
  const interleave = touch(
    () => march.interleave,
    (value) => {
      march.interleave = value;
    },
  );
  addSelect(folder, interleave, 'Interleaved', [
    { value: 0, label: 'by the device' },
    { value: 1, label: 'no' },
    { value: 2, label: '2 × 2' },
    { value: 4, label: '4 × 4' },
    { value: 8, label: '8 × 8' },
  ]);
  const half = touch(
    () => march.half_resolution,
    (value) => {
      march.half_resolution = value;
    },
  );
  addCheckbox(folder, half, 'Half resolution');
  const equiangular = touch(
    () => march.equiangular,
    (value) => {
      march.equiangular = value;
    },
  );
  addCheckbox(folder, equiangular, 'Equiangular');
  const mode = touch<ShadowMode>(
    () => render.shadows.mode,
    (value) => {
      render.shadows.mode = value;
    },
  );
  addSelect(folder, mode, 'Shadows', [
    { value: 'mapped', label: 'mapped' },
    { value: 'traced', label: 'traced' },
    { value: 'off', label: 'off' },
  ]);
  const texels = touch(
    () => render.shadows.resolution,
    (value) => {
      render.shadows.resolution = value;
    },
  );
  const sizes = [...new Set([256, 512, 1024, 2048, 4096, render.shadows.resolution])];
  const bySize = sizes.sort((a, b) => a - b).map((value) => ({ value, label: `${value}²` }));
  addSelect(folder, texels, 'Shadow map', bySize);
  addSelect(folder, resolution as Field<string | number>, 'Resolution', [
    { value: 'auto', label: 'auto' },
    { value: 1, label: '100 %' },
    { value: 0.75, label: '75 %' },
    { value: 0.5, label: '50 %' },
    { value: 0.33, label: '33 %' },
    { value: 0.25, label: '25 %' },
  ]);
}
