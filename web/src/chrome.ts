/** The frame around the picture: badges, drawers, help, shortcuts. */

import type { ConnectionState } from './connection';
import { byId } from './dom';
import { Signal } from './store';

const STATUS: Record<ConnectionState, string> = {
  connecting: 'Connecting',
  connected: 'Connected',
  reconnecting: 'Reconnecting',
  offline: 'Offline',
};

/** Narrower than this the controls are a drawer over the picture. */
const NARROW = window.matchMedia('(max-width: 760px)');
const ROOMY = window.matchMedia('(min-width: 1280px) and (min-height: 700px)');

export interface ChromeEvents {
  onResetCamera(): void;
  onOverlay(open: boolean): void;
}

export class Chrome {
  readonly panelOpen = new Signal(!NARROW.matches && window.innerWidth >= 900);
  readonly overlayOpen = new Signal(ROOMY.matches);
  private readonly status = byId('status');
  private readonly help = byId<HTMLDialogElement>('help');

  constructor(private readonly events: ChromeEvents) {
    const panelButton = byId<HTMLButtonElement>('toggle-panel');
    const overlayButton = byId<HTMLButtonElement>('toggle-overlay');
    panelButton.addEventListener('click', () => this.togglePanel());
    overlayButton.addEventListener('click', () => this.toggleOverlay());
    byId('open-help').addEventListener('click', () => this.help.showModal());
    byId('close-help').addEventListener('click', () => this.help.close());
    this.panelOpen.watch((open) => {
      byId('panel').classList.toggle('open', open);
      document.body.classList.toggle('with-panel', open);
      panelButton.setAttribute('aria-expanded', String(open));
      // Two drawers over a small picture would leave none of it.
      if (open && NARROW.matches) this.overlayOpen.set(false);
    });
    this.overlayOpen.watch((open) => {
      overlayButton.setAttribute('aria-expanded', String(open));
      if (open && NARROW.matches) this.panelOpen.set(false);
      events.onOverlay(open);
    });
    window.addEventListener('keydown', (event) => this.key(event));
  }

  toggleOverlay(): void {
    this.overlayOpen.set(!this.overlayOpen.value);
  }

  togglePanel(): void {
    this.panelOpen.set(!this.panelOpen.value);
  }

  showState(state: ConnectionState): void {
    this.status.textContent = STATUS[state];
    this.status.dataset.state = state;
    document.body.dataset.connection = state;
  }

  showAdapter(adapter: { name: string; driver: string; kind: string }): void {
    const badge = byId('adapter');
    badge.hidden = !isSoftware(adapter.kind);
    badge.textContent = 'Software renderer';
    badge.title = [adapter.name, adapter.driver].filter((part) => part !== '').join(' · ');
  }

  showScene(title: string): void {
    byId('scene-title').textContent = title;
    document.title = title === '' ? 'Tyndall' : `${title} – Tyndall`;
  }

  hideWaiting(): void {
    byId('waiting').hidden = true;
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
    // Letters belong to whatever has the focus: only the picture and the bare page listen.
    const target = event.target as HTMLElement;
    if (target !== document.body && target.id !== 'view') return;
    if (event.key === '?') this.help.showModal();
    else if (event.code === 'KeyP') this.togglePanel();
    else if (event.code === 'KeyO') this.toggleOverlay();
    else if (event.code === 'KeyR') this.events.onResetCamera();
  }
}

export function isSoftware(kind: string): boolean {
  return kind.toLowerCase() === 'software';
}
