/** A direction as the two angles people think in: where on the compass, how high. Degrees. */

import type { Vec3 } from '../camera/vec';
import { length, scale } from '../camera/vec';

const DEGREES = 180 / Math.PI;

export interface Angles {
  /** From −Z (0) toward +X (90), in (−180, 180]. */
  azimuth: number;
  /** Above the horizon, in [−90, 90]. */
  elevation: number;
}

export function anglesFromDirection(direction: Vec3): Angles {
  const norm = length(direction);
  const [x, y, z] = norm > 0 ? scale(direction, 1 / norm) : [0, -1, 0];
  // A vertical direction has no azimuth; 0 is as good as any.
  const azimuth = Math.hypot(x, z) < 1e-9 ? 0 : Math.atan2(x, -z) * DEGREES;
  return { azimuth, elevation: Math.asin(Math.min(1, Math.max(-1, y))) * DEGREES };
}

export function directionFromAngles({ azimuth, elevation }: Angles): Vec3 {
  const level = Math.cos(elevation / DEGREES);
  return [
    level * Math.sin(azimuth / DEGREES),
    Math.sin(elevation / DEGREES),
    -level * Math.cos(azimuth / DEGREES),
  ];
}
