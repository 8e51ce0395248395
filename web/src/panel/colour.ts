/** A coefficient per channel as people edit it: how much (largest channel) and which tint. */

import type { Vec3 } from '../camera/vec';
import type { Rgb } from '../protocol.gen';

export function toVec3(value: Rgb | null | undefined, fallback = 0): Vec3 {
  if (value === null || value === undefined) return [fallback, fallback, fallback];
  return typeof value === 'number' ? [value, value, value] : value;
}

export function amount(value: Vec3): number {
  return Math.max(...value);
}

/** Channels relative to the largest; white for zero. */
export function tint(value: Vec3): Vec3 {
  const largest = amount(value);
  if (largest <= 0) return [1, 1, 1];
  return [value[0] / largest, value[1] / largest, value[2] / largest];
}

export function combine(howMuch: number, which: Vec3): Vec3 {
  return [howMuch * which[0], howMuch * which[1], howMuch * which[2]];
}

export function isGrey(value: Vec3): boolean {
  return value[0] === value[1] && value[1] === value[2];
}

/** Linear to the sRGB hex notation of a colour input (IEC 61966-2-1). */
export function hexFromLinear(value: Vec3): string {
  return `#${value
    .map((channel) => {
      const x = Math.min(1, Math.max(0, channel));
      const encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
      return Math.round(encoded * 255)
        .toString(16)
        .padStart(2, '0');
    })
    .join('')}`;
}

export function linearFromHex(hex: string): Vec3 {
  const value = Number.parseInt(hex.slice(1), 16);
  const channel = (shift: number) => {
    const x = ((value >> shift) & 255) / 255;
    return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
  };
  return [channel(16), channel(8), channel(0)];
}
