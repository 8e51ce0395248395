/** Short messages that come and go. */

import { el } from './dom';

const SHOWN_MILLIS = 7000;
const MOST = 3;

export class Toasts {
  constructor(private readonly root: HTMLElement) {}

  /** `path` names the part of the scene that is meant, for example `media[0].g`. */
  show(message: string, path?: string): void {
    const toast = el('div', { class: 'toast card' });
    const named = path !== undefined && path !== '';
    if (named) toast.append(el('code', {}, path));
    // The server's sentence starts with the path as well.
    const text =
      named && message.startsWith(`${path}: `) ? message.slice(path.length + 2) : message;
    const close = el('button', { type: 'button', 'aria-label': 'Dismiss' }, '×');
    close.addEventListener('click', () => toast.remove());
    toast.append(el('span', {}, text), close);
    // The same complaint again (a slider held too far) replaces the first.
    for (const shown of [...this.root.children]) {
      if (shown.textContent === toast.textContent) shown.remove();
    }
    while (this.root.children.length >= MOST) this.root.firstElementChild?.remove();
    this.root.append(toast);
    setTimeout(() => toast.remove(), SHOWN_MILLIS);
  }
}
