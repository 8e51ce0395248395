/** Steering in the real page: no ordinary motion ends in the dark, and the dark explains itself. */

import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import {
  caughtUp,
  deviation,
  drag,
  keepScreenshot,
  launch,
  luminances,
  open,
  openPreset,
  state,
} from './support/page.mjs';
import { Server } from './support/server.mjs';

/** A drag of 240 pixels in a window 720 pixels high, in a smaller window. */
const WINDOW = { viewport: { width: 480, height: 270 } };
const ORDINARY_DRAG = (240 * WINDOW.viewport.height) / 720;

const MODES = {
  fogged_hall: 'look',
  light_shafts: 'look',
  cornell_fog: 'orbit',
  street_night: 'look',
  swinging_lamp: 'look',
  smoke_plume: 'orbit',
  cloud: 'orbit',
};

const server = new Server();
let browser;

before(async () => {
  await server.start();
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server.stop();
});

async function visit(body) {
  const { context, page, complaints } = await open(browser, server.url, WINDOW);
  try {
    await page.waitForFunction(() => window.__tyndall.mode !== null);
    await body(page);
    assert.deepEqual(complaints, [], 'the console is clean and nothing was missing');
  } catch (error) {
    await keepScreenshot(page, 'failure-navigation').catch(() => {});
    console.error(`server log:\n${server.tail()}`);
    throw error;
  } finally {
    await context.close();
  }
}

/** Share of the canvas that is nearly black; runs in the page. */
const nearBlack = () => {
  const small = document.createElement('canvas');
  [small.width, small.height] = [96, 54];
  const context = small.getContext('2d', { willReadFrequently: true });
  context.drawImage(document.getElementById('view'), 0, 0, small.width, small.height);
  const { data } = context.getImageData(0, 0, small.width, small.height);
  let dark = 0;
  for (let at = 0; at < data.length; at += 4) dark += Math.max(data[at], data[at + 1], data[at + 2]) <= 12;
  return dark / (data.length / 4);
};

/** Something is to be seen: the picture is neither black nor of one colour. */
async function assertSomethingToSee(page, what) {
  const picture = await luminances(page);
  const brightest = Math.max(...picture);
  assert.ok(brightest > 25, `${what}: the brightest place is ${brightest} of 255`);
  assert.ok(deviation(picture) > 2, `${what}: deviation ${deviation(picture)}`);
  assert.equal((await state(page)).darkness, null, what);
}

const wheel = async (page, notches) => {
  const { width, height } = WINDOW.viewport;
  await page.mouse.move(width / 2, height / 2);
  for (let notch = 0; notch < Math.abs(notches); notch += 1) {
    await page.mouse.wheel(0, notches > 0 ? -100 : 100);
  }
  // The wheel's motion fades within a second.
  await page.waitForTimeout(700);
  return caughtUp(page);
};

