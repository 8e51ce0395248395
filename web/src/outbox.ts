/** What the user did since the last animation frame, newest wins, numbered when it is sent. */

import type { CameraPose, ClientMessage, SceneEdit } from './protocol.gen';

export interface Size {
  width: number;
  height: number;
}

export class Outbox {
  private camera: CameraPose | null = null;
  /** Whether surfaces stop the waiting camera. */
  private stops = false;
  private edit: SceneEdit | null = null;
  private preset: string | null = null;
  private size: Size | null = null;
  /**
   * Number of the preset being opened. Until its scene is there everything else waits: a camera or
   * an edit of the old scene would hit the new one.
   */
  private opening: number | null = null;

  /** `lastInput` is the number of the last input sent, 0 for none. */
  constructor(private lastInput = 0) {}

  get newestInput(): number {
    return this.lastInput;
  }

  /** `stops`: surfaces stop the eye on the way there. A waiting way through them stays one. */
  setCamera(camera: CameraPose, stops = false): void {
    this.stops = stops && (this.camera === null || this.stops);
    this.camera = camera;
  }

  /** A surface stopped the eye, and this is what the server shows: nothing is left to send. */
  dropCamera(): void {
    this.camera = null;
  }

  /** Each part of the scene that `edit` names replaces what was waiting for that part. */
  addEdit(edit: SceneEdit): void {
    this.edit = { ...this.edit, ...edit };
  }

  /** Edits and camera of the scene being left are dropped: they would hit the new one. */
  openPreset(name: string): void {
    this.preset = name;
    this.edit = null;
    this.camera = null;
  }

  setSize(size: Size): void {
    this.size = size;
  }

  /** A scene has been opened: what was meant for the one before is void. */
  sceneOpened(): void {
    this.opening = this.camera = this.edit = null;
  }

  /** The server refused this input; if it was a preset, the old scene goes on. */
  refused(input: number): void {
    if (this.opening === input) this.opening = null;
  }

  /** A new connection opens nothing yet. */
  reconnected(): void {
    this.opening = null;
  }

  /**
   * Sends at most one message a kind, in the order in which they make sense to the server.
   * `send` returns false when nothing can be sent now; the rest then waits.
   */
  flush(send: (message: ClientMessage & { input: number }) => boolean): void {
    if (this.size !== null) {
      if (!this.deliver(send, { type: 'resize', input: this.lastInput + 1, ...this.size })) return;
      this.size = null;
    }
    if (this.opening !== null) return;
    if (this.preset !== null) {
      const message = {
        type: 'open_preset',
        input: this.lastInput + 1,
        name: this.preset,
      } as const;
      if (!this.deliver(send, message)) return;
      this.opening = message.input;
      this.preset = null;
      return;
    }
    if (this.edit !== null) {
      const message = { type: 'edit', input: this.lastInput + 1, edit: this.edit } as const;
      if (!this.deliver(send, message)) return;
      this.edit = null;
    }
    if (this.camera !== null) {
      const input = this.lastInput + 1;
      const through = { type: 'camera', input, camera: this.camera } as const;
      const message = this.stops ? { ...through, stops_at_surfaces: true } : through;
      if (!this.deliver(send, message)) return;
      this.camera = null;
    }
  }

  private deliver(
    send: (message: ClientMessage & { input: number }) => boolean,
    message: ClientMessage & { input: number },
  ): boolean {
    if (!send(message)) return false;
    this.lastInput = message.input;
    return true;
  }
}
