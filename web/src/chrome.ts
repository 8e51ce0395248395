/** The frame around the picture: status, drawers, help, shortcuts. */

import type { ConnectionState } from './connection';
import { byId, el } from './dom';
import { keepLayout, readLayout } from './layout';
import type { Navigation } from './protocol.gen';
import { Signal } from './store';

const STATUS: Record<ConnectionState, string> = {
  connecting: 'Connecting',
  connected: 'Connected',
  reconnecting: 'Reconnecting',
  refused: 'Refused',
  offline: 'Offline',
};

/** Where a second drawer would leave nothing of the picture. */
const NARROW = window.matchMedia('(max-width: 900px), (max-height: 500px)');

const MODES: Record<Navigation, { label: string; icon: string; next: string }> = {
  look: {
    label: 'Look around',
    icon: 'M2.5 12s3.5-6 9.5-6 9.5 6 9.5 6-3.5 6-9.5 6-9.5-6-9.5-6zM12 9.5a2.5 2.5 0 1 0 .01 0',
    next: 'orbit',
  },
  orbit: {
    label: 'Orbit',
    icon: 'M12 9.5a2.5 2.5 0 1 0 .01 0M20.5 8.5c1.8 3.1-.6 7-5.2 8.6M3.5 15.5c-1.8-3.1.6-7 5.2-8.6M15 14l.3 3.1 3 .6',
    next: 'fly',
  },
  fly: { label: 'Fly', icon: 'M3 11.5 21 4l-6.5 17-3-7.5zM11.5 13.5 21 4', next: 'look around' },
};

export interface ChromeEvents {
  onHome(): void;
  onFrameAll(): void;
  onNextMode(): void;
  onOverlay(open: boolean): void;
}

export class Chrome {
  readonly panelOpen: Signal<boolean>;
  readonly overlayOpen: Signal<boolean>;
  private readonly status = byId('status');
  private readonly help = byId<HTMLDialogElement>('help');

  constructor(private readonly events: ChromeEvents) {
    const layout = readLayout();
    this.panelOpen = new Signal(layout.panel);
    this.overlayOpen = new Signal(layout.overlay && !(layout.panel && NARROW.matches));
    const panelButton = byId<HTMLButtonElement>('toggle-panel');
    const overlayButton = byId<HTMLButtonElement>('toggle-overlay');
    panelButton.addEventListener('click', () => this.togglePanel());
    overlayButton.addEventListener('click', () => this.toggleOverlay());
    byId('home').addEventListener('click', () => events.onHome());
    byId('frame-all').addEventListener('click', () => events.onFrameAll());
    byId('mode').addEventListener('click', () => events.onNextMode());
    byId('open-help').addEventListener('click', () => this.help.showModal());
    byId('close-help').addEventListener('click', () => this.help.close());
    this.panelOpen.watch((open) => {
      byId('panel').classList.toggle('open', open);
      document.body.classList.toggle('with-panel', open);
      panelButton.setAttribute('aria-expanded', String(open));
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
    this.keep();
  }

  togglePanel(): void {
    this.panelOpen.set(!this.panelOpen.value);
    this.keep();
  }

  showState(state: ConnectionState): void {
    this.status.textContent = STATUS[state];
    this.status.dataset.state = state;
    document.body.dataset.connection = state;
  }

  showMode(mode: Navigation): void {
    const { label, icon, next } = MODES[mode];
    const button = byId('mode');
    const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    svg.setAttribute('viewBox', '0 0 24 24');
    svg.setAttribute('aria-hidden', 'true');
    const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
    path.setAttribute('d', icon);
    svg.append(path);
    button.replaceChildren(svg, el('span', {}, label));
    button.title = `A drag now: ${label.toLowerCase()}. Press for ${next} (M)`;
    button.setAttribute('aria-label', `${label}: way of steering, press for ${next}`);
    button.dataset.mode = mode;
  }

  showScene(title: string): void {
    document.title = title === '' ? 'Tyndall' : `${title} – Tyndall`;
  }

  hideWaiting(): void {
    byId('waiting').hidden = true;
  }

  private keep(): void {
    keepLayout({ panel: this.panelOpen.value, overlay: this.overlayOpen.value });
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
    // Letters belong to whatever has the focus: only the picture and the bare page listen.
    const target = event.target as HTMLElement;
    if (target !== document.body && target.id !== 'view') return;
    if (event.key === '?') this.help.showModal();
    else if (event.code === 'KeyP') this.togglePanel();
    else if (event.code === 'KeyO') this.toggleOverlay();
    else if (event.code === 'KeyR' || event.code === 'Home') this.events.onHome();
    else if (event.code === 'KeyF') this.events.onFrameAll();
    else if (event.code === 'KeyM') this.events.onNextMode();
  }
}