describe('steering', () => {
  it('leaves something to see after an ordinary drag in every preset', () =>
    visit(async (page) => {
      for (const [name, mode] of Object.entries(MODES)) {
        const opened = name === 'fogged_hall' ? await caughtUp(page) : await openPreset(page, name);
        assert.equal(opened.mode, mode, name);
        await drag(page, ORDINARY_DRAG, 0);
        await caughtUp(page);
        await assertSomethingToSee(page, `${name} after a drag to the right`);
        await drag(page, -2 * ORDINARY_DRAG, 0);
        await caughtUp(page);
        await assertSomethingToSee(page, `${name} after a drag to the left`);
      }
    }));

  it('switches modes by key and button, each of which turns in its way', () =>
    visit(async (page) => {
      const start = await caughtUp(page);
      assert.equal(start.mode, 'look');
      await page.keyboard.press('m');
      await page.waitForFunction(() => window.__tyndall.mode === 'orbit');
      // The pivot is what stands in the middle of the picture, on the line of sight.
      await page.waitForTimeout(300);
      const { camera } = await caughtUp(page);
      assert.deepEqual(camera.position, start.camera.position);
      await drag(page, 20, 0);
      const orbited = await caughtUp(page);
      assert.deepEqual(orbited.camera.target, camera.target);
      assert.notDeepEqual(orbited.camera.position, camera.position);
      await page.getByRole('button', { name: /^Orbit/ }).click();
      await page.waitForFunction(() => window.__tyndall.mode === 'fly');
    }));

  it('stops the wheel at a wall, and keys fly through it', () =>
    visit(async (page) => {
      const { navigation } = await caughtUp(page);
      const walked = await wheel(page, 200);
      for (const axis of [0, 1, 2]) {
        assert.ok(walked.camera.position[axis] > navigation.bounds.min[axis]);
        assert.ok(walked.camera.position[axis] < navigation.bounds.max[axis]);
      }
      await assertSomethingToSee(page, 'at the wall');
      await page.mouse.wheel(0, -300);
      await page.getByText('A surface is in the way.').waitFor();
      const still = await wheel(page, 3);
      const moved = Math.hypot(
        ...still.camera.position.map((value, axis) => value - walked.camera.position[axis]),
      );
      assert.ok(moved < 0.5, `pushed ${moved} m through the wall`);
      await page.locator('#view').focus();
      await page.keyboard.down('Shift');
      await page.keyboard.down('KeyW');
      await page.waitForFunction(
        (max) => window.__tyndall.camera.position[0] > max,
        navigation.bounds.max[0],
      );
      await page.keyboard.up('KeyW');
      await page.keyboard.up('Shift');
      await caughtUp(page);
    }));

  it('walks up to what is double-clicked, and turns about it in an orbit', () =>
    visit(async (page) => {
      const before = await caughtUp(page);
      await page.mouse.dblclick(240, 60);
      await page.waitForFunction(
        (from) =>
          Math.hypot(...window.__tyndall.camera.position.map((v, i) => v - from[i])) > 0.5,
        before.camera.position,
      );
      await page.waitForTimeout(500);
      await caughtUp(page);
      await assertSomethingToSee(page, 'after walking up');
      const { camera } = await openPreset(page, 'cornell_fog');
      await page.mouse.dblclick(240, 180);
      await page.waitForFunction(
        (target) => window.__tyndall.camera.target.some((v, i) => Math.abs(v - target[i]) > 0.05),
        camera.target,
      );
      await page.waitForTimeout(500);
      const turned = await caughtUp(page);
      assert.deepEqual(turned.camera.position, camera.position);
      await assertSomethingToSee(page, 'about another pivot');
    }));

  it('says within a second of rest why nearly everything is black, and stops where something is seen', () =>
    visit(async (page) => {
      await openPreset(page, 'cornell_fog');
      // Half a turn: behind the box, whose back nothing lights.
      for (let turn = 0; turn < 3; turn += 1) await drag(page, 100, 0);
      await page.waitForTimeout(300);
      const { darkness } = await caughtUp(page);
      const share = await page.evaluate(nearBlack);
      assert.ok(share > 0.95, `the back of the box: ${share} of it is near black`);
      if (darkness === null) await page.waitForFunction(() => window.__tyndall.darkness !== null, undefined, { timeout: 2000 });
      await page.getByRole('status').getByText(/^Nearly everything here is black: /).waitFor();
      for (let turn = 0; turn < 3; turn += 1) await drag(page, -100, 0);
      await page.waitForFunction(() => window.__tyndall.darkness === null);
      assert.equal(await page.locator('#unseen').isVisible(), false);
    }));

  it('says that a picture is too bright, and sets the exposure back', () =>
    visit(async (page) => {
      await caughtUp(page);
      const exposure = page.getByRole('slider', { name: 'Exposure' }).first();
      const own = await exposure.inputValue();
      await exposure.fill('8');
      await page.getByRole('status').getByText(/brighter than the page can show: exposure is \+8/).waitFor();
      await page.locator('#unseen').getByRole('button', { name: /^Set exposure/ }).click();
      await page.waitForFunction(() => !window.__tyndall.overexposed);
      assert.equal(await exposure.inputValue(), own);
      await exposure.fill('-8');
      await page.getByRole('status').getByText(/black: exposure is −8/).waitFor();
      await page.getByRole('button', { name: 'Reset density and exposure' }).click();
      await page.waitForFunction(() => window.__tyndall.darkness === null);
      await caughtUp(page);
      await assertSomethingToSee(page, 'with its own exposure');
    }));

  it('keeps density and exposure over a reload, and resets both', () =>
    visit(async (page) => {
      await caughtUp(page);
      const sliders = ['Density', 'Exposure'].map((name) => page.getByRole('slider', { name }).first());
      const values = () => Promise.all(sliders.map((slider) => slider.inputValue()));
      const own = await values();
      await sliders[0].fill('260');
      // The last edit may not even have left.
      await sliders[1].fill('1.5');
      const edited = await values();
      await page.reload();
      await page.waitForFunction(() => window.__tyndall?.framesPainted > 0);
      assert.deepEqual(await values(), edited);
      await caughtUp(page);
      await page.getByRole('button', { name: 'Reset density and exposure' }).click();
      assert.deepEqual(await values(), own);
      await caughtUp(page);
    }));

  it('says why the picture is black, and frames everything again', () =>
    visit(async (page) => {
      await openPreset(page, 'cornell_fog');
      for (let press = 0; press < 2; press += 1) await page.keyboard.press('m');
      await page.waitForFunction(() => window.__tyndall.mode === 'look');
      // Turns its back on the box.
      for (let turn = 0; turn < 4; turn += 1) await drag(page, 235, 0);
      await page.getByRole('status').getByText(/camera looks away|no light reaches/).waitFor();
      assert.notEqual((await state(page)).darkness, null);
      await page.locator('#unseen').getByRole('button', { name: 'Frame all' }).click();
      await page.waitForFunction(() => window.__tyndall.darkness === null);
      await page.waitForTimeout(600);
      await caughtUp(page);
      await assertSomethingToSee(page, 'everything framed');
    }));
});

