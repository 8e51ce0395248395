/** A slider position in [0, 1] over decades, with an exact zero at its left end. */

export interface LogRange {
  /** The smallest positive value the slider gives; > 0. */
  min: number;
  max: number;
  /** The left end means 0 instead of `min`. */
  zero: boolean;
}

/** The share of the track that is the zero. */
const ZERO_PART = 0.04;

export function valueFromPosition(position: number, range: LogRange): number {
  const start = range.zero ? ZERO_PART : 0;
  if (range.zero && position < start / 2) return 0;
  const t = Math.min(1, Math.max(0, (position - start) / (1 - start)));
  const value = range.min * (range.max / range.min) ** t;
  // Three digits are what the thumb can say.
  return Number(value.toPrecision(3));
}

export function positionFromValue(value: number, range: LogRange): number {
  const start = range.zero ? ZERO_PART : 0;
  if (!(value > 0)) return 0;
  const t = Math.log(value / range.min) / Math.log(range.max / range.min);
  return start + (1 - start) * Math.min(1, Math.max(0, t));
}
