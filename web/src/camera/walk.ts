/** Walking: eye and target move level, at eye height, toward a direction or a point. Pure. */

import type { CameraPose } from '../protocol.gen';
import { basis } from './pose';
import type { Vec3 } from './vec';
import { add, dot, length, normalize, perpendicular, scale, subtract } from './vec';

/** A direction steeper than this leads nowhere on the level. Share of its length. */
const LEAST_LEVEL = 0.2;
/** A surface whose normal is steeper than this is a floor: one walks onto it. Cosine. */
const FLOOR = 0.7;
/** Share of the way to a wall that is left. */
const STAND_OFF = 0.25;

/** Unit direction on the level of `aim`, or of the view where `aim` is steep. */
export function levelDirection(pose: CameraPose, aim: Vec3): Vec3 {
  const up = normalize(pose.up, [0, 1, 0]);
  const level = (way: Vec3): Vec3 => subtract(way, scale(up, dot(way, up)));
  const toward = level(normalize(aim, [0, 0, 0]));
  if (length(toward) > LEAST_LEVEL) return normalize(toward, [0, 0, -1]);
  const { forward, upward } = basis(pose);
  const ahead = level(forward);
  // Looking straight up or down, what is above in the picture is ahead.
  return normalize(length(ahead) > LEAST_LEVEL ? ahead : level(upward), perpendicular(up));
}

/** Moves eye and target along a direction. Unit: m. */
export function shift(pose: CameraPose, direction: Vec3, metres: number): CameraPose {
  const way = scale(direction, metres);
  return { ...pose, position: add(pose.position, way), target: add(pose.target, way) };
}

/** Where one ends who walks up to a point: on a floor right there, before a wall at a distance. */
export function approach(pose: CameraPose, point: Vec3, normal: Vec3 | null): CameraPose {
  const up = normalize(pose.up, [0, 1, 0]);
  const way = subtract(point, pose.position);
  const level = subtract(way, scale(up, dot(way, up)));
  if (normal !== null && dot(normal, up) > FLOOR) {
    const moved = add(pose.position, level);
    return { ...pose, position: moved, target: add(pose.target, level) };
  }
  const moved = add(pose.position, scale(level, 1 - STAND_OFF));
  return { ...pose, position: moved, target: point };
}
