/** Whether a picture shows anything: how much of it is too dark or too bright to be told apart. Pure. */

/** What a picture shows: something, nearly nothing but black, or nearly nothing but what is too bright. */
export type Visible = 'something' | 'dark' | 'bright';

/** A pixel whose brightest channel is at most this is taken for black. Range: 0 to 255. */
export const NEAR_BLACK = 12;
/** Channels above are as good as the brightest there is, channels below as good as none. */
const NEAR_MOST = 250;
const NEAR_NONE = 4;
/** Share of the pixels from which on the page speaks, and below which it is silent again. */
const SPEAKS = 0.95;
const SILENT = 0.92;

export interface Shares {
  /** Pixels that are black or nearly so. Range: 0 to 1. */
  dark: number;
  /** Pixels of which every channel is at one of its ends, and one at the upper end. Range: 0 to 1. */
  bright: number;
}

/** Of pixels as a canvas gives them, four bytes each. */
export function sharesOf(data: ArrayLike<number>): Shares {
  let dark = 0;
  let bright = 0;
  for (let at = 0; at < data.length; at += 4) {
    const channels = [data[at] ?? 0, data[at + 1] ?? 0, data[at + 2] ?? 0];
    const most = Math.max(...channels);
    if (most <= NEAR_BLACK) dark += 1;
    else if (most >= NEAR_MOST && channels.every((c) => c >= NEAR_MOST || c <= NEAR_NONE)) {
      bright += 1;
    }
  }
  const pixels = Math.max(1, data.length / 4);
  return { dark: dark / pixels, bright: bright / pixels };
}

/** `before` is what the page says at present: a picture at the border must not make it flicker. */
export function judge({ dark, bright }: Shares, before: Visible): Visible {
  if (dark >= (before === 'dark' ? SILENT : SPEAKS)) return 'dark';
  if (bright >= (before === 'bright' ? SILENT : SPEAKS)) return 'bright';
  return 'something';
}
