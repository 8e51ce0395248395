/** How many pixels to ask the server for. */

import type { Size } from './outbox';

/** 'auto' asks for every device pixel up to full HD. While the picture moves the server renders fewer. */
export type ResolutionScale = 'auto' | number;

/** Beyond full HD, coding a JPEG takes longer than rendering it. Unit: pixel. */
const AUTO_PIXELS = 2_100_000;

export interface SizeRequest {
  /** Device pixels the canvas covers. */
  device: Size;
  scale: ResolutionScale;
  /** The server's limits. Unit: pixel. */
  maxPixels: number;
  maxSide: number;
}

/** Keeps the aspect ratio; at least 16 pixels a side, so that a collapsed window is harmless. */
export function pictureSize({ device, scale, maxPixels, maxSide }: SizeRequest): Size {
  const wanted = scale === 'auto' ? 1 : scale;
  const cap = scale === 'auto' ? AUTO_PIXELS : maxPixels;
  const pixels = device.width * device.height * wanted * wanted;
  const area = Math.sqrt(Math.min(cap, maxPixels) / pixels);
  const side = maxSide / (wanted * Math.max(device.width, device.height));
  const shrink = wanted * Math.min(1, area, side);
  return {
    width: Math.max(16, Math.floor(device.width * shrink)),
    height: Math.max(16, Math.floor(device.height * shrink)),
  };
}

/** Device pixels that an observed element covers. */
export function devicePixels(entry: ResizeObserverEntry): Size {
  const exact = entry.devicePixelContentBoxSize?.[0];
  if (exact !== undefined) return { width: exact.inlineSize, height: exact.blockSize };
  const { width, height } = entry.contentRect;
  const ratio = window.devicePixelRatio;
  return { width: Math.round(width * ratio), height: Math.round(height * ratio) };
}
