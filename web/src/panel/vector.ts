/** A lil-gui row of three numbers; dragging a letter sideways moves its number. */

import { Controller, type GUI } from 'lil-gui';
import type { Vec3 } from '../camera/vec';
import { el } from '../dom';
import { compact } from '../format';
import type { Field } from './field';

const PIXELS_PER_STEP = 2;

export class VectorController extends Controller {
  private readonly inputs: HTMLInputElement[] = [];

  constructor(
    parent: GUI,
    private readonly target: Field<Vec3>,
    label: string,
    unit: string,
    /** What two pixels of a drag, or an arrow key, change. */
    private readonly stride: number,
  ) {
    super(parent, target, 'value', 'vector-row');
    this.$name.textContent = label;
    this.$name.append(el('small', {}, unit));
    for (const [axis, letter] of ['x', 'y', 'z'].entries()) this.addAxis(axis, letter, label, unit);
    this.updateDisplay();
  }

  override updateDisplay(): this {
    for (const [axis, input] of this.inputs.entries()) {
      if (document.activeElement !== input) input.value = compact(this.target.value[axis] ?? 0);
    }
    return this;
  }

  private addAxis(axis: number, letter: string, label: string, unit: string): void {
    const input = el('input', {
      type: 'text',
      inputmode: 'decimal',
      'aria-label': `${label} ${letter}, ${unit}`,
      onchange: () => this.type(axis),
      onfocus: () => input.select(),
      onkeydown: (event) => this.nudge(event as KeyboardEvent, axis),
    });
    const handle = el('span', { class: 'axis', 'aria-hidden': 'true' }, letter);
    this.scrub(handle, axis);
    this.inputs.push(input);
    this.$widget.append(el('div', { class: 'cell' }, handle, input));
  }

  private change(axis: number, value: number): void {
    const next: Vec3 = [...this.target.value];
    next[axis] = value;
    this.setValue(next);
  }

  private type(axis: number): void {
    const input = this.inputs[axis];
    const value = Number.parseFloat((input?.value ?? '').replace(',', '.').replace('−', '-'));
    if (Number.isFinite(value)) this.change(axis, value);
    if (input !== undefined) input.value = compact(this.target.value[axis] ?? 0);
  }

  private nudge(event: KeyboardEvent, axis: number): void {
    if (event.key === 'Enter') this.inputs[axis]?.blur();
    const direction = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (direction === undefined) return;
    event.preventDefault();
    const step = direction * this.stride * (event.shiftKey ? 10 : 1);
    this.change(axis, (this.target.value[axis] ?? 0) + step);
    const input = this.inputs[axis];
    if (input !== undefined) input.value = compact(this.target.value[axis] ?? 0);
  }

  private scrub(handle: HTMLElement, axis: number): void {
    let start: { x: number; value: number } | null = null;
    handle.addEventListener('pointerdown', (event) => {
      handle.setPointerCapture(event.pointerId);
      start = { x: event.clientX, value: this.target.value[axis] ?? 0 };
      event.preventDefault();
    });
    handle.addEventListener('pointermove', (event) => {
      if (start === null) return;
      const steps = Math.round((event.clientX - start.x) / PIXELS_PER_STEP);
      this.change(axis, start.value + steps * this.stride * (event.shiftKey ? 10 : 1));
    });
    for (const end of ['pointerup', 'pointercancel']) {
      handle.addEventListener(end, () => {
        start = null;
      });
    }
  }
}
