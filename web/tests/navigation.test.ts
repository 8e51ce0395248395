import { describe, expect, it } from 'vitest';
import { aimAt, placeInPicture } from '../src/camera/aim';
import { Follower } from '../src/camera/follower';
import { fitFieldOfView, framing } from '../src/camera/frame';
import { basis, reach } from '../src/camera/pose';
import { CameraRig, NO_KEYS } from '../src/camera/rig';
import type { Vec3 } from '../src/camera/vec';
import { add, dot, length, normalize, subtract } from '../src/camera/vec';
import { approach, levelDirection } from '../src/camera/walk';
import type { CameraPose, ClientMessage, Navigation, NavigationMessage } from '../src/protocol.gen';
import { Steering } from '../src/steering';
import { Taps } from '../src/taps';

const START: CameraPose = {
  position: [0, 1.6, 5],
  target: [0, 1.6, 0],
  up: [0, 1, 0],
  vertical_fov_degrees: 60,
};

function expectClose(a: Vec3, b: Vec3, digits = 9): void {
  for (const [axis, value] of b.entries()) expect(a[axis]).toBeCloseTo(value, digits);
}

function rigIn(mode: Navigation): CameraRig {
  const rig = new CameraRig(START, () => true);
  rig.mode = mode;
  rig.setExtent(20);
  return rig;
}

describe('modes', () => {
  it('look: a drag turns the head and the picture follows the hand', () => {
    const rig = rigIn('look');
    rig.drag(240, 0, 720);
    expectClose(rig.current.position, START.position);
    // What was in the middle moved to the right, as the pointer did.
    expect(dot(basis(rig.current).right, subtract([0, 1.6, 0], START.position))).toBeGreaterThan(0);
    const turned = Math.acos(dot(basis(rig.current).forward, basis(START).forward));
    expect(turned).toBeCloseTo((240 / 720) * 1.5 * (Math.PI / 3), 9);
  });

  it('look: the wheel walks level toward the pointer, and no surface lets it through', () => {
    const rig = rigIn('look');
    rig.wheel(3, [0.6, -0.5, -0.6]);
    const way = subtract(rig.current.position, START.position);
    expect(way[1]).toBeCloseTo(0, 9);
    expectClose(normalize(way, [0, 0, 0]), [Math.SQRT1_2, 0, -Math.SQRT1_2]);
    expect(rig.takeThrough()).toBe(false);
  });

  it('orbit: a drag moves the eye about the pivot, the wheel goes nearer', () => {
    const rig = rigIn('orbit');
    rig.drag(100, 20, 720);
    expect(reach(rig.current)).toBeCloseTo(5, 9);
    expectClose(rig.current.target, START.target);
    rig.wheel(1, [0, 0, -1]);
    expect(reach(rig.current)).toBeCloseTo(5 / 1.125, 9);
    expect(rig.takeThrough()).toBe(false);
  });

  it('fly: the wheel flies along the view through surfaces', () => {
    const rig = rigIn('fly');
    rig.drag(0, 100, 720);
    const { forward } = basis(rig.current);
    rig.wheel(2, [1, 0, 0]);
    const way = subtract(rig.current.position, START.position);
    expectClose(normalize(way, [0, 0, 0]), forward);
    expect(rig.takeThrough()).toBe(true);
    expect(rig.takeThrough()).toBe(false);
  });

  it('keys that fly pass through surfaces in every mode, keys that turn in none but fly', () => {
    for (const mode of ['look', 'orbit', 'fly'] as const) {
      const rig = rigIn(mode);
      rig.keys = { ...NO_KEYS, turnLeft: 1 };
      rig.tick(0.1, START);
      expect(rig.takeThrough()).toBe(mode === 'fly');
      rig.keys = { ...NO_KEYS, forward: 1 };
      rig.tick(0.1, START);
      expect(rig.takeThrough()).toBe(true);
    }
  });

  it('a sidestep moves a far view no faster than a near one', () => {
    const far = rigIn('look');
    far.adopt({ ...START, target: [0, 1.6, -995] });
    far.dragPan(-100, 0, 720);
    expect(far.current.position[0]).toBeLessThan(2);
    expect(far.current.position[0]).toBeGreaterThan(0.1);
  });

  it('a new pivot distance changes no picture', () => {
    const rig = rigIn('orbit');
    rig.setPivotDistance(2);
    expectClose(rig.current.position, START.position);
    expectClose(basis(rig.current).forward, basis(START).forward);
    expect(reach(rig.current)).toBeCloseTo(2, 9);
  });
});

