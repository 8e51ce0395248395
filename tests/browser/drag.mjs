/**
 * Prints, for every preset, what a newcomer sees at 1280×720: time to the first picture and its size,
 * frames a second and input to paint in a drag, and how long the picture takes to its full size at rest.
 * `node drag.mjs [PRESET...]`; TYNDALL_BIN names the binary.
 */

import { setTimeout as sleep } from 'node:timers/promises';
import { keepScreenshot, launch, open, state } from './support/page.mjs';
import { Server } from './support/server.mjs';

const ALL = ['fogged_hall', 'light_shafts', 'cornell_fog', 'street_night', 'swinging_lamp', 'smoke_plume', 'cloud'];
const PRESETS = process.argv.length > 2 ? process.argv.slice(2) : ALL;
const VIEWPORT = { width: 1280, height: 720 };
const DRAG_MILLIS = 6000;
const REST_MILLIS = 30_000;

async function measure(browser, server, preset) {
  const asked = performance.now();
  const { page, context } = await open(browser, `${server.url}?preset=${preset}`, { viewport: VIEWPORT });
  const first = performance.now() - asked;
  const firstSize = (await state(page)).lastHeader;
  await sleep(1500);
  const { x, y } = { x: VIEWPORT.width / 2, y: VIEWPORT.height / 2 };
  await page.mouse.move(x, y);
  await page.mouse.down();
  const before = await state(page);
  const began = performance.now();
  let moving = null;
  for (let step = 0; performance.now() - began < DRAG_MILLIS; step += 1) {
    await page.mouse.move(x + 120 * Math.sin(step / 25), y + 20 * Math.sin(step / 40));
    await sleep(16);
    if (step % 20 === 10) moving = (await state(page)).lastHeader;
  }
  const after = await state(page);
  const fps = (after.framesPainted - before.framesPainted) / ((performance.now() - began) / 1000);
  await keepScreenshot(page, `drag-${preset}-moving`);
  await page.mouse.up();
  const stopped = performance.now();
  let full = null;
  while (performance.now() - stopped < REST_MILLIS) {
    const { lastHeader } = await state(page);
    if (lastHeader.width > moving.width && lastHeader.width >= VIEWPORT.width - 1) {
      full = performance.now() - stopped;
      break;
    }
    await sleep(50);
  }
  await keepScreenshot(page, `drag-${preset}-rest`);
  const latency = after.latency ?? { total: Number.NaN, p95: Number.NaN };
  const size = (header) => `${header.width}×${header.height}`;
  console.log(
    `${preset.padEnd(14)} first ${first.toFixed(0)} ms (${size(firstSize)}) · drag ${fps.toFixed(1)} fps at ${size(moving)}, ` +
      `input to paint ${latency.total.toFixed(0)}/${latency.p95.toFixed(0)} ms · full size ${full === null ? 'not' : full.toFixed(0)} ms after`,
  );
  await context.close();
}

const server = new Server();
await server.start();
const browser = await launch();
try {
  for (const preset of PRESETS) await measure(browser, server, preset);
} finally {
  await browser.close();
  await server.stop();
}
