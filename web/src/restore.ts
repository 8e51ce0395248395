/**
 * Brings a server back to what the page shows after a lost connection: what was sent last may be
 * lost, and a restarted server has forgotten the session.
 */

import type { SceneEdit } from './protocol.gen';

export type RestoreStep = { open: string } | { edit: SceneEdit } | null;

export class Restore {
  private wanted: { scene: string; edit: SceneEdit } | null = null;
  private opened = false;

  /** `scene` is the name of the scene that was open, `edit` its whole editable state. */
  begin(scene: string, edit: SceneEdit): void {
    this.wanted = { scene, edit };
    this.opened = false;
  }

  cancel(): void {
    this.wanted = null;
  }

  /**
   * What to do about the scene that the server opened. `preset` is the preset to open if it is
   * another one; null takes the server's scene as it is.
   */
  onScene(scene: string, preset: string | null): RestoreStep {
    const { wanted } = this;
    if (wanted === null) return null;
    if (scene === wanted.scene) {
      this.wanted = null;
      return { edit: wanted.edit };
    }
    if (preset === null || this.opened) {
      // The scene is gone; what the server shows is all there is.
      this.wanted = null;
      return null;
    }
    this.opened = true;
    return { open: preset };
  }
}
