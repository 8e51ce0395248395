/** Numbers as people read them. */

/** Three significant digits, never in exponent form for everyday sizes. */
export function significant(value: number, digits = 3): string {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const magnitude = Math.abs(value);
  if (magnitude < 1e-4 || magnitude >= 1e6) return value.toExponential(digits - 1);
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(magnitude)));
  return value.toFixed(Math.min(decimals, 8));
}

/** At most three significant digits, without trailing zeros: what fits beside a slider. */
export function compact(value: number): string {
  const rounded = Number(value.toPrecision(3));
  return Math.abs(rounded) < 1e-5 && rounded !== 0 ? rounded.toExponential() : String(rounded);
}

/** `fog bank` → `Fog bank`. */
export function titled(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

export function millis(value: number): string {
  if (value < 9.95) return `${value.toFixed(1)} ms`;
  if (value < 1000) return `${value.toFixed(0)} ms`;
  return `${(value / 1000).toFixed(2)} s`;
}

export function bytes(value: number): string {
  if (value < 1000) return `${value.toFixed(0)} B`;
  if (value < 1e6) return `${(value / 1e3).toFixed(value < 1e4 ? 1 : 0)} kB`;
  return `${(value / 1e6).toFixed(value < 1e7 ? 1 : 0)} MB`;
}

export function count(value: number): string {
  return value.toLocaleString('en-GB').replaceAll(',', '\u202f');
}

/** `instant_vpl` → `instant vpl`. */
export function words(identifier: string): string {
  return identifier.replaceAll('_', ' ');
}

/** One decimal with its sign, as exposures are written: `+8.0`, `−2.5`, `0.0`. */
export function signed(value: number): string {
  const text = value.toFixed(1).replace('-', '−');
  return Number(value.toFixed(1)) > 0 ? `+${text}` : text.replace('−0.0', '0.0');
}
