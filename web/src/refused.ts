/** The page's word on why the server refuses it, and the way in. */

import { type Access, explain, mayEnter, type Refusal, waits } from './access';
import { byId } from './dom';
import { addressWithToken, tokenOf } from './token';

export class RefusedDialog {
  private readonly dialog = byId<HTMLDialogElement>('refused');

  constructor() {
    byId<HTMLFormElement>('token-form').addEventListener('submit', (event) => {
      event.preventDefault();
      const token = byId<HTMLInputElement>('token').value;
      if (token !== '') location.assign(addressWithToken(location.href, token));
    });
  }

  /** Asks whether the server lets the page in, and says why if it does not. */
  async ask(): Promise<Access> {
    const token = tokenOf(location.search);
    const answer = await mayEnter(location.href, token);
    if (typeof answer === 'string') {
      if (answer === 'admitted') this.close();
      return answer;
    }
    this.show(answer, token !== null);
    return waits(answer) ? 'later' : 'refused';
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
