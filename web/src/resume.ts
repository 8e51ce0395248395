/** What survives a reload of this tab, so that the session goes on where it was. */

import type { CameraPose, Navigation } from './protocol.gen';

const KEY = 'tyndall.session';

export interface Kept {
  session: string;
  /** The session's input numbers go on from here. */
  lastInput: number;
  sceneName: string;
  home: CameraPose;
  /** The way of steering that was chosen. */
  mode?: Navigation;
}

/** Reads and removes: a duplicated tab must not take over this tab's session. */
export function takeKept(storage: Storage = sessionStorage): Kept | null {
  try {
    const text = storage.getItem(KEY);
    storage.removeItem(KEY);
    return text === null ? null : (JSON.parse(text) as Kept);
  } catch {
    return null;
  }
}

export function keep(kept: Kept, storage: Storage = sessionStorage): void {
  try {
    storage.setItem(KEY, JSON.stringify(kept));
  } catch {
    // A browser that forbids storage only loses the resumption.
  }
}
