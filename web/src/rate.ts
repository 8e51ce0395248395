/** Events and amounts a second over a sliding window. */

export class Rate {
  private events: { time: number; amount: number }[] = [];

  constructor(private readonly windowMillis: number) {}

  add(now: number, amount = 1): void {
    this.events.push({ time: now, amount });
    this.forget(now);
  }

  /** Sum of amounts a second. */
  perSecond(now: number): number {
    this.forget(now);
    const sum = this.events.reduce((total, event) => total + event.amount, 0);
    return (sum * 1000) / this.windowMillis;
  }

  /** Events a second by the spacing of the events: exact also for less than one a window. */
  frequency(now: number): number {
    this.forget(now);
    const first = this.events[0];
    const last = this.events[this.events.length - 1];
    if (first === undefined || last === undefined || last.time <= first.time) return 0;
    return ((this.events.length - 1) * 1000) / (last.time - first.time);
  }

  private forget(now: number): void {
    const oldest = now - this.windowMillis;
    while (this.events.length > 0 && (this.events[0]?.time ?? 0) < oldest) this.events.shift();
  }
}
