/** The few controls that a newcomer wants: scene, density, exposure, and the way back. */

import { el } from './dom';
import { compact, signed } from './format';
import { densityFactor, isOwn, type OwnValues, restoreOwn, setDensityFactor } from './own';
import type { Draft } from './panel/draft';
import { type LogRange, positionFromValue, valueFromPosition } from './panel/log_scale';
import { presetOf } from './panel/panel';
import type { Preset, SceneMessage } from './protocol.gen';
import './quick.css';

/** How much thicker or thinner than the scene's own every medium gets. */
const DENSITY: LogRange = { min: 0.05, max: 20, zero: false };
const STEPS = 400;
const LOWEST_EV = -8;
const HIGHEST_EV = 8;

export interface QuickEvents {
  onPreset(name: string): void;
  /** The draft was changed here: the other rows show something else now. */
  onChanged(): void;
}

export class Quick {
  private readonly scene = el('select', { 'aria-label': 'Scene' });
  private readonly density = slider('Density', 0, STEPS, 1);
  private readonly exposure = slider('Exposure', LOWEST_EV, HIGHEST_EV, 0.1);
  private readonly reset = el(
    'button',
    {
      type: 'button',
      class: 'quick-reset',
      title: "Back to the scene's own density and exposure",
      'aria-label': 'Reset density and exposure',
      onclick: () => this.restore(),
    },
    'Reset',
  );
  private draft: Draft | null = null;
  private own: OwnValues | null = null;

  constructor(
    private readonly root: HTMLElement,
    private readonly events: QuickEvents,
  ) {
    this.scene.addEventListener('change', () => {
      if (this.scene.value !== '') events.onPreset(this.scene.value);
    });
    this.density.input.addEventListener('input', () => this.setDensity());
    this.exposure.input.addEventListener('input', () =>
      this.setExposure(Number(this.exposure.input.value)),
    );
    const label = el('label', { class: 'quick-row scene' });
    label.append(el('span', {}, 'Scene'), this.scene);
    root.append(label, this.density.row, this.exposure.row, this.reset);
  }

  /** Another scene is open; `draft` is its working copy, `own` what it had before any edit. */
  show(scene: SceneMessage, presets: readonly Preset[], draft: Draft, own: OwnValues): void {
    this.draft = draft;
    this.own = own;
    const current = presetOf(scene, presets);
    const options = presets.map(({ name, title }) => el('option', { value: name }, title));
    if (current === null) {
      const own = scene.name === '' ? 'Own scene' : scene.name;
      options.unshift(el('option', { value: '' }, own));
    }
    this.scene.replaceChildren(...options);
    this.scene.value = current?.name ?? '';
    this.scene.title = current?.summary ?? '';
    this.density.row.hidden = draft.description.media.length === 0;
    this.refresh();
    this.root.hidden = false;
  }

  /** Shows what the draft holds. */
  refresh(): void {
    if (this.draft === null || this.own === null) return;
    const { description } = this.draft;
    const factor = densityFactor(description, this.own);
    set(this.density, positionFromValue(factor, DENSITY) * STEPS, `${compact(factor)} ×`, '');
    const ev = description.camera.exposure_ev;
    set(this.exposure, ev, signed(ev), ' EV');
    // It keeps its room, so that nothing moves under the pointer.
    this.reset.classList.toggle('idle', isOwn(description, this.own));
  }

  /** Exposure at present and as the scene has it; null before the first scene. Unit: EV. */
  exposures(): { now: number; own: number } | null {
    if (this.draft === null || this.own === null) return null;
    return { now: this.draft.description.camera.exposure_ev, own: this.own.exposure };
  }

  setExposure(ev: number): void {
    this.draft?.setExposure(ev);
    this.changed();
  }

  private setDensity(): void {
    if (this.draft === null || this.own === null) return;
    const factor = valueFromPosition(Number(this.density.input.value) / STEPS, DENSITY);
    setDensityFactor(this.draft.description, this.own, factor);
    this.draft.changed('media');
    this.changed();
  }

  private restore(): void {
    if (this.draft === null || this.own === null) return;
    restoreOwn(this.draft.description, this.own);
    this.draft.changed('media');
    this.draft.setExposure(this.own.exposure);
    this.changed();
  }

  private changed(): void {
    this.refresh();
    this.events.onChanged();
  }
}

interface Slider {
  row: HTMLElement;
  input: HTMLInputElement;
  value: HTMLElement;
}

function slider(name: string, min: number, max: number, step: number): Slider {
  const input = el('input', {
    type: 'range',
    min: String(min),
    max: String(max),
    step: String(step),
    'aria-label': name,
  });
  const value = el('output', {});
  const row = el('label', { class: 'quick-row' });
  row.append(el('span', {}, name, value), input);
  return { row, input, value };
}

/** The unit is spoken; a phone has no room to show it. */
function set({ input, value }: Slider, position: number, text: string, unit: string): void {
  input.value = String(position);
  input.setAttribute('aria-valuetext', text + unit);
  const { min, max } = input;
  const share = (Number(input.value) - Number(min)) / (Number(max) - Number(min));
  input.style.setProperty('--fill', `${share * 100}%`);
  value.textContent = text;
}
