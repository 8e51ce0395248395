/** The page's working copy of the scene: what the panel changes and what is sent as edits. */

import type { SceneDescription, SceneEdit } from '../protocol.gen';
import { toVec3 } from './colour';

/** What can be edited. Not the geometry: it may be megabytes, and every edit sent is remembered. */
export type Editable = Pick<SceneDescription, 'camera' | 'lights' | 'media' | 'render'>;

/** The parts of a scene that an edit may name. */
export type EditPart = 'lights' | 'media' | 'render';

export class Draft {
  readonly description: Editable;
  /** What the server last took over: an edit it refuses goes back to this. */
  private accepted: Editable;
  private pending: { input: number; state: Editable }[] = [];

  constructor(
    description: SceneDescription,
    private readonly send: (edit: SceneEdit) => void,
  ) {
    this.description = normalised(description);
    this.accepted = structuredClone(this.description);
  }

  changed(part: EditPart): void {
    this.send({ [part]: structuredClone(this.description[part]) });
  }

  setExposure(exposure_ev: number): void {
    this.description.camera.exposure_ev = exposure_ev;
    this.send({ exposure_ev });
  }

  /** An edit left with this input number, carrying the state as it is now. */
  sent(input: number): void {
    this.pending.push({ input, state: structuredClone(this.description) });
  }

  /** The server took over every edit up to `input` that it did not refuse. */
  settle(input: number): void {
    while (this.pending[0] !== undefined && this.pending[0].input <= input) {
      this.accepted = this.pending.shift()?.state ?? this.accepted;
    }
  }

  /**
   * Goes back to what the server has, if it refused an edit. Answers come in order: the edits sent
   * before are accepted. Those sent after carried the refused value too, so the rest is sent anew.
   */
  refuse(input: number): boolean {
    if (!this.pending.some((edit) => edit.input === input)) return false;
    this.settle(input - 1);
    this.pending.shift();
    this.overwrite(structuredClone(this.accepted));
    if (this.pending.length > 0) this.send(this.everything());
    this.pending = [];
    return true;
  }

  /** Takes the values of a scene with the same lights and media. */
  take(fresh: Editable): void {
    this.overwrite(fresh);
    this.accepted = structuredClone(this.description);
    this.pending = [];
  }

  /** Keeps every object, since the panel's rows hold on to them. */
  private overwrite({ camera, lights, media, render }: Editable): void {
    const kept = this.description;
    Object.assign(kept.camera, camera);
    takeInto(kept.render, render);
    for (const [index, light] of lights.entries()) Object.assign(kept.lights[index] ?? {}, light);
    for (const [index, medium] of media.entries()) Object.assign(kept.media[index] ?? {}, medium);
  }

  /** Everything that can be edited, to bring a new session to this state. */
  everything(): SceneEdit {
    const { camera, lights, media, render } = structuredClone(this.description);
    return { exposure_ev: camera.exposure_ev, lights, media, render };
  }
}

/** Takes over values one by one: objects that both have stay the target's own. */
function takeInto(target: object, source: object): void {
  const own = target as Record<string, unknown>;
  for (const [key, value] of Object.entries(source)) {
    const kept = own[key];
    if (isRecord(kept) && isRecord(value)) takeInto(kept, value);
    else own[key] = value;
  }
}

function isRecord(value: unknown): value is object {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/** Coefficients as σ_s and σ_a per channel, whichever pair the scene was written with. */
export function normalised(description: SceneDescription): Editable {
  const { camera, lights, media, render } = description;
  const copy = structuredClone({ camera, lights, media, render });
  for (const medium of copy.media) {
    if (medium.sigma_t !== undefined) {
      const extinction = toVec3(medium.sigma_t);
      const albedo = toVec3(medium.albedo);
      medium.sigma_s = [
        extinction[0] * albedo[0],
        extinction[1] * albedo[1],
        extinction[2] * albedo[2],
      ];
      medium.sigma_a = [
        extinction[0] * (1 - albedo[0]),
        extinction[1] * (1 - albedo[1]),
        extinction[2] * (1 - albedo[2]),
      ];
      delete medium.sigma_t;
      delete medium.albedo;
    }
    medium.sigma_s = toVec3(medium.sigma_s);
    medium.sigma_a = toVec3(medium.sigma_a);
    medium.emission = toVec3(medium.emission);
  }
  return copy;
}
