/** Notices a picture in which nearly nothing is to be seen, and says in one sentence why. */

import { el } from './dom';
import { signed } from './format';
import type { ClientMessage, DarknessCause, DarknessMessage } from './protocol.gen';
import { judge, sharesOf, type Visible } from './visible';

/** Rest of the camera before the page speaks up, and between two looks at a picture. Unit: ms. */
const REST_MILLIS = 400;
const LOOK_MILLIS = 250;
/** What the picture is shrunk to for a look. */
const COLUMNS = 128;
const ROWS = 80;
/** By how much a button lowers the exposure of a scene that is too bright by itself. Unit: EV. */
const STEP_DOWN = 3;

export const SENTENCES: Record<DarknessCause, string> = {
  no_light: 'nothing in this scene gives light.',
  inside_solid: 'the camera is inside a solid thing.',
  at_surface: 'a surface right in front of the camera hides the rest.',
  looks_away: 'the camera looks away from everything.',
  unlit: 'no light, or too little, reaches what the camera sees.',
};

/** Exposure at present and as the scene has it. Unit: EV. */
export interface Exposure {
  now: number;
  own: number;
}

export interface WatchEvents {
  ask(message: ClientMessage): void;
  onHome(): void;
  onFrameAll(): void;
  /** Null before the first scene. */
  exposure(): Exposure | null;
  onExposure(ev: number): void;
  onVisible(visible: Visible, cause: DarknessCause | null): void;
}

export class PictureWatch {
  private readonly sentence = el('p', {});
  private readonly exposureButton: HTMLButtonElement;
  private readonly wayButtons: HTMLButtonElement[];
  private readonly small = document.createElement('canvas');
  private request = 0;
  private visible: Visible = 'something';
  private cause: DarknessCause | null = null;
  /** There is a picture that nobody has looked at. */
  private unseen = false;
  private lookDue = 0;
  private changedAt = 0;

  constructor(
    private readonly root: HTMLElement,
    private readonly view: HTMLCanvasElement,
    private readonly events: WatchEvents,
  ) {
    const button = (text: string, act: () => void) =>
      el('button', { type: 'button', onclick: act }, text);
    this.wayButtons = [
      button('Frame all', () => events.onFrameAll()),
      button('Home', () => events.onHome()),
    ];
    this.exposureButton = button('', () => events.onExposure(this.betterExposure()));
    const buttons = el('div', { class: 'buttons' }, this.exposureButton, ...this.wayButtons);
    root.append(this.sentence, buttons);
    this.small.width = COLUMNS;
    this.small.height = ROWS;
  }

  /** The camera or the scene changes: what is black in passing needs no words. */
  changed(now: number): void {
    this.changedAt = now;
  }

  /** Another scene is open. */
  reset(): void {
    this.unseen = false;
    this.clear();
  }

  /** A picture is on the canvas. */
  painted(): void {
    this.unseen = true;
  }

  /** Looks at the newest picture: at rest, and while something is said of the one before. */
  tick(now: number): void {
    const rests = now - this.changedAt >= REST_MILLIS;
    if (!this.unseen || now < this.lookDue || (!rests && this.root.hidden)) return;
    this.lookDue = now + LOOK_MILLIS;
    this.unseen = false;
    const before = this.visible;
    this.visible = judge(sharesOf(this.pixels()), before);
    if (this.visible === 'something') {
      this.clear();
    } else if (this.visible === 'bright') {
      this.request += 1;
      this.cause = null;
      this.showBright();
    } else if (rests) {
      // The reason may be another one after a step that leads from dark to dark.
      this.request += 1;
      this.events.ask({ type: 'explain_darkness', request: this.request });
    }
  }

  /** The server knows why. */
  answered({ request, cause }: DarknessMessage): void {
    if (request !== this.request || this.visible !== 'dark') return;
    this.cause = cause;
    const exposure = this.events.exposure();
    const lowered = cause === 'unlit' && exposure !== null && exposure.now < exposure.own;
    const why = lowered ? `exposure is ${signed(exposure.now)} EV.` : SENTENCES[cause];
    this.say(`Nearly everything here is black: ${why}`, lowered, !lowered);
  }

  private showBright(): void {
    const exposure = this.events.exposure();
    const is = exposure === null ? '' : `: exposure is ${signed(exposure.now)} EV`;
    this.say(`Everything is brighter than the page can show${is}.`, exposure !== null, false);
  }

  private say(sentence: string, offersExposure: boolean, offersWays: boolean): void {
    this.sentence.textContent = sentence;
    this.exposureButton.textContent = `Set exposure to ${signed(this.betterExposure())} EV`;
    this.exposureButton.hidden = !offersExposure;
    for (const button of this.wayButtons) button.hidden = !offersWays;
    this.root.hidden = false;
    this.events.onVisible(this.visible, this.cause);
  }

  /** The scene's own exposure, or a lower one where that is too bright. Unit: EV. */
  private betterExposure(): number {
    const { now, own } = this.events.exposure() ?? { now: 0, own: 0 };
    return this.visible === 'bright' && now <= own ? now - STEP_DOWN : own;
  }

  private clear(): void {
    // An answer that is on its way is about another picture.
    this.request += 1;
    this.visible = 'something';
    this.cause = null;
    if (this.root.hidden) return;
    this.root.hidden = true;
    this.events.onVisible('something', null);
  }

  /** The picture as the page shows it, shrunk; nothing where the browser gives no pixels. */
  private pixels(): ArrayLike<number> {
    const context = this.small.getContext('2d', { willReadFrequently: true });
    if (context === null) return [];
    context.drawImage(this.view, 0, 0, COLUMNS, ROWS);
    return context.getImageData(0, 0, COLUMNS, ROWS).data;
  }
}
