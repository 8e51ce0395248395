/** What survives a reload of this tab, so that the session goes on where it was. */

import type { OwnValues } from './own';
import { normalised } from './panel/draft';
import type {
  CameraPose,
  Navigation,
  SceneDescription,
  SceneEdit,
  SceneMessage,
} from './protocol.gen';

const KEY = 'tyndall.session';

export interface Kept {
  session: string;
  /** The session's input numbers go on from here. */
  lastInput: number;
  sceneName: string;
  home: CameraPose;
  /** The way of steering that was chosen. */
  mode?: Navigation;
  /** Every value that the page can edit, as it was. */
  edit: SceneEdit;
  /** What some of them were before any edit. */
  own: OwnValues;
}

/** Reads and removes: a duplicated tab must not take over this tab's session. */
export function takeKept(storage: Storage = sessionStorage): Kept | null {
  try {
    const text = storage.getItem(KEY);
    storage.removeItem(KEY);
    const kept = text === null ? null : (JSON.parse(text) as Partial<Kept>);
    // A page of an older version kept less.
    return kept?.edit === undefined || kept.own === undefined ? null : (kept as Kept);
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

/** The scene as the page showed it, whether or not the last edits reached the server. */
export function withKept(scene: SceneMessage, kept: Pick<Kept, 'edit'>): SceneMessage {
  return { ...scene, description: edited(scene.description, kept.edit) };
}

/** The edit that the server lacks, if it lacks any: all of it, so that none counts without the others. */
export function unsaved(
  description: SceneDescription,
  { edit }: Pick<Kept, 'edit'>,
): SceneEdit | null {
  const text = (values: SceneDescription) => JSON.stringify(sorted(normalised(values)));
  return text(edited(description, edit)) === text(description) ? null : edit;
}

function edited(description: SceneDescription, edit: SceneEdit): SceneDescription {
  const { camera } = description;
  return {
    ...description,
    camera: { ...camera, exposure_ev: edit.exposure_ev ?? camera.exposure_ev },
    lights: edit.lights ?? description.lights,
    media: edit.media ?? description.media,
    render: edit.render ?? description.render,
  };
}

/** The same value with the names in order: the server writes them in another one. */
function sorted(value: unknown): unknown {
  if (Array.isArray(value)) return value.map(sorted);
  if (typeof value !== 'object' || value === null) return value;
  const entries = Object.entries(value).sort(([a], [b]) => (a < b ? -1 : 1));
  return Object.fromEntries(entries.map(([name, inner]) => [name, sorted(inner)]));
}
