/** The controls: folders built from the scene that is open. */

import GUI from 'lil-gui';
import type { CameraRig } from '../camera/rig';
import { el } from '../dom';
import { count } from '../format';
import type {
  CameraPose,
  Preset,
  SceneDescription,
  SceneEdit,
  SceneMessage,
} from '../protocol.gen';
import type { ResolutionScale } from '../size';
import { addCamera, type CameraFolder } from './camera';
import { Draft, type Editable } from './draft';
import { type Field, field } from './field';
import { addLight } from './light';
import { addMedium } from './medium';
import { addQuality, addTechnique } from './render';
import { addButton, addReadout, addSelect, addSlider } from './rows';
import { addTime, type TimeFolder } from './time';
import './panel.css';

export interface PanelEvents {
  onEdit(edit: SceneEdit): void;
  onPreset(name: string): void;
  /** The values of the working copy changed. */
  onValues(): void;
}

/** Folders that start closed: what a first visitor does not need. */
const CLOSED = new Set(['Hierarchical filter', 'Quality']);

export class Panel {
  private gui: GUI | null = null;
  private draft: Draft | null = null;
  private shape = '';
  private camera: CameraFolder | null = null;
  private time: TimeFolder | null = null;
  private readonly open = new Map<string, boolean>();

  constructor(
    private readonly container: HTMLElement,
    private readonly rig: CameraRig,
    private readonly resolution: Field<ResolutionScale>,
    private readonly events: PanelEvents,
  ) {}

  /** Shows a scene; rows are rebuilt only when there are other lights or media than before. */
  show(scene: SceneMessage, presets: readonly Preset[]): void {
    const draft = new Draft(scene.description, (edit) => {
      this.events.onEdit(edit);
      this.events.onValues();
    });
    // A clock is rebuilt: it may have been set by another page.
    const shape = scene.clock === undefined ? shapeOf(scene.name, scene.description) : '';
    if (this.gui !== null && this.draft !== null && shape !== '' && shape === this.shape) {
      this.draft.take(draft.description);
      this.refresh();
      return;
    }
    this.shape = shape;
    this.draft = draft;
    this.rebuild(scene, presets, draft);
  }

  editSent(input: number): void {
    this.draft?.sent(input);
  }

  /** A picture shows every input up to `input`. */
  settle(input: number): void {
    this.draft?.settle(input);
  }

  /** If the server refused an edit, the rows go back to what it has. */
  refuse(input: number): void {
    if (!this.draft?.refuse(input)) return;
    this.refresh();
    this.events.onValues();
  }

  showCamera(pose: CameraPose): void {
    this.camera?.show(pose);
  }

  /** A picture shows this time of the scene. Unit: s. */
  showTime(seconds: number): void {
    this.time?.show(seconds);
  }

  /** The working copy of the open scene; null before the first. */
  get working(): Draft | null {
    return this.draft;
  }

  /** The whole state as an edit; null before the first scene. */
  state(): SceneEdit | null {
    return this.draft?.everything() ?? null;
  }

  /** Shows what the working copy holds. */
  refresh(): void {
    for (const row of this.gui?.controllersRecursive() ?? []) row.updateDisplay();
  }

  private rebuild(scene: SceneMessage, presets: readonly Preset[], draft: Draft): void {
    for (const folder of this.gui?.foldersRecursive() ?? []) {
      this.open.set(folder._title, !folder._closed);
    }
    this.gui?.destroy();
    const { description } = draft;
    const gui = new GUI({ container: this.container, title: 'Controls', injectStyles: false });
    this.gui = gui;

    this.addScene(gui.addFolder('Scene'), scene, presets);
    const { clock } = scene;
    this.time =
      clock === undefined
        ? null
        : addTime(gui.addFolder('Time'), clock, (edit) => this.events.onEdit(edit));
    const image = gui.addFolder('Image');
    addTechnique(image, description.render, () => draft.changed('render'));
    const exposure = field(
      () => description.camera.exposure_ev,
      (value) => draft.setExposure(value),
    );
    addSlider(image, exposure, 'Exposure', { min: -10, max: 10, step: 0.1, unit: 'EV' });
    for (const [index, medium] of description.media.entries()) {
      addMedium(gui, medium, index, () => draft.changed('media'));
    }
    for (const [index, light] of description.lights.entries()) {
      addLight(gui, light, index, () => draft.changed('lights'));
    }
    this.camera = addCamera(gui.addFolder('Camera'), this.rig);
    this.camera.show(this.rig.current);
    const quality = gui.addFolder('Quality');
    addQuality(quality, description.render, this.resolution, () => draft.changed('render'));

    const manyLights = description.lights.length > 3;
    for (const folder of gui.foldersRecursive()) {
      const closed = CLOSED.has(folder._title) || (manyLights && isLight(folder, description));
      folder.open(this.open.get(folder._title) ?? !closed);
    }
  }

  private addScene(folder: GUI, scene: SceneMessage, presets: readonly Preset[]): void {
    const current = presetOf(scene, presets);
    const options = presets.map(({ name, title }) => ({ value: name, label: title }));
    if (current === null) {
      options.unshift({ value: '', label: scene.name === '' ? 'own scene' : scene.name });
    }
    const preset = field(
      () => current?.name ?? '',
      (name) => {
        if (name !== '') this.events.onPreset(name);
      },
    );
    addSelect(folder, preset, 'Preset', options);
    if (current !== null) folder.$children.append(el('p', { class: 'note' }, current.summary));
    addReadout(folder, 'Triangles').set(count(scene.facts.triangles));
    for (const warning of scene.warnings) {
      folder.$children.append(el('p', { class: 'note warning' }, warning));
    }
    if (current !== null) {
      addButton(folder, 'Reset scene', () => this.events.onPreset(current.name));
    }
  }
}

/** The preset a scene message shows, if it is one. */
export function presetOf(
  scene: Pick<SceneMessage, 'name'>,
  presets: readonly Preset[],
): Preset | null {
  return presets.find(({ name, title }) => name === scene.name || title === scene.name) ?? null;
}

/** Scenes of one shape have the same rows. */
function shapeOf(name: string, description: SceneDescription): string {
  const kinds = (entries: readonly { kind: string; name?: string | null }[]) =>
    entries.map((entry) => [entry.kind, entry.name ?? '']);
  return JSON.stringify([name, kinds(description.lights), kinds(description.media)]);
}

function isLight(folder: GUI, description: Editable): boolean {
  const folders = folder.root.folders.filter((other) => other._title !== 'Time');
  const first = 2 + description.media.length;
  const index = folders.indexOf(folder);
  return index >= first && index < first + description.lights.length;
}
