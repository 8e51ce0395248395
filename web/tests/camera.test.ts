import { describe, expect, it } from 'vitest';
import { flightVelocity, fly } from '../src/camera/fly';
import { Glide } from '../src/camera/glide';
import { look, metresPerPixel, orbit, pan, zoom } from '../src/camera/orbit';
import { basis, reach } from '../src/camera/pose';
import { CameraRig, NO_KEYS } from '../src/camera/rig';
import type { Vec3 } from '../src/camera/vec';
import { dot, length, subtract } from '../src/camera/vec';
import { heldKeys } from '../src/input';
import type { CameraPose } from '../src/protocol.gen';

const START: CameraPose = {
  position: [0, 1, 5],
  target: [0, 1, 0],
  up: [0, 1, 0],
  vertical_fov_degrees: 60,
};

function expectClose(a: Vec3, b: Vec3): void {
  for (const [axis, value] of b.entries()) expect(a[axis]).toBeCloseTo(value, 9);
}

describe('orbit', () => {
  it('moves the eye to its own left, at the same distance', () => {
    const quarter = orbit(START, Math.PI / 2, 0);
    expectClose(quarter.position, [-5, 1, 0]);
    expectClose(quarter.target, START.target);
  });

  it('moves the eye upward for a positive pitch and stops below the pole', () => {
    expect(orbit(START, 0, 0.3).position[1]).toBeGreaterThan(1);
    const over = orbit(START, 0, 10);
    expect(over.position[1]).toBeCloseTo(1 + 5 * Math.sin((89 / 180) * Math.PI), 9);
    expect(reach(over)).toBeCloseTo(5, 9);
  });

  it('there and back again is where it was', () => {
    const away = orbit(orbit(START, 0.7, 0.4), 0.2, -0.1);
    expectClose(orbit(orbit(away, -0.2, 0.1), -0.7, -0.4).position, START.position);
  });

  it('works with another up', () => {
    const upZ: CameraPose = { ...START, position: [5, 0, 0], target: [0, 0, 0], up: [0, 0, 2] };
    const turned = orbit(upZ, 0.5, 0.25);
    expect(length(turned.position)).toBeCloseTo(5, 9);
    expect(turned.position[2]).toBeCloseTo(5 * Math.sin(0.25), 9);
  });
});

describe('look, pan, zoom', () => {
  it('look keeps the eye and turns to the left for a positive yaw', () => {
    const turned = look(START, Math.PI / 2, 0);
    expectClose(turned.position, START.position);
    expectClose(turned.target, [-5, 1, 5]);
  });

  it('pan slides both ends in the picture plane', () => {
    const tilted = orbit(START, 0.4, 0.3);
    const moved = pan(tilted, 0.5, -0.25);
    const shift = subtract(moved.position, tilted.position);
    expectClose(subtract(moved.target, tilted.target), shift);
    expect(dot(shift, basis(tilted).forward)).toBeCloseTo(0, 9);
    expect(length(shift)).toBeCloseTo(Math.hypot(0.5, 0.25), 9);
  });

  it('a pan by the height in pixels is the height of the picture at the target', () => {
    const metres = metresPerPixel(START, 400) * 400;
    expect(metres).toBeCloseTo(2 * 5 * Math.tan(Math.PI / 6), 9);
  });

  it('zoom scales the distance and never passes the target', () => {
    expect(reach(zoom(START, 0.5))).toBeCloseTo(2.5, 9);
    expect(reach(zoom(START, 1e-9))).toBeCloseTo(0.02, 9);
    expectClose(zoom(zoom(START, 0.5), 2).position, START.position);
  });
});

describe('flight', () => {
  it('is no faster on a diagonal, and four times as fast with shift', () => {
    const wish = { right: 1, up: 0, forward: 1, fast: false };
    expect(length(flightVelocity(wish, 3))).toBeCloseTo(3, 9);
    expect(length(flightVelocity({ ...wish, fast: true }, 3))).toBeCloseTo(12, 9);
    expect(flightVelocity({ ...wish, right: 0, forward: 0 }, 3)).toEqual([0, 0, 0]);
  });

  it('moves eye and target alike', () => {
    const moved = fly(START, [1, 2, 3]);
    expectClose(moved.position, [1, 3, 2]);
    expectClose(moved.target, [1, 3, -3]);
  });

  it('goes the same way at any frame rate', () => {
    const travel = (rate: number) => {
      const glide = new Glide();
      let way = 0;
      for (let step = 0; step < rate; step += 1) way += glide.advance([0, 0, 2], 1 / rate)[2];
      for (let step = 0; step < rate; step += 1) way += glide.advance([0, 0, 0], 1 / rate)[2];
      return way;
    };
    expect(travel(144)).toBeCloseTo(travel(10), 2);
    expect(travel(60)).toBeCloseTo(2, 2);
  });

  it('comes to rest', () => {
    const glide = new Glide();
    glide.advance([1, 0, 0], 0.5);
    for (let step = 0; step < 120; step += 1) glide.advance([0, 0, 0], 1 / 60);
    expect(glide.moving).toBe(false);
  });
});

describe('rig', () => {
  it('opposite keys cancel', () => {
    expect(heldKeys(new Set(['KeyA', 'KeyD', 'KeyW']), true)).toEqual({
      ...NO_KEYS,
      forward: 1,
      fast: true,
    });
  });

  it('reports a change only while something moves', () => {
    const rig = new CameraRig(START, () => false);
    expect(rig.tick(1 / 60, rig.current)).toBe(false);
    const before = rig.current;
    rig.drag(10, 0, 300);
    expect(rig.tick(1 / 60, before)).toBe(true);
    expect(rig.tick(1 / 60, rig.current)).toBe(false);
  });

  it('goes home softly, at once where motion is unwanted', () => {
    const soft = new CameraRig(START, () => false);
    soft.drag(50, 20, 300);
    soft.goHome();
    soft.tick(0.1, START);
    expect(soft.current).not.toEqual(START);
    for (let step = 0; step < 10; step += 1) soft.tick(0.1, START);
    expect(soft.current).toEqual(START);

    const still = new CameraRig(START, () => true);
    still.drag(50, 20, 300);
    still.goHome();
    expect(still.current).toEqual(START);
  });

  it('a wheel zoom arrives in full', () => {
    const rig = new CameraRig(START, () => false);
    rig.wheel(2, [0, 0, -1]);
    for (let step = 0; step < 120; step += 1) rig.tick(1 / 60, START);
    expect(reach(rig.current)).toBeCloseTo(5 / 1.125 ** 2, 6);
    expect(rig.tick(1 / 60, rig.current)).toBe(false);
  });
});
