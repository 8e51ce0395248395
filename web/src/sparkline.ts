/** A line of recent values: shape only, the numbers stand beside it. */

const NAMESPACE = 'http://www.w3.org/2000/svg';
const WIDTH = 120;
const HEIGHT = 24;

export class Sparkline {
  readonly element: SVGSVGElement;
  private readonly line: SVGPolylineElement;

  constructor(private readonly capacity: number) {
    this.element = document.createElementNS(NAMESPACE, 'svg');
    this.element.setAttribute('viewBox', `0 0 ${WIDTH} ${HEIGHT}`);
    this.element.setAttribute('preserveAspectRatio', 'none');
    this.element.setAttribute('class', 'sparkline');
    this.element.setAttribute('aria-hidden', 'true');
    this.line = document.createElementNS(NAMESPACE, 'polyline');
    this.line.setAttribute('vector-effect', 'non-scaling-stroke');
    this.element.append(this.line);
  }

  /** From zero to the largest value; the newest at the right edge. */
  show(values: readonly number[]): void {
    const recent = values.slice(-this.capacity);
    const top = Math.max(1e-9, ...recent);
    const points = recent.map((value, index) => {
      const x = WIDTH - ((recent.length - 1 - index) * WIDTH) / (this.capacity - 1);
      const y = HEIGHT - 1 - (value / top) * (HEIGHT - 2);
      return `${x.toFixed(1)},${y.toFixed(1)}`;
    });
    this.line.setAttribute('points', points.join(' '));
  }
}
