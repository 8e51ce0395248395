/** The slim line of figures: how fast, how exact, on what. */

import { el } from './dom';
import { significant } from './format';
import type { FrameHeader } from './header';
import type { Adapter } from './protocol.gen';

export class Figures {
  private readonly rate = el('span', { class: 'figure' });
  private readonly error = el('span', { class: 'figure', title: 'Estimated relative error' });
  private readonly device = el('span', { class: 'device' });

  constructor(root: HTMLElement) {
    root.append(this.rate, this.error, this.device);
  }

  showDevice({ name, driver, kind }: Adapter): void {
    const software = kind === 'software';
    // The kind alone is shown for a software driver: its name means nothing to most people.
    this.device.textContent = software ? 'CPU' : shortName(name);
    this.device.classList.toggle('software', software);
    const parts = [software ? 'Software renderer, no GPU' : '', name, driver];
    this.device.title = parts.filter((part) => part !== '').join(' · ');
  }

  show(header: FrameHeader | null, framesPerSecond: number): void {
    if (header === null) return;
    this.rate.textContent = rateText(framesPerSecond, header);
    this.error.textContent = errorText(header.estimatedError);
  }
}

/** A picture just begun is not known at all: how far beyond that means nothing. */
function errorText(error: number | null): string {
  if (error === null) return '';
  return error >= 1 ? '> 99 % error' : `${significant(error * 100, 2)} % error`;
}

export function rateText(framesPerSecond: number, header: FrameHeader): string {
  // A converged picture needs no frames: that is not a slow server.
  if (framesPerSecond === 0) return header.converged ? 'finished' : '0 fps';
  return `${framesPerSecond.toFixed(framesPerSecond < 10 ? 1 : 0)} fps`;
}

/** `NVIDIA H100 80GB HBM3 (…)` → `NVIDIA H100 80GB HBM3`. */
function shortName(name: string): string {
  return name.replace(/\s*\(.*\)\s*/g, ' ').trim();
}
