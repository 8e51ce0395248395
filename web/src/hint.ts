/** A word on what steering just met, at the edge of the picture and for a moment. */

import { el } from './dom';

const SHOWN_MILLIS = 4000;

export class Hint {
  private readonly text = el('span', {});
  private readonly button: HTMLButtonElement;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** `onAct` is what its button does. */
  constructor(
    private readonly root: HTMLElement,
    label: string,
    onAct: () => void,
  ) {
    const act = () => {
      this.hide();
      onAct();
    };
    this.button = el('button', { type: 'button', onclick: act }, label);
    root.append(this.text, this.button);
  }

  /** Said again while it is shown, it stays longer. */
  show(text: string): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.hide(), SHOWN_MILLIS);
    if (!this.root.hidden && this.text.textContent === text) return;
    this.text.textContent = text;
    this.root.hidden = false;
  }

  hide(): void {
    clearTimeout(this.timer);
    this.root.hidden = true;
  }
}
