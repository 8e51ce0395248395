/** Motion to photon: from an input sent to the first picture painted that shows it. */

export interface FrameTimes {
  appliedInput: number;
  /** Same clock as `sent`. Unit: ms. */
  painted: number;
  renderMillis: number;
  encodeMillis: number;
  decodeMillis: number;
}

export interface LatencySummary {
  /** Medians. Unit: ms. */
  total: number;
  render: number;
  encode: number;
  decode: number;
  /** What remains: the network, and waiting for the picture before. */
  transit: number;
  /** 95th percentile of the total. Unit: ms. */
  p95: number;
  samples: number;
}

/** Inputs that no picture answered within this time were not visible (or were lost). */
const FORGET_MILLIS = 10_000;
const WINDOW = 120;

interface Sample {
  total: number;
  render: number;
  encode: number;
  decode: number;
  transit: number;
}

export class LatencyTracker {
  private pending: { input: number; sent: number }[] = [];
  private window: Sample[] = [];

  sent(input: number, now: number): void {
    this.pending.push({ input, sent: now });
    if (this.pending.length > 1024) this.pending.shift();
  }

  /** A refused input will never be shown. */
  forget(input: number): void {
    this.pending = this.pending.filter((entry) => entry.input !== input);
  }

  /** Pairs the picture with every input it is the first to show. */
  painted(frame: FrameTimes): void {
    const waiting: typeof this.pending = [];
    for (const entry of this.pending) {
      if (entry.input > frame.appliedInput) {
        if (frame.painted - entry.sent < FORGET_MILLIS) waiting.push(entry);
        continue;
      }
      const total = frame.painted - entry.sent;
      if (total >= FORGET_MILLIS) continue;
      const { renderMillis: render, encodeMillis: encode, decodeMillis: decode } = frame;
      const transit = Math.max(0, total - render - encode - decode);
      this.window.push({ total, render, encode, decode, transit });
    }
    this.pending = waiting;
    if (this.window.length > WINDOW) this.window.splice(0, this.window.length - WINDOW);
  }

  /** A new connection answers none of the inputs of the old one. */
  reset(): void {
    this.pending = [];
  }

  /** The last latencies, oldest first. Unit: ms. */
  history(): number[] {
    return this.window.map((sample) => sample.total);
  }

  summary(): LatencySummary | null {
    if (this.window.length === 0) return null;
    const part = (pick: (sample: Sample) => number, at: number) =>
      quantile(this.window.map(pick), at);
    return {
      total: part((sample) => sample.total, 0.5),
      render: part((sample) => sample.render, 0.5),
      encode: part((sample) => sample.encode, 0.5),
      decode: part((sample) => sample.decode, 0.5),
      transit: part((sample) => sample.transit, 0.5),
      p95: part((sample) => sample.total, 0.95),
      samples: this.window.length,
    };
  }
}

/** Linear interpolation between order statistics; `values` is not empty. */
export function quantile(values: readonly number[], at: number): number {
  const sorted = [...values].sort((a, b) => a - b);
  const position = at * (sorted.length - 1);
  const below = sorted[Math.floor(position)] ?? 0;
  const above = sorted[Math.ceil(position)] ?? below;
  return below + (above - below) * (position - Math.floor(position));
}
