/**
 * Prints, for the release notes: time from start to the first picture, and what streaming adds to
 * rendering. Spaced key presses in a small window, so that no input waits behind another picture.
 */

import { setTimeout as sleep } from 'node:timers/promises';
import { caughtUp, launch, open, state } from './support/page.mjs';
import { Server } from './support/server.mjs';

const INPUTS = 40;
const PRESET = process.argv[2] ?? 'cornell_fog';

const server = new Server();
const begun = performance.now();
await server.start();
const listening = performance.now() - begun;
const browser = await launch();
try {
  const asked = performance.now();
  const { page } = await open(browser, `${server.url}?preset=${PRESET}`, {
    viewport: { width: 320, height: 200 },
  });
  const firstPicture = performance.now() - asked;
  await caughtUp(page);
  await page.focus('canvas');
  for (let input = 0; input < INPUTS; input += 1) {
    await page.keyboard.press(input % 2 === 0 ? 'ArrowLeft' : 'ArrowRight');
    await caughtUp(page);
    await sleep(50);
  }
  const { latency, stats, lastHeader } = await state(page);
  const overhead = latency.total - latency.render;
  const line = (name, value) => console.log(`${name.padEnd(44)}${value.toFixed(1)} ms`);
  console.log(`${PRESET}, ${lastHeader.width}×${lastHeader.height}, ${latency.samples} inputs`);
  line('serve to listening', listening);
  line('page load to first picture', firstPicture);
  line('input to paint, median', latency.total);
  line('input to paint, 95th percentile', latency.p95);
  line('  render', latency.render);
  line('  encode', latency.encode);
  line('  decode', latency.decode);
  line('  transit and waiting', latency.transit);
  line('overhead: input to paint minus render', overhead);
  console.log(`bytes a picture ${stats.bytes}`);
} finally {
  await browser.close();
  await server.stop();
}