describe('going to a point', () => {
  it('orbit turns about it, look walks up to it at eye height', () => {
    const rig = rigIn('orbit');
    rig.goTo([1, 1, 0], [0, 0, 1]);
    expectClose(rig.current.target, [1, 1, 0]);
    expectClose(rig.current.position, START.position);
    const wall = approach(START, [0, 3, -3], [0, 0, 1]);
    expectClose(wall.position, [0, 1.6, -1]);
    expectClose(wall.target, [0, 3, -3]);
    const floor = approach(START, [2, 0, 1], [0, 1, 0]);
    expectClose(floor.position, [2, 1.6, 1]);
    expectClose(basis(floor).forward, basis(START).forward);
  });

  it('a steep aim leads along the view', () => {
    expectClose(levelDirection(START, [0, -1, 0.05]), [0, 0, -1]);
    const down: CameraPose = { ...START, target: [0, -3, 4.99] };
    expect(levelDirection(down, [0, -1, 0])[2]).toBeLessThan(-0.99);
  });
});

describe('frame all', () => {
  const bounds = { min: [-1, 0, -2] as Vec3, max: [3, 2, 2] as Vec3 };

  it('shows the whole box, upright and on its side, and never from below', () => {
    for (const [aspect, target] of [
      [1.8, [0, 1.6, 0]],
      [0.46, [0, 4, 0]],
      [1, [0, -6, 4]],
    ] as const) {
      const pose = framing({ ...START, target: [...target] }, bounds, undefined, aspect);
      expect(pose.position[1]).toBeGreaterThan(1);
      const { right, upward, forward } = basis(pose);
      const tan = Math.tan(Math.PI / 6);
      for (let corner = 0; corner < 8; corner += 1) {
        const at = [0, 1, 2].map((axis) =>
          (corner >> axis) & 1 ? (bounds.max[axis] ?? 0) : (bounds.min[axis] ?? 0),
        ) as Vec3;
        const way = subtract(at, pose.position);
        const depth = dot(way, forward);
        expect(Math.abs(dot(way, upward))).toBeLessThanOrEqual(depth * tan + 1e-9);
        expect(Math.abs(dot(way, right))).toBeLessThanOrEqual(depth * tan * aspect + 1e-9);
      }
    }
  });

  it('an upright picture is as wide as it would be high, within reason', () => {
    expect(fitFieldOfView(START, 1.5)).toBe(START);
    const tan = (degrees: number) => Math.tan((degrees / 360) * Math.PI);
    const upright = fitFieldOfView(START, 0.8).vertical_fov_degrees;
    expect(tan(upright) * 0.8).toBeCloseTo(tan(60), 9);
    expect(fitFieldOfView(START, 0.3).vertical_fov_degrees).toBe(100);
    const wide = { ...START, vertical_fov_degrees: 120 };
    expect(fitFieldOfView(wide, 0.3).vertical_fov_degrees).toBe(120);
  });

  it('stays inside surfaces that surround the camera', () => {
    const overview = { position: [0, 1.6, 6] as Vec3, target: [0, 1, 0] as Vec3 };
    expect(framing(START, bounds, overview, 1.5)).toEqual({ ...START, ...overview });
  });
});

describe('places', () => {
  it('are shares of a picture that covers its box', () => {
    const box = { left: 10, top: 20, width: 400, height: 200 };
    expect(placeInPicture({ x: 210, y: 120 }, box, { width: 100, height: 50 })).toEqual([0.5, 0.5]);
    // A square picture is cut above and below.
    const [u, v] = placeInPicture({ x: 10, y: 20 }, box, { width: 64, height: 64 });
    expect(u).toBeCloseTo(0, 9);
    expect(v).toBeCloseTo(0.25, 9);
  });

  it('point into the world as the picture does', () => {
    expectClose(aimAt(START, 2, [0.5, 0.5]), [0, 0, -1]);
    const corner = aimAt(START, 2, [1, 0]);
    const tan = Math.tan(Math.PI / 6);
    expectClose(corner, normalize([2 * tan, tan, -1], [0, 0, 0]));
  });
});

