/** The token that the server asks for, as the page's own address carries it. */

/**
 * The `token` of a query, percent-decoded once. A plus is a plus: this is no form. What is no valid
 * percent-encoding was typed as it stands.
 */
export function tokenOf(search: string): string | null {
  const pairs = search.replace(/^\?/, '').split('&');
  const raw = pairs.find((pair) => pair.startsWith('token='))?.slice('token='.length);
  if (raw === undefined || raw === '') return null;
  try {
    return decodeURIComponent(raw);
  } catch {
    return raw;
  }
}

/** `path` beside the page, with the token if there is one. */
export function withToken(path: string, page: string, token: string | null): URL {
  const url = new URL(path, page);
  url.search = token === null ? '' : `?token=${encodeURIComponent(token)}`;
  url.hash = '';
  return url;
}

/** The page's address with another token, everything else as it was. */
export function addressWithToken(page: string, token: string): string {
  const url = new URL(page);
  const others = url.search.replace(/^\?/, '').split('&');
  const kept = others.filter((pair) => pair !== '' && !pair.startsWith('token='));
  url.search = `?${[...kept, `token=${encodeURIComponent(token)}`].join('&')}`;
  return url.href;
}

/** The stream beside the page, with the page's token if it has one. */
export function streamUrl(page: string, token: string | null): string {
  const url = withToken('v1/stream', page, token);
  url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
  return url.href;
}