describe('the drawers', () => {
  it('start closed and stay as they were left', () =>
    visit(async (page) => {
      const panel = page.locator('#panel');
      assert.equal(await panel.isVisible(), false);
      assert.equal(await page.locator('#overlay').isVisible(), false);
      await page.getByRole('button', { name: 'Controls', exact: true }).click();
      await page.reload();
      await page.waitForFunction(() => window.__tyndall?.framesPainted > 0);
      assert.equal(await panel.isVisible(), true);
    }));
});

describe('a server that asks for a token', () => {
  it('is told about with the way in, and lets the page in with it', async () => {
    // With everything that addresses give a meaning of their own.
    const token = 'a+b/c=&%25#';
    const guarded = new Server(['--token', token]);
    await guarded.start();
    const context = await browser.newContext(WINDOW);
    try {
      const page = await context.newPage();
      const [sockets, errors] = [[], []];
      page.on('websocket', (socket) => sockets.push(socket.url()));
      page.on('console', (message) => {
        if (message.type() === 'error') errors.push(message.text());
      });
      await page.goto(guarded.url);
      await page.getByText('This server asks for a token.').waitFor();
      await page.waitForTimeout(2000);
      assert.deepEqual(sockets, [], 'no socket before the server has let the page in');
      assert.ok(errors.length <= 1, `one request says it all: ${errors}`);
      assert.equal((await state(page)).connection, 'refused');
      await page.getByLabel('Token', { exact: true }).fill(token);
      await page.getByRole('button', { name: 'Connect' }).click();
      await page.waitForFunction(() => window.__tyndall?.framesPainted > 0, undefined, {
        timeout: 60_000,
      });
      assert.equal(await page.locator('#refused').isVisible(), false);
    } finally {
      await context.close();
      await guarded.stop();
    }
  });
});
