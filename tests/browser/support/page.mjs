/** Real Chromium, and what a test wants to know about the page in it. */

import { existsSync, mkdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const CHROMIUM = [
  process.env.CHROMIUM,
  '/usr/bin/chromium',
  '/usr/bin/chromium-browser',
  '/usr/bin/google-chrome',
].find((path) => path !== undefined && existsSync(path));

/** A software renderer in a debug build, beside a busy browser: patience is cheap. */
const PATIENCE = { timeout: 60_000 };

export function launch() {
  if (CHROMIUM === undefined) {
    throw new Error('no Chromium found: install it or set CHROMIUM to its path');
  }
  return chromium.launch({
    executablePath: CHROMIUM,
    args: [
      '--headless',
      '--no-sandbox',
      '--disable-gpu',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  });
}

/** Opens the page and waits for a first picture. `complaints` collects what must stay empty. */
export async function open(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 480, height: 300 }, ...options });
  const page = await context.newPage();
  const complaints = [];
  page.on('console', (message) => {
    if (['warning', 'error'].includes(message.type())) complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error.stack ?? error)));
  page.on('response', (response) => {
    if (response.status() >= 400) complaints.push(`${response.status()} ${response.url()}`);
  });
  page.on('request', (request) => {
    if (!request.url().startsWith(new URL(url).origin)) complaints.push(`asked ${request.url()}`);
  });
  await page.goto(url);
  await painted(page, 1);
  return { context, page, complaints };
}

export const state = (page) => page.evaluate(() => ({ ...window.__tyndall, drop: undefined }));

/** Waits until at least `count` pictures were painted since the page was opened. */
export function painted(page, count) {
  return page.waitForFunction((n) => window.__tyndall?.framesPainted >= n, count, PATIENCE);
}

/** Waits until the picture on screen shows everything sent, and its statistics are there. */
export async function caughtUp(page) {
  // One animation frame for what the controls queued, one for what that sent.
  await page.evaluate(
    () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
  );
  await page.waitForFunction(
    () => {
      const { lastHeader, lastInput, stats, connection } = window.__tyndall;
      return (
        connection === 'connected' &&
        lastHeader !== null &&
        lastHeader.appliedInput >= lastInput &&
        stats !== null &&
        stats.frame >= lastHeader.frame
      );
    },
    undefined,
    PATIENCE,
  );
  return state(page);
}

export function reconnected(page, connections) {
  return page.waitForFunction(
    (n) => window.__tyndall.connections >= n && window.__tyndall.connection === 'connected',
    connections,
    PATIENCE,
  );
}

/** The picture on the canvas as 48 × 30 luminances in 0 to 255, read back from its pixels. */
export function luminances(page) {
  return page.evaluate(() => {
    const small = document.createElement('canvas');
    small.width = 48;
    small.height = 30;
    const context = small.getContext('2d', { willReadFrequently: true });
    context.drawImage(document.getElementById('view'), 0, 0, small.width, small.height);
    const { data } = context.getImageData(0, 0, small.width, small.height);
    const values = [];
    for (let at = 0; at < data.length; at += 4) {
      values.push(0.2126 * data[at] + 0.7152 * data[at + 1] + 0.0722 * data[at + 2]);
    }
    return values;
  });
}

export function mean(values) {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}

export function deviation(values) {
  const centre = mean(values);
  return Math.sqrt(mean(values.map((value) => (value - centre) ** 2)));
}

/** Mean absolute difference, in steps of 255. */
export function difference(a, b) {
  return mean(a.map((value, index) => Math.abs(value - b[index])));
}

/** Drags over the part of the picture that no card covers. */
export async function drag(page, dx, dy) {
  const { width, height } = page.viewportSize();
  const [x, y] = [width * 0.5, height * 0.35];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let step = 1; step <= 8; step += 1) {
    await page.mouse.move(x + (dx * step) / 8, y + (dy * step) / 8);
  }
  await page.mouse.up();
}

/** Opens a preset and waits until its picture is there and its way of steering is known. */
export async function openPreset(page, name) {
  const select = page.getByRole('combobox', { name: 'Scene', exact: true });
  const { epoch } = (await state(page)).lastHeader;
  await select.selectOption(name);
  await page.waitForFunction(
    (old) => window.__tyndall.mode !== null && window.__tyndall.lastHeader.epoch > old,
    epoch,
    PATIENCE,
  );
  return caughtUp(page);
}

/** Opens the drawer with the controls where the window is too narrow to show it always. */
export async function showControls(page) {
  const button = page.getByRole('button', { name: 'Controls', exact: true });
  if ((await button.getAttribute('aria-expanded')) === 'false') await button.click();
}

/** Types a number into a row of the controls. */
export async function enter(page, label, value) {
  const input = page.getByRole('textbox', { name: label }).first();
  await input.fill(String(value));
  await input.press('Enter');
}

/** Screenshots are kept for people to look at. */
export async function keepScreenshot(page, name) {
  const folder = fileURLToPath(new URL('../../artefacts/', import.meta.url));
  mkdirSync(folder, { recursive: true });
  await page.screenshot({ path: `${folder}${name}.png` });
}
