/** Flight: eye and target move together along the axes of the view. */

import type { CameraPose } from '../protocol.gen';
import { basis } from './pose';
import type { Vec3 } from './vec';
import { add, normalize, scale } from './vec';

/** Held keys as −1, 0 or +1 an axis. */
export interface FlightWish {
  right: number;
  up: number;
  forward: number;
  fast: boolean;
}

const FAST = 4;

/** Wished velocity along (right, up, forward), no faster on a diagonal. Unit: m/s. */
export function flightVelocity(wish: FlightWish, speed: number): Vec3 {
  const direction = normalize([wish.right, wish.up, wish.forward], [0, 0, 0]);
  return scale(direction, speed * (wish.fast ? FAST : 1));
}

/** Moves by `way` along (right, up, forward); "up" is the scene's, not the picture's. */
export function fly(pose: CameraPose, way: Vec3): CameraPose {
  const axes = basis(pose);
  const up = normalize(pose.up, [0, 1, 0]);
  const shift = add(add(scale(axes.right, way[0]), scale(up, way[1])), scale(axes.forward, way[2]));
  return { ...pose, position: add(pose.position, shift), target: add(pose.target, shift) };
}
