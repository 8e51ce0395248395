import { describe, expect, it } from 'vitest';
import { LatencyTracker, quantile } from '../src/latency';
import { Rate } from '../src/rate';

const times = { renderMillis: 20, encodeMillis: 5, decodeMillis: 3 };

describe('latency', () => {
  it('pairs an input with the first picture that shows it', () => {
    const tracker = new LatencyTracker();
    tracker.sent(1, 100);
    tracker.painted({ appliedInput: 0, painted: 130, ...times });
    expect(tracker.summary()).toBeNull();
    tracker.painted({ appliedInput: 1, painted: 150, ...times });
    tracker.painted({ appliedInput: 1, painted: 900, ...times });
    expect(tracker.summary()).toEqual({
      total: 50,
      render: 20,
      encode: 5,
      decode: 3,
      transit: 22,
      p95: 50,
      samples: 1,
    });
  });

  it('counts every input a picture is the first to show', () => {
    const tracker = new LatencyTracker();
    tracker.sent(1, 0);
    tracker.sent(2, 10);
    tracker.sent(3, 20);
    tracker.painted({ appliedInput: 2, painted: 60, ...times });
    expect(tracker.history()).toEqual([60, 50]);
    tracker.painted({ appliedInput: 3, painted: 70, ...times });
    expect(tracker.history()).toEqual([60, 50, 50]);
  });

  it('forgets inputs without a visible effect, and those of a lost connection', () => {
    const tracker = new LatencyTracker();
    tracker.sent(1, 0);
    tracker.painted({ appliedInput: 1, painted: 20_000, ...times });
    tracker.sent(2, 20_000);
    tracker.reset();
    tracker.painted({ appliedInput: 2, painted: 20_010, ...times });
    expect(tracker.summary()).toBeNull();
  });

  it('quantiles interpolate', () => {
    expect(quantile([3, 1, 2], 0.5)).toBe(2);
    expect(quantile([1, 2], 0.5)).toBe(1.5);
    expect(quantile([7], 0.95)).toBe(7);
  });
});

describe('rates', () => {
  it('frequency is by spacing, also at less than one a second', () => {
    const rate = new Rate(4000);
    for (const now of [0, 1500, 3000]) rate.add(now);
    expect(rate.frequency(3000)).toBeCloseTo(1 / 1.5, 9);
    expect(rate.frequency(9000)).toBe(0);
  });

  it('amounts are summed over the window', () => {
    const rate = new Rate(2000);
    rate.add(0, 1000);
    rate.add(1000, 3000);
    expect(rate.perSecond(1000)).toBe(2000);
    expect(rate.perSecond(2500)).toBe(1500);
  });
});
