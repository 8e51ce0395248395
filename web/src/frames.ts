/** From binary message to pixels on the canvas, newest picture wins. */

import { type FrameHeader, parseHeader } from './header';
import { HEADER_BYTES } from './protocol.gen';

export interface PaintedFrame {
  header: FrameHeader;
  /** `performance.now()` when the picture was on the canvas. */
  painted: number;
  decodeMillis: number;
}

export interface FrameEvents {
  /** Every frame, painted or not, exactly once: the server counts them. */
  onAcknowledge(frame: number): void;
  onPainted(frame: PaintedFrame): void;
  onBroken(reason: string): void;
}

/** Whether `next` shows something newer than the picture on the canvas. */
export function isNewer(
  next: Pick<FrameHeader, 'epoch' | 'frame'>,
  shown: Pick<FrameHeader, 'epoch' | 'frame'> | null,
): boolean {
  if (shown === null) return true;
  if (next.epoch !== shown.epoch) return next.epoch > shown.epoch;
  return next.frame > shown.frame;
}

/** Decodes off the main thread (`createImageBitmap`) and hands the bitmap over without a copy. */
export class FramePainter {
  private readonly context: ImageBitmapRenderingContext;
  private shown: FrameHeader | null = null;
  private generation = 0;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly events: FrameEvents,
  ) {
    const context = canvas.getContext('bitmaprenderer', { alpha: false });
    if (context === null) throw new Error('this browser has no bitmaprenderer canvas context');
    this.context = context;
  }

  /** A new connection numbers its frames anew: what is still being decoded is void. */
  reset(): void {
    this.generation += 1;
    this.shown = null;
  }

  async receive(message: ArrayBuffer): Promise<void> {
    const generation = this.generation;
    const arrived = performance.now();
    let header: FrameHeader;
    try {
      header = parseHeader(message);
    } catch (error) {
      this.events.onBroken(String(error instanceof Error ? error.message : error));
      return;
    }
    if (!isNewer(header, this.shown)) {
      this.events.onAcknowledge(header.frame);
      return;
    }
    let bitmap: ImageBitmap;
    try {
      const payload = new Uint8Array(message, HEADER_BYTES);
      bitmap = await createImageBitmap(new Blob([payload], { type: `image/${header.codec}` }), {
        premultiplyAlpha: 'none',
        colorSpaceConversion: 'none',
      });
    } catch {
      if (generation !== this.generation) return;
      this.events.onAcknowledge(header.frame);
      this.events.onBroken(`frame ${header.frame} is not a readable ${header.codec} picture`);
      return;
    }
    if (generation !== this.generation) {
      bitmap.close();
      return;
    }
    // Two decodes may finish out of order.
    if (!isNewer(header, this.shown)) {
      bitmap.close();
      this.events.onAcknowledge(header.frame);
      return;
    }
    this.shown = header;
    if (this.canvas.width !== bitmap.width) this.canvas.width = bitmap.width;
    if (this.canvas.height !== bitmap.height) this.canvas.height = bitmap.height;
    const decoded = performance.now();
    this.context.transferFromImageBitmap(bitmap);
    const painted = performance.now();
    this.events.onAcknowledge(header.frame);
    this.events.onPainted({ header, painted, decodeMillis: decoded - arrived });
  }
}
