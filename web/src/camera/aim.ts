/** From a place in the window to a place in the picture and a direction in the world. Pure. */

import type { CameraPose } from '../protocol.gen';
import { basis } from './pose';
import type { Vec3 } from './vec';
import { add, normalize, scale } from './vec';

/** Shares of width and height from the left upper corner. */
export type Place = [number, number];

export interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** The place of the picture under a point of the window, where the picture covers `box` (`object-fit`). */
export function placeInPicture(
  point: { x: number; y: number },
  box: Box,
  picture: { width: number; height: number },
): Place {
  const grown = Math.max(box.width / picture.width, box.height / picture.height);
  const share = (at: number, middle: number, side: number) =>
    Math.min(1, Math.max(0, (at - middle) / (side * grown) + 0.5));
  return [
    share(point.x, box.left + box.width / 2, picture.width),
    share(point.y, box.top + box.height / 2, picture.height),
  ];
}

/** Unit direction seen at a place of a picture with this ratio of width to height. */
export function aimAt(pose: CameraPose, aspect: number, [u, v]: Place): Vec3 {
  const { right, upward, forward } = basis(pose);
  const tan = Math.tan((pose.vertical_fov_degrees / 360) * Math.PI);
  const across = scale(right, tan * aspect * (2 * u - 1));
  return normalize(add(add(forward, across), scale(upward, tan * (1 - 2 * v))), forward);
}
