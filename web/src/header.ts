/** The 64-byte little-endian header in front of every streamed picture. */

import { CODEC_JPEG, CODEC_PNG, type Codec, HEADER_BYTES, HEADER_VERSION } from './protocol.gen';

const MAGIC = 0x444e5954; // "TYND" read as a little-endian u32

export interface FrameHeader {
  codec: Codec;
  converged: boolean;
  softwareAdapter: boolean;
  /** Grows with every scene opened; frames of an older one are stale. */
  epoch: number;
  frame: number;
  /** The newest input number the picture shows. */
  appliedInput: number;
  samples: number;
  width: number;
  height: number;
  /** Relative; null where the server does not know it. */
  estimatedError: number | null;
  renderMicros: number;
  encodeMicros: number;
  payloadBytes: number;
}

/** Reads the header of a binary message; throws a one-line reason when it is not one of ours. */
export function parseHeader(message: ArrayBuffer): FrameHeader {
  if (message.byteLength < HEADER_BYTES) {
    throw new Error(`frame of ${message.byteLength} bytes is shorter than its header`);
  }
  const view = new DataView(message);
  if (view.getUint32(0, true) !== MAGIC) throw new Error('frame does not start with TYND');
  const version = view.getUint16(4, true);
  if (version !== HEADER_VERSION) throw new Error(`frame header version ${version} is not known`);
  const payloadBytes = view.getUint32(48, true);
  if (HEADER_BYTES + payloadBytes !== message.byteLength) {
    throw new Error(
      `frame announces ${payloadBytes} bytes, has ${message.byteLength - HEADER_BYTES}`,
    );
  }
  const flags = view.getUint8(7);
  const estimatedError = view.getFloat32(36, true);
  return {
    codec: codecFromByte(view.getUint8(6)),
    converged: (flags & 1) !== 0,
    softwareAdapter: (flags & 2) !== 0,
    epoch: view.getUint32(8, true),
    frame: view.getUint32(12, true),
    // Input numbers start at 1 and grow by one: they stay far below 2^53.
    appliedInput: Number(view.getBigUint64(16, true)),
    samples: view.getUint32(24, true),
    width: view.getUint32(28, true),
    height: view.getUint32(32, true),
    estimatedError: estimatedError < 0 ? null : estimatedError,
    renderMicros: view.getUint32(40, true),
    encodeMicros: view.getUint32(44, true),
    payloadBytes,
  };
}

function codecFromByte(byte: number): Codec {
  if (byte === CODEC_JPEG) return 'jpeg';
  if (byte === CODEC_PNG) return 'png';
  throw new Error(`frame codec ${byte} is not known`);
}
