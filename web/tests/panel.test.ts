import { describe, expect, it } from 'vitest';
import { anglesFromDirection, directionFromAngles } from '../src/panel/angles';
import { combine, hexFromLinear, linearFromHex, tint } from '../src/panel/colour';
import { Draft, normalised } from '../src/panel/draft';
import { type LogRange, positionFromValue, valueFromPosition } from '../src/panel/log_scale';
import type { SceneDescription, SceneEdit } from '../src/protocol.gen';
import { pictureSize } from '../src/size';
import { RENDER } from './render_settings';

const SCENE: SceneDescription = {
  version: 1,
  name: 'test',
  camera: {
    position: [0, 0, 1],
    target: [0, 0, 0],
    up: [0, 1, 0],
    vertical_fov_degrees: 50,
    exposure_ev: 0,
  },
  geometry: [],
  lights: [],
  media: [
    {
      kind: 'sphere',
      sigma_t: 2,
      albedo: [0.25, 0.5, 1],
      g: 0,
      emission: 0,
      density_scale: 1,
      center: [0, 0, 0],
      radius: 1,
    },
  ],
  render: RENDER,
};

describe('logarithmic slider', () => {
  const range: LogRange = { min: 1e-4, max: 100, zero: true };

  it('has an exact zero at its left end and its limits at the others', () => {
    expect(valueFromPosition(0, range)).toBe(0);
    expect(valueFromPosition(0.04, range)).toBe(1e-4);
    expect(valueFromPosition(1, range)).toBe(100);
    expect(valueFromPosition(0, { ...range, zero: false })).toBe(1e-4);
  });

  it('position and value are inverse to three digits', () => {
    for (const value of [1e-4, 0.005, 0.06, 1, 42, 100]) {
      expect(valueFromPosition(positionFromValue(value, range), range)).toBeCloseTo(value, 6);
    }
    expect(positionFromValue(0, range)).toBe(0);
    expect(positionFromValue(1e9, range)).toBe(1);
  });
});

describe('colours', () => {
  it('sRGB there and back', () => {
    expect(hexFromLinear([1, 0.21586, 0])).toBe('#ff8000');
    expect(linearFromHex('#ff8000')[1]).toBeCloseTo(0.2159, 4);
    for (const hex of ['#000000', '#0a0b0c', '#123456', '#ffffff']) {
      expect(hexFromLinear(linearFromHex(hex))).toBe(hex);
    }
  });

  it('amount and tint make the value', () => {
    expect(combine(8, tint([2, 8, 4]))).toEqual([2, 8, 4]);
    expect(tint([0, 0, 0])).toEqual([1, 1, 1]);
  });
});

describe('angles', () => {
  it('azimuth runs from −Z to +X, elevation upward', () => {
    expect(anglesFromDirection([0, 0, -3])).toEqual({ azimuth: 0, elevation: 0 });
    expect(anglesFromDirection([2, 0, 0]).azimuth).toBeCloseTo(90, 9);
    expect(anglesFromDirection([0, -1, 0])).toEqual({ azimuth: 0, elevation: -90 });
  });

  it('direction and angles are inverse', () => {
    const angles = anglesFromDirection(directionFromAngles({ azimuth: -135, elevation: 20 }));
    expect(angles.azimuth).toBeCloseTo(-135, 9);
    expect(angles.elevation).toBeCloseTo(20, 9);
  });
});

describe('draft', () => {
  it('turns extinction and albedo into scattering and absorption', () => {
    const [medium] = normalised(SCENE).media;
    expect(medium?.sigma_s).toEqual([0.5, 1, 2]);
    expect(medium?.sigma_a).toEqual([1.5, 1, 0]);
    expect(medium).not.toHaveProperty('sigma_t');
    expect(medium).not.toHaveProperty('albedo');
  });

  it('sends whole parts and puts back what was refused, in the same objects', () => {
    const sent: SceneEdit[] = [];
    const draft = new Draft(SCENE, (edit) => sent.push(edit));
    const [medium] = draft.description.media;
    const march = draft.description.render.single_scattering;
    if (medium === undefined) throw new Error('the scene has a medium');
    medium.g = 0.5;
    draft.changed('media');
    draft.sent(1);
    medium.g = 7;
    march.steps = 0;
    draft.changed('media');
    draft.sent(2);
    expect(sent.map((edit) => edit.media?.[0]?.g)).toEqual([0.5, 7]);
    expect(draft.refuse(99)).toBe(false);
    expect(draft.refuse(2)).toBe(true);
    expect(medium.g).toBe(0.5);
    expect(march.steps).toBe(32);
    expect(draft.description.render.single_scattering).toBe(march);
    expect(sent).toHaveLength(2);
  });

  it('sends the good values anew when edits followed the refused one', () => {
    const sent: SceneEdit[] = [];
    const draft = new Draft(SCENE, (edit) => sent.push(edit));
    const [medium] = draft.description.media;
    if (medium === undefined) throw new Error('the scene has a medium');
    medium.g = 7;
    draft.changed('media');
    draft.sent(1);
    draft.setExposure(2);
    draft.sent(2);
    draft.refuse(1);
    expect(sent.at(-1)?.media?.[0]?.g).toBe(0);
    expect(sent.at(-1)?.exposure_ev).toBe(0);
  });
});

describe('picture size', () => {
  const device = { width: 2880, height: 1800 };
  const server = { device, scale: 'auto', maxPixels: 1e9, maxSide: 16384 } as const;

  it('is every device pixel up to full HD, and fewer of the same shape beyond', () => {
    const desk = { width: 1440, height: 900 };
    expect(pictureSize({ ...server, device: desk })).toEqual(desk);
    const large = pictureSize(server);
    expect(large.width * large.height).toBeLessThanOrEqual(2_100_000);
    expect(large.width / large.height).toBeCloseTo(1.6, 2);
  });

  it('obeys a chosen scale', () => {
    expect(pictureSize({ ...server, scale: 0.5 })).toEqual({
      width: 1440,
      height: 900,
    });
  });

  it('never exceeds the limits of the server', () => {
    const few = pictureSize({ ...server, scale: 1, maxPixels: 1000 });
    expect(few.width * few.height).toBeLessThanOrEqual(1000);
    expect(pictureSize({ ...server, scale: 1, maxSide: 1440 })).toEqual({
      width: 1440,
      height: 900,
    });
  });
});
