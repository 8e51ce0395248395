import { describe, expect, it } from 'vitest';
import { isNewer } from '../src/frames';
import { parseHeader } from '../src/header';
import { HEADER_BYTES } from '../src/protocol.gen';

function frame(change: (view: DataView) => void = () => {}): ArrayBuffer {
  const buffer = new ArrayBuffer(HEADER_BYTES + 5);
  const view = new DataView(buffer);
  for (const [index, letter] of [...'TYND'].entries()) view.setUint8(index, letter.charCodeAt(0));
  view.setUint16(4, 1, true);
  view.setUint8(6, 2);
  view.setUint8(7, 0b11);
  view.setUint32(8, 3, true);
  view.setUint32(12, 77, true);
  view.setBigUint64(16, 2n ** 52n + 1n, true);
  view.setUint32(24, 64, true);
  view.setUint32(28, 1280, true);
  view.setUint32(32, 720, true);
  view.setFloat32(36, 0.25, true);
  view.setUint32(40, 12_345, true);
  view.setUint32(44, 678, true);
  view.setUint32(48, 5, true);
  change(view);
  return buffer;
}

describe('frame header', () => {
  it('reads every field at its offset', () => {
    expect(parseHeader(frame())).toEqual({
      codec: 'png',
      converged: true,
      softwareAdapter: true,
      epoch: 3,
      frame: 77,
      appliedInput: 2 ** 52 + 1,
      samples: 64,
      width: 1280,
      height: 720,
      estimatedError: 0.25,
      renderMicros: 12_345,
      encodeMicros: 678,
      payloadBytes: 5,
    });
  });

  it('takes −1 as an unknown error', () => {
    const header = parseHeader(frame((view) => view.setFloat32(36, -1, true)));
    expect(header.estimatedError).toBeNull();
  });

  it.each([
    ['a foreign message', (view: DataView) => view.setUint8(0, 0), /TYND/],
    ['another version', (view: DataView) => view.setUint16(4, 2, true), /version 2/],
    ['an unknown codec', (view: DataView) => view.setUint8(6, 9), /codec 9/],
    ['a wrong length', (view: DataView) => view.setUint32(48, 6, true), /announces 6 bytes, has 5/],
  ])('refuses %s and says why', (_, change, reason) => {
    expect(() => parseHeader(frame(change))).toThrow(reason);
  });

  it('refuses a message shorter than itself', () => {
    expect(() => parseHeader(new ArrayBuffer(63))).toThrow(/63 bytes/);
  });
});

describe('newest picture wins', () => {
  it('by epoch first, then by frame', () => {
    expect(isNewer({ epoch: 1, frame: 1 }, null)).toBe(true);
    expect(isNewer({ epoch: 1, frame: 9 }, { epoch: 1, frame: 8 })).toBe(true);
    expect(isNewer({ epoch: 1, frame: 8 }, { epoch: 1, frame: 8 })).toBe(false);
    expect(isNewer({ epoch: 1, frame: 99 }, { epoch: 2, frame: 3 })).toBe(false);
    expect(isNewer({ epoch: 2, frame: 1 }, { epoch: 1, frame: 99 })).toBe(true);
  });
});
