/** Rows that several folders share. */

import type { Controller, GUI } from 'lil-gui';
import type { Vec3 } from '../camera/vec';
import { el } from '../dom';
import { type Angles, anglesFromDirection, directionFromAngles } from './angles';
import { amount, combine, hexFromLinear, isGrey, linearFromHex, tint } from './colour';
import { type Field, field } from './field';
import { SliderController, type SliderRange } from './slider';

export function addSlider(
  folder: GUI,
  target: Field<number>,
  label: string,
  range: SliderRange,
): SliderController {
  return new SliderController(folder, target, label, range);
}

export function addCheckbox(folder: GUI, target: Field<boolean>, label: string): Controller {
  return folder.add(target, 'value').name(label);
}

export function addButton(folder: GUI, label: string, action: () => void): Controller {
  return folder.add({ value: action }, 'value').name(label);
}

export function addSelect<T extends string | number>(
  folder: GUI,
  target: Field<T>,
  label: string,
  options: readonly { value: T; label: string; disabled?: boolean }[],
): Controller {
  const entries = Object.fromEntries(options.map((option) => [option.label, option.value]));
  const row = folder.add(target, 'value', entries).name(label);
  const select = row.domElement.querySelector('select');
  for (const [index, option] of options.entries()) {
    const item = select?.options[index];
    if (item !== undefined) item.disabled = option.disabled ?? false;
  }
  return row;
}

/** A row that only shows; `set` updates it. */
export function addReadout(folder: GUI, label: string): { set(text: string): void } {
  const output = el('span', { class: 'readout' });
  const name = el('div', { class: 'lil-name' }, label);
  const widget = el('div', { class: 'lil-widget' }, output);
  folder.$children.append(el('div', { class: 'lil-controller readout-row' }, name, widget));
  return {
    set: (text) => {
      output.textContent = text;
    },
  };
}

/** How much (logarithmic) and, where `coloured`, which tint. */
export function addSpectrum(
  folder: GUI,
  target: Field<Vec3>,
  label: string,
  colourLabel: string,
  range: SliderRange,
): { colour: Controller; slider: SliderController } {
  // Kept apart from the value: a slider at zero must not forget the tint.
  let hue = tint(target.value);
  const howMuch = field(
    () => amount(target.value),
    (value) => {
      if (amount(target.value) > 0) hue = tint(target.value);
      target.value = combine(value, hue);
    },
  );
  const slider = addSlider(folder, howMuch, label, { log: true, zero: true, ...range });
  const shade = field(
    () => hexFromLinear(amount(target.value) > 0 ? tint(target.value) : hue),
    (hex) => {
      hue = tint(linearFromHex(hex));
      target.value = combine(amount(target.value), hue);
    },
  );
  const colour = folder.addColor(shade, 'value').name(colourLabel);
  // lil-gui keeps the swatch out of the tab order for the sake of its text field; both work.
  colour.domElement.querySelector('input[type=color]')?.setAttribute('tabindex', '0');
  return { colour, slider };
}

/** A checkbox that shows the colours of `spectra`; unticking makes them grey. */
export function addColourToggle(
  folder: GUI,
  spectra: readonly { target: Field<Vec3>; colour: Controller }[],
): void {
  let coloured = spectra.some(({ target }) => !isGrey(target.value));
  const show = () => {
    for (const { colour } of spectra) colour.show(coloured);
  };
  const toggle = field(
    () => coloured,
    (on) => {
      coloured = on;
      if (!on) {
        for (const { target, colour } of spectra) {
          colour.setValue('#ffffff');
          target.value = combine(amount(target.value), [1, 1, 1]);
        }
      }
      show();
    },
  );
  addCheckbox(folder, toggle, 'Per channel');
  show();
}

/** Azimuth and elevation of a direction, or of where it comes from. */
export function addDirection(folder: GUI, target: Field<Vec3>, comesFrom: boolean): void {
  const sign = comesFrom ? -1 : 1;
  const facing = (): Vec3 => [
    sign * target.value[0],
    sign * target.value[1],
    sign * target.value[2],
  ];
  // Kept, so that looking straight down does not forget the azimuth.
  let angles = anglesFromDirection(facing());
  let known = target.value;
  const read = (): Angles => {
    if (target.value !== known) {
      angles = anglesFromDirection(facing());
      known = target.value;
    }
    return angles;
  };
  const write = (change: Partial<Angles>) => {
    angles = { ...read(), ...change };
    const [x, y, z] = directionFromAngles(angles);
    known = [sign * x, sign * y, sign * z];
    target.value = known;
  };
  const azimuth = field(
    () => read().azimuth,
    (value) => write({ azimuth: value }),
  );
  const elevation = field(
    () => read().elevation,
    (value) => write({ elevation: value }),
  );
  // Of the sun as the sky's coordinates of where it stands, of a lamp as where it points.
  const around = comesFrom ? 'Azimuth' : 'Heading';
  const above = comesFrom ? 'Elevation' : 'Pitch';
  const unit = '°';
  addSlider(folder, azimuth, around, { min: -180, max: 180, step: 1, unit });
  addSlider(folder, elevation, above, { min: -90, max: 90, step: 1, unit });
}
