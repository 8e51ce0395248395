import { describe, expect, it } from 'vitest';
import { signed } from '../src/format';
import { densityFactor, isOwn, ownValues, restoreOwn, setDensityFactor } from '../src/own';
import type { MediumDescription, SceneDescription } from '../src/protocol.gen';
import { unsaved, withKept } from '../src/resume';
import { judge, sharesOf } from '../src/visible';
import { RENDER } from './render_settings';

/** Pixels of one value each, opaque. */
const pixels = (values: readonly (readonly [number, number, number])[]) =>
  values.flatMap((rgb) => [...rgb, 255]);

const of = (share: number, rgb: [number, number, number], rest: [number, number, number]) =>
  pixels(Array.from({ length: 100 }, (_, index) => (index < share ? rgb : rest)));

describe('what a picture shows', () => {
  it('is nearly nothing where 95 of 100 pixels are near black, whatever the rest is', () => {
    const lit = (dark: number) =>
      judge(sharesOf(of(dark, [9, 4, 0], [255, 240, 200])), 'something');
    expect(lit(95)).toBe('dark');
    expect(lit(94)).toBe('something');
    expect(lit(0)).toBe('something');
  });

  it('is nothing where it is all white, or all of a colour that is as bright as it can be', () => {
    const rest: [number, number, number] = [120, 110, 100];
    const seen = (rgb: [number, number, number]) => judge(sharesOf(of(97, rgb, rest)), 'something');
    expect(seen([255, 255, 252])).toBe('bright');
    expect(seen([255, 0, 0])).toBe('bright');
    expect(seen([255, 180, 0])).toBe('something');
    expect(seen([240, 240, 240])).toBe('something');
  });

  it('does not flicker at the border', () => {
    const shares = { dark: 0.93, bright: 0 };
    expect(judge(shares, 'something')).toBe('something');
    expect(judge(shares, 'dark')).toBe('dark');
    expect(judge({ dark: 0.91, bright: 0 }, 'dark')).toBe('something');
    expect(judge({ dark: 0, bright: 0.93 }, 'dark')).toBe('something');
  });

  it('is unknown without pixels, which is no reason to speak', () => {
    expect(judge(sharesOf([]), 'something')).toBe('something');
  });
});

const medium = (density_scale: number): MediumDescription => ({
  kind: 'sphere',
  sigma_t: 2,
  albedo: 0.5,
  g: 0,
  emission: 0,
  density_scale,
  center: [0, 0, 0],
  radius: 1,
});

const scene = (exposure_ev: number, densities: number[]): SceneDescription => ({
  version: 1,
  name: 'test',
  camera: {
    position: [0, 0, 1],
    target: [0, 0, 0],
    up: [0, 1, 0],
    vertical_fov_degrees: 50,
    exposure_ev,
  },
  geometry: [],
  lights: [],
  media: densities.map(medium),
  render: RENDER,
});

describe("the scene's own values", () => {
  it('tell how far the densities were moved, and bring them back', () => {
    const own = ownValues(scene(1.5, [0.2, 0, 3]));
    const now = scene(1.5, [0.2, 0, 3]);
    expect(isOwn(now, own)).toBe(true);
    setDensityFactor(now, own, 4);
    setDensityFactor(now, own, 20);
    expect(now.media.map(({ density_scale }) => density_scale)).toEqual([4, 0, 60]);
    expect(densityFactor(now, own)).toBe(20);
    now.camera.exposure_ev = -8;
    expect(isOwn(now, own)).toBe(false);
    restoreOwn(now, own);
    expect(isOwn(now, own)).toBe(true);
    expect(now.camera.exposure_ev).toBe(1.5);
  });

  it('leave a scene without density alone', () => {
    const own = ownValues(scene(0, [0]));
    const now = scene(0, [0]);
    setDensityFactor(now, own, 20);
    expect(now.media[0]?.density_scale).toBe(0);
    expect(densityFactor(now, own)).toBe(1);
  });
});

describe('a reloaded page', () => {
  const edit = {
    exposure_ev: 2,
    lights: [],
    media: scene(0, [5]).media,
    render: scene(0, []).render,
  };

  it('shows every quick edit, and sends all of them where the server lacks one', () => {
    // The exposure arrived, the density did not.
    const description = scene(2, [1]);
    const message = { epoch: 3, name: 'test', description, facts: {} as never, warnings: [] };
    const shown = withKept(message, { edit }).description;
    expect(shown.camera.exposure_ev).toBe(2);
    expect(shown.media[0]?.density_scale).toBe(5);
    expect(unsaved(description, { edit })).toEqual(edit);
  });

  it('sends nothing where the server has it all, whatever the order of its names', () => {
    const reversed = <T extends object>(value: T) =>
      Object.fromEntries(Object.entries(value).reverse()) as T;
    const description = scene(2, [5]);
    description.media = description.media.map(reversed);
    expect(unsaved(reversed(description), { edit })).toBeNull();
  });
});

describe('an exposure', () => {
  it('is written with its sign', () => {
    expect([8, -2.46, 0, -0.04].map(signed)).toEqual(['+8.0', '−2.5', '0.0', '0.0']);
  });
});
