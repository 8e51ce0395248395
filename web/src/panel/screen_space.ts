/** Settings of the technique that filters the picture. */

import type { GUI } from 'lil-gui';
import { words } from '../format';
import type {
  LevelFetch,
  ScreenSpaceFilter,
  ScreenSpace as Settings,
  SpreadModel,
} from '../protocol.gen';
import { toVec3 } from './colour';
import { field } from './field';
import { addCheckbox, addSelect, addSlider, addSpectrum } from './rows';

/** Radiance. */
const AMBIENT = { min: 1e-4, max: 100, unit: 'W/(m² sr)' };
const FILTERS: readonly ScreenSpaceFilter[] = ['splat', 'hierarchical', 'gather'];
const SPREADS: readonly SpreadModel[] = ['exact_moments', 'premoze'];
const FETCHES: readonly LevelFetch[] = ['linear_bilinear', 'linear_bicubic', 'cubic_bicubic'];

export function addScreenSpace(folder: GUI, settings: Settings, changed: () => void): void {
  const touch = <K extends keyof Settings>(key: K) =>
    field<Settings[K]>(
      () => settings[key],
      (value) => {
        settings[key] = value;
        changed();
      },
    );
  const named = <T extends string>(values: readonly T[]) =>
    values.map((value) => ({ value, label: words(value) }));
  addSelect(folder, touch('filter'), 'Filter', named(FILTERS));
  addSelect(folder, touch('spread'), 'Spread', named(SPREADS));
  const kernels = [2, 4, 6].map((value) => ({ value, label: `${value} × ${value}` }));
  addSelect(folder, touch('kernel'), 'Kernel', kernels);
  addCheckbox(folder, touch('in_scatter'), 'In-scatter of lights');
  const ambient = field(
    () => toVec3(settings.ambient),
    (value) => {
      settings.ambient = value;
      changed();
    },
  );
  addSpectrum(folder, ambient, 'Ambient', 'Ambient colour', AMBIENT);
  const remedies = folder.addFolder('Hierarchical filter').close();
  addSelect(remedies, touch('fetch'), 'Fetch', named(FETCHES));
  addCheckbox(remedies, touch('luminance_weighting'), 'Weight by luminance');
  addCheckbox(remedies, touch('masking'), 'Mask');
  addCheckbox(remedies, touch('density_blur'), 'Blur spreads');
  addCheckbox(remedies, touch('separation'), 'Separate bright pixels');
  addSlider(remedies, touch('separation_luminance'), 'Bright from', {
    min: 0,
    max: 100,
    step: 0.1,
  });
  addSlider(remedies, touch('separation_depth'), 'Depth up to', { min: 0, max: 10, step: 0.05 });
}
