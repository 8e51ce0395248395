/**
 * Prints how a picture at rest comes nearer to its last state at 1280×720: after a short drag, the difference in
 * steps of 255, over 4×4 pixels, of the upper and the lower half, second by second. `node rest.mjs [PRESET]
 * [SECONDS]`; TYNDALL_BIN names the binary.
 */

import { setTimeout as sleep } from 'node:timers/promises';
import { keepScreenshot, launch, open, state } from './support/page.mjs';
import { Server } from './support/server.mjs';

const PRESET = process.argv[2] ?? 'fogged_hall';
const SECONDS = Number(process.argv[3] ?? 90);
const VIEWPORT = { width: 1280, height: 720 };
const TIMES = [1, 2, 3, 4, 6, 8, 10, 12, 15, 20, 25, 30, 40, 60];

/** The picture on the canvas, shrunk to a quarter of its sides. */
const shrunk = (page) =>
  page.evaluate(({ width, height }) => {
    const small = document.createElement('canvas');
    small.width = width / 4;
    small.height = height / 4;
    const context = small.getContext('2d', { willReadFrequently: true });
    context.imageSmoothingQuality = 'high';
    context.drawImage(document.getElementById('view'), 0, 0, small.width, small.height);
    return [...context.getImageData(0, 0, small.width, small.height).data];
  }, VIEWPORT);

/** Root of the mean squared difference of a half of two pictures, 0 the upper one. */
function difference(a, b, half) {
  const from = (half * a.length) / 2;
  let sum = 0;
  for (let at = from; at < from + a.length / 2; at += 1) sum += (a[at] - b[at]) ** 2;
  return Math.sqrt((sum * 4) / 3 / (a.length / 2));
}

const server = new Server();
await server.start();
const browser = await launch();
try {
  const { page } = await open(browser, `${server.url}?preset=${PRESET}`, { viewport: VIEWPORT });
  await sleep(1500);
  const [x, y] = [VIEWPORT.width / 2, VIEWPORT.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let step = 0; step < 60; step += 1) {
    await page.mouse.move(x + step, y);
    await sleep(16);
  }
  await page.mouse.up();
  const rested = performance.now();
  const seen = [];
  for (const seconds of [...TIMES.filter((time) => time < SECONDS), SECONDS]) {
    await sleep(Math.max(0, rested + seconds * 1000 - performance.now()));
    const { lastHeader } = await state(page);
    seen.push({ seconds, picture: await shrunk(page), header: lastHeader });
    if (seconds === 4 || seconds === 12) await keepScreenshot(page, `rest-${PRESET}-${seconds}s`);
  }
  const last = seen.at(-1);
  for (const { seconds, picture, header } of seen) {
    const [upper, lower] = [0, 1].map((half) => difference(picture, last.picture, half).toFixed(2));
    console.log(
      `${PRESET} ${String(seconds).padStart(3)} s · ${header.width}×${header.height}, ${header.samples} samples · ` +
        `upper half ${upper}, lower half ${lower}`,
    );
  }
} finally {
  await browser.close();
  await server.stop();
}
