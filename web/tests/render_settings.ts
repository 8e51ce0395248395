/** Render settings as the server writes them, for scenes of tests. */

import type { RenderDescription } from '../src/protocol.gen';

export const RENDER: RenderDescription = {
  technique: 'single_scattering',
  width: 640,
  height: 360,
  seed: 0,
  reference: { medium_order: 'all' },
  single_scattering: {
    steps: 32,
    jitter: true,
    interleave: 1,
    half_resolution: false,
    equiangular: false,
  },
  screen_space: {
    filter: 'splat',
    spread: 'exact_moments',
    kernel: 4,
    fetch: 'linear_bicubic',
    luminance_weighting: true,
    masking: true,
    density_blur: true,
    separation: false,
    separation_luminance: 4,
    separation_depth: 0.5,
    in_scatter: true,
    ambient: [0, 0, 0],
  },
  shadows: { mode: 'mapped', resolution: 1024 },
};
