/** The page against the real binary: what a visitor does, in the order in which it gets harder. */

import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { violations } from './support/axe.mjs';
import {
  caughtUp,
  deviation,
  difference,
  drag,
  enter,
  keepScreenshot,
  launch,
  luminances,
  open,
  painted,
  reconnected,
  showControls,
  state,
} from './support/page.mjs';
import { Server } from './support/server.mjs';

const DESKTOP = { viewport: { width: 1440, height: 900 } };
const PHONE = {
  viewport: { width: 390, height: 844 },
  deviceScaleFactor: 2,
  hasTouch: true,
  isMobile: true,
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

/** A page of its own for `body`; afterwards the console must be clean. */
async function visit(options, body) {
  const { context, page, complaints } = await open(browser, server.url, options);
  try {
    await body(page);
    assert.deepEqual(complaints, [], 'the console is clean and nothing was missing');
  } catch (error) {
    await keepScreenshot(page, 'failure').catch(() => {});
    console.error(`server log:\n${server.tail()}`);
    throw error;
  } finally {
    await context.close();
  }
}

describe('the page', () => {
  it('paints a picture that is not uniform', () =>
    visit({}, async (page) => {
      // A coarse picture comes first; at rest it has a pixel for every one of the page.
      await page.waitForFunction(() => window.__tyndall.lastHeader?.width === 480);
      const { stats, lastHeader } = await caughtUp(page);
      assert.equal(stats.non_finite, 0);
      assert.equal(lastHeader.height, 300);
      const picture = await luminances(page);
      assert.ok(deviation(picture) > 4, `deviation ${deviation(picture)}`);
    }));

  it('shows another picture after a drag', () =>
    visit({}, async (page) => {
      const before = await caughtUp(page);
      const first = await luminances(page);
      await drag(page, 90, 25);
      const after = await caughtUp(page);
      assert.equal(after.mode, 'look');
      assert.notDeepEqual(after.camera.target, before.camera.target);
      assert.deepEqual(after.camera.position, before.camera.position);
      const changed = difference(first, await luminances(page));
      assert.ok(changed > 2, `mean difference ${changed}`);
      // The figures are refreshed four times a second.
      await page.waitForFunction(() => window.__tyndall.latency?.samples > 0);
    }));

  it('is steered by keys, and Home leads back', () =>
    visit({}, async (page) => {
      const start = (await caughtUp(page)).camera;
      await page.locator('#view').focus();
      await page.keyboard.down('KeyW');
      await page.waitForFunction(
        (z) => Math.hypot(...window.__tyndall.camera.position.map((v, i) => v - z[i])) > 0.3,
        start.position,
      );
      await page.keyboard.up('KeyW');
      await page.getByRole('button', { name: 'Home', exact: true }).click();
      await page.waitForFunction(
        (home) => window.__tyndall.camera.position.every((v, i) => Math.abs(v - home[i]) < 1e-9),
        start.position,
      );
      await caughtUp(page);
    }));

  it('lets less light through when σ grows, more when it falls', () =>
    visit({}, async (page) => {
      const before = (await caughtUp(page)).stats.mean_transmittance;
      await showControls(page);
      const slider = page.getByRole('slider', { name: 'Scattering σₛ' }).first();
      await slider.focus();
      for (let press = 0; press < 3; press += 1) await slider.press('PageUp');
      const thicker = (await caughtUp(page)).stats.mean_transmittance;
      assert.ok(thicker < before, `${before} should fall, became ${thicker}`);
      await enter(page, /^Scattering σₛ/, 0);
      await enter(page, /^Absorption σₐ/, 0);
      const clear = (await caughtUp(page)).stats.mean_transmittance;
      assert.ok(clear > before, `${before} should grow, became ${clear}`);
    }));

  it('names the path of a value that the server refuses, and takes it back', () =>
    visit({}, async (page) => {
      await caughtUp(page);
      await showControls(page);
      const input = page.getByRole('textbox', { name: /^Anisotropy g/ }).first();
      const good = await input.inputValue();
      await enter(page, /^Anisotropy g/, 7);
      await page.getByRole('alert').getByText('media[0].g').waitFor();
      await page.waitForFunction(
        ([value]) => document.querySelector('input[aria-label^="Anisotropy g, "]').value === value,
        [good],
      );
    }));

  it('opens another preset', () =>
    visit({}, async (page) => {
      const { sceneName, welcome, lastHeader } = await caughtUp(page);
      const first = await luminances(page);
      await showControls(page);
      const select = page.getByRole('combobox', { name: 'Preset' });
      const other = welcome.presets.at(-1);
      await select.selectOption({ label: other.title });
      await page.waitForFunction((name) => window.__tyndall.sceneName !== name, sceneName);
      const after = await caughtUp(page);
      assert.ok(after.lastHeader.epoch > lastHeader.epoch);
      assert.ok(difference(first, await luminances(page)) > 2);
      assert.match(await page.title(), new RegExp(other.title));
    }));

  it('goes on where it was after a reload', () =>
    visit({}, async (page) => {
      await caughtUp(page);
      await drag(page, 60, 10);
      const before = await caughtUp(page);
      await page.reload();
      await painted(page, 1);
      const after = await caughtUp(page);
      assert.equal(after.welcome.resumed, true);
      assert.deepEqual(after.camera, before.camera);
    }));

  it('resumes its session when the connection breaks', () =>
    visit({}, async (page) => {
      await caughtUp(page);
      await drag(page, -60, 10);
      const before = await caughtUp(page);
      await page.evaluate(() => window.__tyndall.drop());
      await reconnected(page, before.connections + 1);
      await painted(page, before.framesPainted + 1);
      const after = await caughtUp(page);
      assert.equal(after.welcome.resumed, true);
      assert.deepEqual(after.camera, before.camera);
    }));

  it('keeps two visitors apart', () =>
    visit({}, async (page) => {
      const before = await caughtUp(page);
      await visit({}, async (other) => {
        await caughtUp(other);
        await drag(other, 80, 0);
        await caughtUp(other);
        assert.notDeepEqual((await state(other)).camera, before.camera);
      });
      assert.deepEqual((await state(page)).camera, before.camera);
    }));
});

describe('the page for everyone', () => {
  it('looks right at a desk and breaks no accessibility rule', () =>
    visit(DESKTOP, async (page) => {
      await caughtUp(page);
      await drag(page, 30, 5);
      await caughtUp(page);
      await page.waitForTimeout(600);
      assert.deepEqual(await violations(page), []);
      await keepScreenshot(page, 'page-desktop');
    }));

  it('looks right on a phone and breaks no accessibility rule', () =>
    visit(PHONE, async (page) => {
      await caughtUp(page);
      await page.waitForTimeout(600);
      assert.deepEqual(await violations(page), []);
      await keepScreenshot(page, 'page-phone');
      await page.getByRole('button', { name: 'Controls', exact: true }).tap();
      await page.waitForTimeout(400);
      assert.deepEqual(await violations(page), []);
      await keepScreenshot(page, 'page-phone-controls');
      await page.getByRole('button', { name: 'Statistics', exact: true }).tap();
      await page.waitForTimeout(600);
      assert.deepEqual(await violations(page), []);
      await keepScreenshot(page, 'page-phone-statistics');
    }));
});

describe('a restarted server', () => {
  it('gets the page back, with its scene, camera and edits', async () => {
    const { context, page, complaints } = await open(browser, server.url);
    try {
      await caughtUp(page);
      await showControls(page);
      await enter(page, /^Scattering σₛ/, 3);
      await drag(page, 50, 0);
      const before = await caughtUp(page);
      const address = server.address;
      await server.stop();
      await page.waitForFunction(() => window.__tyndall.connection !== 'connected');
      await server.start(address);
      await reconnected(page, before.connections + 1);
      await painted(page, before.framesPainted + 1);
      await page.waitForFunction((input) => window.__tyndall.lastInput > input, before.lastInput);
      const after = await caughtUp(page);
      assert.equal(after.welcome.resumed, false);
      assert.deepEqual(after.camera, before.camera);
      const [was, is] = [before, after].map(({ stats }) => stats.mean_transmittance);
      assert.ok(Math.abs(was - is) < 0.02 + 0.1 * was, `transmittance ${was}, then ${is}`);
      // A browser reports every refused connection itself; nothing else may be said.
      const refused = /^WebSocket connection to|ERR_CONNECTION_REFUSED$/;
      const other = complaints.filter((text) => !refused.test(text));
      assert.deepEqual(other, []);
    } finally {
      await context.close();
    }
  });

  it('has not panicked and stops when asked', async () => {
    assert.equal(await server.stop(), 0);
    assert.doesNotMatch(server.log, /panicked| ERROR /);
  });
});