describe('follower', () => {
  const at = (x: number): CameraPose => ({ ...START, position: [x, 0, 0], target: [x, 0, -1] });

  it('takes exactly what the server shows when nothing happened since', () => {
    const follower = new Follower();
    follower.left(1, at(5));
    const server = at(3);
    expect(follower.stopped(1, server, at(5))).toBe(server);
  });

  it('keeps what happened since, and corrects it once', () => {
    const follower = new Follower();
    follower.left(1, at(5));
    follower.left(2, at(6));
    // The wall is at 3; the user has gone on to 7 meanwhile.
    let now = follower.stopped(1, at(3), at(7));
    expect(now.position[0]).toBeCloseTo(5, 9);
    now = follower.stopped(2, at(3), now);
    expect(now.position[0]).toBeCloseTo(4, 9);
  });

  it('ends at the wall however long one pushes, and moves away at once', () => {
    const follower = new Follower();
    const wall = 3;
    let now = at(0);
    let shown = at(0);
    const answers: { input: number; camera: CameraPose }[] = [];
    let sent = now;
    let input = 0;
    const send = () => {
      input += 1;
      follower.left(input, now);
      sent = now;
      const x = Math.min(wall, now.position[0]);
      shown = at(x);
      if (x !== now.position[0]) answers.push({ input, camera: shown });
    };
    for (let step = 0; step < 60; step += 1) {
      if (step < 30) now = { ...now, ...shifted(now, 0.3) };
      if (now !== sent) send();
      // Answers come two steps late.
      if (answers.length > 2) {
        const { input: number, camera } = answers.shift() ?? { input: 0, camera: now };
        const next = follower.stopped(number, camera, now);
        if (next === camera) sent = next;
        now = next;
      }
    }
    for (const { input: number, camera } of answers) now = follower.stopped(number, camera, now);
    expect(now.position[0]).toBeCloseTo(wall, 9);
    expect(shown.position[0]).toBeCloseTo(wall, 9);
  });

  it('knows an eye that pushes against a wall from one that slides along it', () => {
    const push = (steps: Vec3[], stopped: (to: Vec3) => Vec3) => {
      const follower = new Follower();
      let now = at(2.9);
      return steps.map((step, index) => {
        now = { ...now, position: add(now.position, step), target: add(now.target, step) };
        follower.left(index, now);
        const position = stopped(now.position);
        now = follower.stopped(index, { ...now, position }, now);
        return follower.isHeldUp;
      });
    };
    const wall = ([x, y, z]: Vec3): Vec3 => [Math.min(3, x), y, z];
    expect(
      push(
        [
          [0.3, 0, 0],
          [0.3, 0, 0],
          [0.3, 0, 0.1],
        ],
        wall,
      ),
    ).toEqual([false, true, true]);
    expect(
      push(
        [
          [0.3, 0, 0.3],
          [0.1, 0, 0.3],
          [0.1, 0, 0.3],
        ],
        wall,
      ),
    ).toEqual([false, false, false]);
  });

  const shifted = (pose: CameraPose, x: number) => ({
    position: add(pose.position, [x, 0, 0]),
    target: add(pose.target, [x, 0, 0]),
  });

  it('ignores answers to another scene', () => {
    const follower = new Follower();
    follower.left(1, at(5));
    follower.reset();
    expect(follower.stopped(1, at(3), at(5)).position[0]).toBe(5);
  });
});

