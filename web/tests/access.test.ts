import { describe, expect, it } from 'vitest';
import { explain, mayEnter, waits } from '../src/access';
import { readLayout } from '../src/layout';
import { addressWithToken, tokenOf, withToken } from '../src/token';

const PAGE = 'http://127.0.0.1:8080/sub/';

describe('token', () => {
  it('of any characters arrives as it was typed, encoded once', () => {
    for (const token of ['plain', 'a+b/c=', '50% & more', 'ä?#', '%2B', 'a b']) {
      const address = addressWithToken(`${PAGE}?preset=cloud&token=old#x`, token);
      expect(tokenOf(new URL(address).search)).toBe(token);
      expect(address).toContain('preset=cloud');
      const stream = withToken('v1/stream', address, token);
      expect(decodeURIComponent(stream.search.slice('?token='.length))).toBe(token);
      expect(stream.href.startsWith(`${PAGE}v1/stream?token=`)).toBe(true);
      expect(stream.hash).toBe('');
    }
  });

  it('typed without encoding is taken as it stands', () => {
    expect(tokenOf('?token=a+b/c==')).toBe('a+b/c==');
    expect(tokenOf('?token=100%')).toBe('100%');
    expect(tokenOf('?preset=cloud')).toBeNull();
    expect(tokenOf('?token=')).toBeNull();
    expect(withToken('v1/stream', `${PAGE}?preset=cloud`, null).search).toBe('');
  });
});

describe('a refusal', () => {
  const answer = (status: number, body: unknown) => async () =>
    new Response(status === 204 ? null : JSON.stringify(body), { status });

  it('is read from the problem that the server sends', async () => {
    const asked: string[] = [];
    const ask = (async (address: string) => {
      asked.push(address);
      return new Response(JSON.stringify({ title: 'no', detail: 'wrong token' }), { status: 401 });
    }) as typeof fetch;
    const refusal = await mayEnter(PAGE, 'a+b', ask);
    expect(asked).toEqual([`${PAGE}v1/access?token=a%2Bb`]);
    expect(refusal).toEqual({ status: 401, title: 'no', detail: 'wrong token' });
  });

  it('is none where the server lets the page in, is older, or is not there', async () => {
    expect(await mayEnter(PAGE, null, answer(204, null))).toBe('admitted');
    expect(await mayEnter(PAGE, null, answer(404, {}))).toBe('admitted');
    const gone = (async () => {
      throw new TypeError('failed to fetch');
    }) as typeof fetch;
    expect(await mayEnter(PAGE, null, gone)).toBe('unreachable');
  });

  it('survives an answer that is no problem document', async () => {
    const text = (async () => new Response('<html>', { status: 403 })) as typeof fetch;
    expect(await mayEnter(PAGE, null, text)).toEqual({ status: 403, title: '', detail: '' });
  });

  it('of a token or an address ends by nothing but what somebody does', () => {
    expect([401, 403].some((status) => waits({ status }))).toBe(false);
    expect([429, 500, 503].every((status) => waits({ status }))).toBe(true);
  });

  it('is explained with what to do', () => {
    const of = (status: number, hasToken = false) =>
      explain({ status, title: '', detail: '' }, hasToken);
    expect(of(401).what).toContain('asks for a token');
    expect(of(401, true).what).toContain('not the right one');
    expect(of(403).remedy).toContain('--allow-origin');
    expect(of(500).what).toContain('500');
  });
});

describe('layout', () => {
  it('starts with the picture alone, and survives storage that is odd or forbidden', () => {
    const closed = { panel: false, overlay: false };
    const holding = (text: string | null) => () => ({ getItem: () => text }) as unknown as Storage;
    expect(readLayout(holding(null))).toEqual(closed);
    expect(readLayout(holding('{"panel":true}'))).toEqual({ panel: true, overlay: false });
    expect(readLayout(holding('not json'))).toEqual(closed);
    expect(readLayout(holding('7'))).toEqual(closed);
    const forbidden = () => {
      throw new DOMException('denied', 'SecurityError');
    };
    expect(readLayout(forbidden)).toEqual(closed);
  });
});
