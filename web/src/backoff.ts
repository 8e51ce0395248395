/** How long to wait before the next attempt to connect. */

const FIRST_MILLIS = 250;
const LONGEST_MILLIS = 8000;

/**
 * Doubles from 250 ms to 8 s, less up to half of it at random, so that the clients of a restarted
 * server do not come back all at once. `attempt` counts failures, from 0.
 */
export function backoffMillis(attempt: number, random: () => number = Math.random): number {
  const full = Math.min(LONGEST_MILLIS, FIRST_MILLIS * 2 ** Math.min(attempt, 16));
  return full * (0.5 + 0.5 * random());
}
