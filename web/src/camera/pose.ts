/** Where the eye is and what it looks at. */

import type { CameraDescription, CameraPose } from '../protocol.gen';
import type { Vec3 } from './vec';
import { cross, length, mix, normalize, perpendicular, subtract } from './vec';

export interface Basis {
  right: Vec3;
  /** Perpendicular to `forward`, unlike the pose's `up`. */
  upward: Vec3;
  forward: Vec3;
}

export function basis(pose: CameraPose): Basis {
  const up = normalize(pose.up, [0, 1, 0]);
  const forward = normalize(subtract(pose.target, pose.position), [0, 0, -1]);
  const right = normalize(cross(forward, up), perpendicular(up));
  return { right, upward: cross(right, forward), forward };
}

/** Distance from the eye to what it looks at. Unit: m. */
export function reach(pose: CameraPose): number {
  return length(subtract(pose.target, pose.position));
}

export function samePose(a: CameraPose, b: CameraPose): boolean {
  const same = (x: Vec3, y: Vec3) => x[0] === y[0] && x[1] === y[1] && x[2] === y[2];
  return (
    same(a.position, b.position) &&
    same(a.target, b.target) &&
    same(a.up, b.up) &&
    a.vertical_fov_degrees === b.vertical_fov_degrees
  );
}

/** Part of the way from one pose to another; `t` in [0, 1]. */
export function between(from: CameraPose, to: CameraPose, t: number): CameraPose {
  return {
    position: mix(from.position, to.position, t),
    target: mix(from.target, to.target, t),
    up: to.up,
    vertical_fov_degrees:
      from.vertical_fov_degrees + (to.vertical_fov_degrees - from.vertical_fov_degrees) * t,
  };
}

/** What of a scene's camera is steered. */
export function poseOf({
  position,
  target,
  up,
  vertical_fov_degrees,
}: CameraDescription): CameraPose {
  return { position, target, up, vertical_fov_degrees };
}
