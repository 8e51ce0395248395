/** Notices a black picture, asks the server why, and says it in one sentence. */

import { el } from './dom';
import type { ClientMessage, DarknessCause, DarknessMessage } from './protocol.gen';

/** Mean luminance above which a picture shows something for sure. Range: 0 to 1. */
const SURELY_SHOWN = 0.03;
/** The brightest pixel of a black picture at most. Range: 0 to 255. */
const BLACK = 5;
/** Rest of the camera before the page speaks up, and between two looks. Unit: ms. */
const REST_MILLIS = 500;
const LOOK_MILLIS = 700;
/** What the picture is shrunk to, to find its brightest pixel: small lights must survive. */
const COLUMNS = 128;
const ROWS = 80;

export const SENTENCES: Record<DarknessCause, string> = {
  no_light: 'The picture is black: nothing in this scene gives light.',
  inside_solid: 'The picture is black: the camera is inside a solid thing.',
  at_surface: 'The picture is black: a surface right in front of the camera hides everything.',
  looks_away: 'There is nothing here: the camera looks away from everything.',
  unlit: 'The picture is black: no light reaches what the camera sees. A higher exposure may help.',
};

export interface DarknessEvents {
  ask(message: ClientMessage): void;
  onHome(): void;
  onFrameAll(): void;
  onCause(cause: DarknessCause | null): void;
}

export class DarknessWatch {
  private readonly sentence = el('p', {});
  private readonly small = document.createElement('canvas');
  private request = 0;
  /** The picture is dark, and nobody has looked how dark. */
  private unseen = false;
  private lookDue = 0;
  private movedAt = 0;

  constructor(
    private readonly root: HTMLElement,
    private readonly view: HTMLCanvasElement,
    private readonly events: DarknessEvents,
  ) {
    const button = (text: string, act: () => void) =>
      el('button', { type: 'button', onclick: act }, text);
    const buttons = el('div', { class: 'buttons' });
    buttons.append(
      button('Frame all', () => events.onFrameAll()),
      button('Home', () => events.onHome()),
    );
    root.append(this.sentence, buttons);
    this.small.width = COLUMNS;
    this.small.height = ROWS;
  }

  /** The camera was moved: what is black in passing needs no words. */
  moved(now: number): void {
    this.movedAt = now;
  }

  /** Another scene is open. */
  reset(): void {
    this.unseen = false;
    this.clear();
  }

  /** A picture is on the canvas, with this mean luminance. */
  painted(meanLuminance: number): void {
    this.unseen = meanLuminance <= SURELY_SHOWN;
    if (!this.unseen) this.clear();
  }

  /** Looks at a dark picture once the camera rests. */
  tick(now: number): void {
    if (!this.unseen || now - this.movedAt < REST_MILLIS || now < this.lookDue) return;
    this.lookDue = now + LOOK_MILLIS;
    this.unseen = false;
    if (this.brightest() > BLACK) {
      this.clear();
      return;
    }
    this.request += 1;
    this.events.ask({ type: 'explain_darkness', request: this.request });
  }

  /** The server knows why. */
  answered({ request, cause }: DarknessMessage): void {
    if (request !== this.request) return;
    this.sentence.textContent = SENTENCES[cause];
    this.root.hidden = false;
    this.events.onCause(cause);
  }

  private clear(): void {
    // An answer that is on its way is about another picture.
    this.request += 1;
    if (this.root.hidden) return;
    this.root.hidden = true;
    this.events.onCause(null);
  }

  /** The brightest channel of the picture. Range: 0 to 255. */
  private brightest(): number {
    const context = this.small.getContext('2d', { willReadFrequently: true });
    if (context === null) return 255;
    context.drawImage(this.view, 0, 0, COLUMNS, ROWS);
    const { data } = context.getImageData(0, 0, COLUMNS, ROWS);
    let most = 0;
    for (let at = 0; at < data.length; at += 4) {
      most = Math.max(most, data[at] ?? 0, data[at + 1] ?? 0, data[at + 2] ?? 0);
    }
    return most;
  }
}
