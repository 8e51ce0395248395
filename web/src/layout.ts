/** Which drawers are open, kept from visit to visit. */

const KEY = 'tyndall.layout';

export interface Layout {
  panel: boolean;
  overlay: boolean;
}

/** At first the picture alone. */
const FIRST: Layout = { panel: false, overlay: false };

/** A browser may forbid storage altogether: even naming it throws then. */
export function readLayout(storage: () => Storage = () => localStorage): Layout {
  try {
    const kept: unknown = JSON.parse(storage().getItem(KEY) ?? 'null');
    if (typeof kept !== 'object' || kept === null) return FIRST;
    const { panel, overlay } = kept as Partial<Layout>;
    return { panel: panel === true, overlay: overlay === true };
  } catch {
    return FIRST;
  }
}

export function keepLayout(layout: Layout, storage: () => Storage = () => localStorage): void {
  try {
    storage().setItem(KEY, JSON.stringify(layout));
  } catch {
    // Then the next visit starts with the picture alone.
  }
}
