/** A lil-gui row with a native range input, linear or logarithmic, beside a number input. */

import { Controller, type GUI } from 'lil-gui';
import { el } from '../dom';
import { compact } from '../format';
import type { Field } from './field';
import { type LogRange, positionFromValue, valueFromPosition } from './log_scale';

const STEPS = 1000;

export interface SliderRange {
  min: number;
  max: number;
  /** Of the linear slider; its arrow keys move by it. */
  step?: number;
  log?: boolean;
  /** Logarithmic only: the left end is 0. */
  zero?: boolean;
  unit?: string;
}

export class SliderController extends Controller {
  private readonly range: HTMLInputElement;
  private readonly number: HTMLInputElement;
  private readonly map: { toValue(p: number): number; toPosition(v: number): number };

  constructor(
    parent: GUI,
    private readonly target: Field<number>,
    label: string,
    private readonly limits: SliderRange,
  ) {
    super(parent, target, 'value', 'slider-row');
    this.map = mapping(limits);
    const spoken = limits.unit === undefined ? label : `${label}, ${limits.unit}`;
    const steps = limits.log === true ? STEPS : (limits.max - limits.min) / (limits.step ?? 0.01);
    this.range = el('input', {
      type: 'range',
      min: '0',
      max: String(Math.round(steps)),
      step: '1',
      'aria-label': label,
      oninput: () => this.fromRange(),
      onchange: () => this._callOnFinishChange(),
    });
    this.number = el('input', {
      type: 'text',
      inputmode: 'decimal',
      'aria-label': `${spoken}, value`,
      onchange: () => this.fromNumber(),
      onkeydown: (event) => this.nudge(event as KeyboardEvent),
      onfocus: () => this.number.select(),
    });
    this.$widget.append(this.range, this.number);
    this.$name.textContent = label;
    if (limits.unit !== undefined) this.$name.append(el('small', {}, limits.unit));
    this.updateDisplay();
  }

  override updateDisplay(): this {
    const value = this.target.value;
    const position = this.map.toPosition(value);
    this.range.value = String(Math.round(position * Number(this.range.max)));
    this.range.style.setProperty('--fill', `${position * 100}%`);
    const text = this.text(value);
    this.range.setAttribute('aria-valuetext', [text, this.limits.unit ?? ''].join(' ').trim());
    if (document.activeElement !== this.number) this.number.value = text;
    return this;
  }

  override disable(disabled = true): this {
    super.disable(disabled);
    this.range.disabled = disabled;
    this.number.disabled = disabled;
    return this;
  }

  private text(value: number): string {
    if (this.limits.log === true) return compact(value);
    const step = this.limits.step ?? 0.01;
    return value.toFixed(Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));
  }

  private fromRange(): void {
    this.setValue(this.map.toValue(Number(this.range.value) / Number(this.range.max)));
  }

  private fromNumber(): void {
    const value = Number.parseFloat(this.number.value.replace(',', '.').replace('−', '-'));
    if (Number.isFinite(value)) {
      // Typed values may exceed the slider: the server says what is allowed.
      this.setValue(value);
      this._callOnFinishChange();
    }
    this.number.value = this.text(this.target.value);
  }

  /** Up and down in the number field move the slider by a hundredth (shift: a tenth). */
  private nudge(event: KeyboardEvent): void {
    if (event.key === 'Enter') this.number.blur();
    const direction = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (direction === undefined) return;
    event.preventDefault();
    const position = this.map.toPosition(this.target.value);
    const next = Math.min(1, Math.max(0, position + direction * (event.shiftKey ? 0.1 : 0.01)));
    this.setValue(this.map.toValue(next));
    this.number.value = this.text(this.target.value);
  }
}

function mapping(limits: SliderRange) {
  if (limits.log === true) {
    const range: LogRange = { min: limits.min, max: limits.max, zero: limits.zero ?? false };
    return {
      toValue: (position: number) => valueFromPosition(position, range),
      toPosition: (value: number) => positionFromValue(value, range),
    };
  }
  const span = limits.max - limits.min;
  const step = limits.step ?? 0.01;
  return {
    toValue: (position: number) =>
      Number((limits.min + Math.round((position * span) / step) * step).toFixed(6)),
    toPosition: (value: number) => Math.min(1, Math.max(0, (value - limits.min) / span)),
  };
}
