/** Turning about a point, sliding it, and moving toward it. Pure: a pose in, a pose out. */

import type { CameraPose } from '../protocol.gen';
import { basis, reach } from './pose';
import type { Vec3 } from './vec';
import { add, dot, length, normalize, perpendicular, rotate, scale, subtract } from './vec';

/** The eye never looks straight along `up`, where left and right lose their meaning. Unit: rad. */
const MAX_ELEVATION = (89 / 180) * Math.PI;
/** Unit: m. */
const MIN_REACH = 0.02;
const MAX_REACH = 1e5;

/** Moves the eye about the target: to its own left by `yaw`, upward by `pitch`. Unit: rad. */
export function orbit(pose: CameraPose, yaw: number, pitch: number): CameraPose {
  const offset = turned(subtract(pose.position, pose.target), pose.up, -yaw, pitch);
  return { ...pose, position: add(pose.target, offset) };
}

/** Turns the head: to the left by `yaw`, upward by `pitch`; the eye stays. Unit: rad. */
export function look(pose: CameraPose, yaw: number, pitch: number): CameraPose {
  const offset = turned(subtract(pose.target, pose.position), pose.up, yaw, pitch);
  return { ...pose, target: add(pose.position, offset) };
}

/** Slides eye and target in the picture plane. Unit: m. */
export function pan(pose: CameraPose, right: number, upward: number): CameraPose {
  const axes = basis(pose);
  const shift = add(scale(axes.right, right), scale(axes.upward, upward));
  return { ...pose, position: add(pose.position, shift), target: add(pose.target, shift) };
}

/** Multiplies the distance to the target by `factor`. */
export function zoom(pose: CameraPose, factor: number): CameraPose {
  const now = reach(pose);
  const next = Math.min(MAX_REACH, Math.max(Math.min(MIN_REACH, now), now * factor));
  const backward = scale(basis(pose).forward, -next);
  return { ...pose, position: add(pose.target, backward) };
}

/** World size of one pixel at the target's distance. Unit: m. */
export function metresPerPixel(pose: CameraPose, heightPixels: number): number {
  const halfFov = (pose.vertical_fov_degrees / 360) * Math.PI;
  return (2 * reach(pose) * Math.tan(halfFov)) / Math.max(1, heightPixels);
}

function turned(offset: Vec3, upward: Vec3, yaw: number, pitch: number): Vec3 {
  const up = normalize(upward, [0, 1, 0]);
  const distance = length(offset);
  const height = dot(offset, up);
  const level = subtract(offset, scale(up, height));
  const heading = rotate(normalize(level, perpendicular(up)), up, yaw);
  const elevation = Math.asin(Math.min(1, Math.max(-1, height / Math.max(distance, 1e-12))));
  const next = Math.min(MAX_ELEVATION, Math.max(-MAX_ELEVATION, elevation + pitch));
  return scale(add(scale(heading, Math.cos(next)), scale(up, Math.sin(next))), distance);
}