describe('steering', () => {
  const facts = (mode: Navigation, pivot: Vec3): NavigationMessage => ({
    epoch: 1,
    mode,
    bounds: { min: [-3, 0, -3], max: [3, 3, 3] },
    pivot,
  });

  function steering() {
    const rig = new CameraRig(START, () => true);
    const sent: ClientMessage[] = [];
    const modes: Navigation[] = [];
    const events = {
      send: (message: ClientMessage) => sent.push(message) > 0,
      onMode: (mode: Navigation) => void modes.push(mode),
      onHeldUp: () => {},
    };
    return { rig, sent, modes, steering: new Steering(rig, events) };
  }

  it('takes the mode of the scene, once a scene, and the choice of the user before it', () => {
    const one = steering();
    one.steering.opened(null);
    one.steering.advised(facts('look', [0, 1.6, 0]));
    expect(one.rig.mode).toBe('look');
    one.steering.nextMode();
    one.steering.advised(facts('look', [0, 1.6, 0]));
    expect(one.rig.mode).toBe('orbit');
    one.steering.opened('fly');
    one.steering.advised(facts('look', [0, 1.6, 0]));
    expect(one.modes).toEqual(['look', 'orbit', 'fly']);
  });

  it('orbits about the pivot that the server names, and comes home to it', () => {
    const { rig, steering: steers } = steering();
    steers.opened(null);
    steers.advised(facts('orbit', [0, 1.6, 3]));
    expectClose(rig.current.target, [0, 1.6, 3]);
    rig.drag(200, 0, 700);
    steers.goHome();
    expectClose(rig.current.target, [0, 1.6, 3]);
    expectClose(rig.current.position, START.position);
  });

  it('orbits what is in the middle of the picture when the user switches to it', () => {
    const { rig, sent, steering: steers } = steering();
    steers.opened(null);
    steers.advised(facts('look', [0, 1.6, 0]));
    steers.nextMode();
    expect(sent).toEqual([{ type: 'pick', request: 1, place: [0.5, 0.5] }]);
    const point: Vec3 = [0, 1.6, -2];
    steers.picked({ request: 1, hit: { kind: 'surface', point, normal: [0, 0, 1] } });
    expectClose(rig.current.target, point);
  });

  it('forgets answers to old questions and about another place', () => {
    const { rig, steering: steers } = steering();
    steers.opened(null);
    steers.advised(facts('orbit', START.target));
    steers.goTo([0.2, 0.2]);
    steers.goTo([0.5, 0.5]);
    const hit = { kind: 'surface', point: [0, 0, 0] as Vec3 } as const;
    steers.picked({ request: 1, hit });
    expect(rig.current).toEqual(START);
    rig.adopt({ ...START, position: [0, 1.6, 9] });
    steers.picked({ request: 2, hit });
    expect(rig.current.position).toEqual([0, 1.6, 9]);
    expect(rig.current.target).toEqual(START.target);
  });

  it('frames everything', () => {
    const { rig, steering: steers } = steering();
    steers.opened(null);
    steers.advised(facts('orbit', START.target));
    steers.frameAll(1.5);
    expectClose(rig.current.target, [0, 1.5, 0]);
    expect(length(subtract(rig.current.position, [0, 1.5, 0]))).toBeGreaterThan(4.5);
    expect(rig.takeThrough()).toBe(true);
  });
});

describe('taps', () => {
  it('two quick ones in one place are a double tap', () => {
    const taps = new Taps();
    taps.down(10, 10, 0);
    expect(taps.up(11, 10, 80)).toBe(false);
    taps.down(14, 12, 200);
    expect(taps.up(14, 12, 260)).toBe(true);
    taps.down(14, 12, 300);
    expect(taps.up(14, 12, 360)).toBe(false);
  });

  it('drags, long presses, far and late taps are none', () => {
    const second = (x: number, pressed: number, released: number, to = x): boolean => {
      const taps = new Taps();
      taps.down(10, 10, 0);
      taps.up(10, 10, 50);
      taps.down(x, 10, pressed);
      return taps.up(to, 10, released);
    };
    expect(second(10, 200, 250)).toBe(true);
    expect(second(10, 200, 250, 60)).toBe(false);
    expect(second(10, 200, 900)).toBe(false);
    expect(second(80, 200, 250)).toBe(false);
    expect(second(10, 600, 650)).toBe(false);
  });
});
