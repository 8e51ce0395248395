/** Why the server refuses this page, asked over plain HTTP: a browser hides it from a WebSocket. */

import { withToken } from './token';

export interface Refusal {
  status: number;
  title: string;
  detail: string;
}

const PATIENCE_MILLIS = 5000;

/**
 * Whether the server lets the page in now, and would at all: 'later' may become 'admitted' by waiting, 'refused'
 * only by something that somebody does.
 */
export type Access = 'admitted' | 'unreachable' | 'later' | 'refused';

/** Asks the server whether it lets the page in; a refusal is why it does not. */
export async function mayEnter(
  page: string,
  token: string | null,
  ask: typeof fetch = fetch,
): Promise<'admitted' | 'unreachable' | Refusal> {
  let response: Response;
  try {
    const signal = AbortSignal.timeout(PATIENCE_MILLIS);
    response = await ask(withToken('v1/access', page, token).href, { signal, cache: 'no-store' });
  } catch {
    return 'unreachable';
  }
  // An older server has no such address; it may be right or wrong about anything else.
  if (response.ok || response.status === 404) return 'admitted';
  const problem = await response.json().catch(() => null);
  const text = (name: string): string => {
    const value = problem === null ? undefined : problem[name];
    return typeof value === 'string' ? value : '';
  };
  return { status: response.status, title: text('title'), detail: text('detail') };
}

/** Whether a refusal may end by itself: not that of a token or an address. */
export function waits({ status }: Pick<Refusal, 'status'>): boolean {
  return status !== 401 && status !== 403;
}

/** What happened and what to do about it, in two plain sentences. */
export function explain(refusal: Refusal, hasToken: boolean): { what: string; remedy: string } {
  if (refusal.status === 401) {
    return {
      what: hasToken ? 'The token is not the right one.' : 'This server asks for a token.',
      remedy: 'Enter the token that the server was started with (--token).',
    };
  }
  if (refusal.status === 403) {
    return {
      what: 'The server does not let pages from this address connect.',
      remedy:
        'Open the address that the server printed when it started, or start it with ' +
        '--allow-origin and the address of this page.',
    };
  }
  if (refusal.status === 429) {
    return {
      what: 'Too many wrong tokens came from here.',
      remedy: 'Wait a minute, then try again.',
    };
  }
  if (refusal.status === 503) {
    return { what: 'The server is busy or going down.', remedy: 'The page keeps trying.' };
  }
  return {
    what: refusal.title === '' ? `The server answered ${refusal.status}.` : refusal.title,
    remedy: 'The page keeps trying.',
  };
}
