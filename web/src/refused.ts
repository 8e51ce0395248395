/** The page's word on why the server refuses it, and the way in. */

import { explain, type Refusal, whyRefused } from './access';
import { byId } from './dom';
import { addressWithToken, tokenOf } from './token';

export interface RefusedEvents {
  /** The server refuses the page, or lets it in after all. */
  onKnown(refused: boolean): void;
}

export class RefusedDialog {
  private readonly dialog = byId<HTMLDialogElement>('refused');
  private asking = false;

  constructor(private readonly events: RefusedEvents) {
    byId<HTMLFormElement>('token-form').addEventListener('submit', (event) => {
      event.preventDefault();
      const token = byId<HTMLInputElement>('token').value;
      if (token !== '') location.assign(addressWithToken(location.href, token));
    });
  }

  /** A connection failed: asks why, one question at a time. */
  async ask(): Promise<void> {
    if (this.asking) return;
    this.asking = true;
    const token = tokenOf(location.search);
    const refusal = await whyRefused(location.href, token);
    this.asking = false;
    this.events.onKnown(refusal !== null);
    if (refusal === null) this.close();
    else this.show(refusal, token !== null);
  }

  close(): void {
    if (this.dialog.open) this.dialog.close();
  }

  private show(refusal: Refusal, hasToken: boolean): void {
    const { what, remedy } = explain(refusal, hasToken);
    byId('refused-title').textContent = what;
    byId('refused-remedy').textContent = remedy;
    byId('refused-detail').textContent = refusal.detail;
    byId('token-form').hidden = refusal.status !== 401;
    byId('waiting').hidden = true;
    if (!this.dialog.open) this.dialog.showModal();
  }
}
