/** "Frame all": a view that shows a whole box, or the best place inside a room. Pure. */

import type { Bounds, CameraPose, ViewPoint } from '../protocol.gen';
import { basis } from './pose';
import type { Vec3 } from './vec';
import { add, dot, length, normalize, perpendicular, scale, subtract } from './vec';

/** From below a ground would hide everything, from straight above left and right are lost. */
const LOWEST = (8 / 180) * Math.PI;
const HIGHEST = (60 / 180) * Math.PI;

/**
 * The view of `home` from where the box fits into a picture with this ratio of width to height; from inside
 * surfaces that surround the camera, the view from `overview`.
 */
export function framing(
  home: CameraPose,
  bounds: Bounds,
  overview: ViewPoint | undefined,
  aspect: number,
): CameraPose {
  if (overview !== undefined) return { ...home, ...overview };
  const centre = scale(add(bounds.min, bounds.max), 0.5);
  const radius = 0.5 * length(subtract(bounds.max, bounds.min));
  const half = (home.vertical_fov_degrees / 360) * Math.PI;
  const narrow = Math.min(half, Math.atan(Math.tan(half) * aspect));
  const distance = radius / Math.sin(narrow);
  return {
    ...home,
    position: add(centre, scale(outward(home), distance)),
    target: centre,
  };
}

/** From what is looked at toward the eye, at a height that shows something. Unit length. */
function outward(home: CameraPose): Vec3 {
  const up = normalize(home.up, [0, 1, 0]);
  const back = scale(basis(home).forward, -1);
  const height = dot(back, up);
  const level = normalize(subtract(back, scale(up, height)), perpendicular(up));
  const elevation = Math.asin(Math.min(1, Math.max(-1, height)));
  const kept = Math.min(HIGHEST, Math.max(LOWEST, elevation));
  return add(scale(level, Math.cos(kept)), scale(up, Math.sin(kept)));
}

/** A phone held upright would see a narrow strip: as wide then as it was high, but no wider than this. */
const WIDEST_DEGREES = 100;

/** The pose with a field of view that suits a picture with this ratio of width to height. */
export function fitFieldOfView(pose: CameraPose, aspect: number): CameraPose {
  if (!(aspect > 0) || aspect >= 1) return pose;
  const tan = Math.tan((pose.vertical_fov_degrees / 360) * Math.PI);
  const wider = (Math.atan(tan / aspect) / Math.PI) * 360;
  const degrees = Math.max(pose.vertical_fov_degrees, Math.min(WIDEST_DEGREES, wider));
  return { ...pose, vertical_fov_degrees: degrees };
}
