/** The scene's own values of what the tools below the picture change, and how far they are from them. Pure. */

import type { Editable } from './panel/draft';

/** As the scene was opened, before any edit. */
export interface OwnValues {
  /** Unit: EV. */
  exposure: number;
  /** `density_scale` of every medium. */
  densities: readonly number[];
}

type Values = Pick<Editable, 'camera' | 'media'>;

export function ownValues({ camera, media }: Values): OwnValues {
  return {
    exposure: camera.exposure_ev,
    densities: media.map(({ density_scale }) => density_scale),
  };
}

/** What the densities are multiplied by, in the geometric mean of the media that have any. */
export function densityFactor({ media }: Pick<Values, 'media'>, own: OwnValues): number {
  const ratios = media
    .map(({ density_scale }, index) => density_scale / (own.densities[index] ?? 0))
    .filter((ratio) => ratio > 0 && Number.isFinite(ratio));
  if (ratios.length === 0) return 1;
  const mean = ratios.reduce((sum, ratio) => sum + Math.log(ratio), 0) / ratios.length;
  // Six digits are what a density is written with.
  return Number(Math.exp(mean).toPrecision(5));
}

/** Multiplies the densities, so that their factor becomes this one; what tells the media apart stays. */
export function setDensityFactor(
  values: Pick<Values, 'media'>,
  own: OwnValues,
  factor: number,
): void {
  const change = factor / densityFactor(values, own);
  for (const medium of values.media) {
    medium.density_scale = Number((medium.density_scale * change).toPrecision(6));
  }
}

export function isOwn({ camera, media }: Values, own: OwnValues): boolean {
  const same = (a: number, b: number) => Math.abs(a - b) <= 1e-5 * Math.abs(b);
  return (
    same(camera.exposure_ev, own.exposure) &&
    media.every(({ density_scale }, index) => same(density_scale, own.densities[index] ?? 0))
  );
}

/** Brings exposure and densities back to the scene's own. */
export function restoreOwn({ camera, media }: Values, own: OwnValues): void {
  camera.exposure_ev = own.exposure;
  for (const [index, medium] of media.entries()) {
    medium.density_scale = own.densities[index] ?? medium.density_scale;
  }
}
