// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Uses the page of `eclat view` as people do: node view-access.mjs CHROMIUM URL > answer.json
// The answer has what axe-core finds in light and dark and on a narrow screen, how the keys and the pointer move the camera, touches and full screen,
// which elements the tab key reaches, the flags that are copied, and what a page without WebGL 2 shows.

import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { inBrowser } from './browser.mjs';

const axe = await readFile(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const url = process.argv[3];

async function violations(page) {
  await page.evaluate(axe);
  const found = await page.evaluate(() => window.axe.run());
  return found.violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.html).join(' ')}`);
}

const ready = (page) => page.waitForFunction(() => window.eclatView || document.body.classList.contains('failed'));

/** Touches of the page by fingers at places. */
async function touches(page) {
  const client = await page.context().newCDPSession(page);
  const touch = (type, places) =>
    client.send('Input.dispatchTouchEvent', { type, touchPoints: places.map(([x, y], id) => ({ x, y, id })) });
  return { client, touch };
}

const answer = await inBrowser(process.argv[2], async (page, messages) => {
  await page.setViewportSize({ width: 480, height: 360 });
  await page.goto(url);
  await ready(page);
  const result = { violations: {}, tabs: [] };
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme });
    result.violations[colorScheme] = await violations(page);
  }
  await page.setViewportSize({ width: 320, height: 480 });
  result.violations.narrow = await violations(page);
  await page.setViewportSize({ width: 480, height: 360 });

  const copy = page.getByRole('button', { name: 'Copy camera as flags' });
  const flags = async () => {
    const told = page.locator('section p[role=status]').first();
    // What was copied before must not be read again.
    await told.evaluate((p) => { p.textContent = ''; });
    await copy.click();
    await told.filter({ hasText: '--camera-from' }).waitFor();
    return (await told.textContent()).replace('Copied: ', '');
  };
  result.flags = { begin: await flags() };
  await page.locator('#picture').focus();
  // Frames of software WebGL may take long, and keys move the eye once a frame.
  const frames = () => page.evaluate(async () => {
    for (let i = 0; i < 3; ++i) await new Promise(requestAnimationFrame);
  });
  await page.keyboard.down('KeyW');
  await page.waitForTimeout(400);
  await frames();
  await page.keyboard.up('KeyW');
  result.flags.walked = await flags();
  // The upper left corner of the picture may hold messages.
  const { x, y, width, height } = await page.locator('#picture').boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 + 40, y + height / 2 + 10);
  await frames();
  await page.mouse.up();
  result.flags.turned = await flags();
  // Choosing the same camera again is no change; another choice comes before it.
  const back = () => page.getByLabel('Camera of the scene').evaluate((select) => select.dispatchEvent(new Event('change')));
  await back();
  result.flags.back = await flags();
  // One finger turns, two fingers that part go forward.
  const { client, touch } = await touches(page);
  const [left, top] = [x + width / 2, y + height / 2];
  await touch('touchStart', [[left, top]]);
  await touch('touchMove', [[left + 40, top]]);
  await frames();
  await touch('touchEnd', []);
  result.flags.touched = await flags();
  await back();
  await touch('touchStart', [[left - 20, top], [left + 20, top]]);
  await touch('touchMove', [[left - 60, top], [left + 60, top]]);
  await frames();
  await touch('touchEnd', []);
  result.flags.pinched = await flags();
  await client.detach();
  await back();

  const full = page.getByRole('button', { name: 'Full screen' });
  result.full = [];
  for (const wanted of [true, false]) {
    await full.click();
    await page.waitForFunction((wanted) => (document.fullscreenElement !== null) === wanted, wanted);
    result.full.push(await page.evaluate(() => document.fullscreenElement?.tagName ?? null));
  }

  await page.locator('#picture').focus();
  for (let i = 0; i < 13; ++i) {
    result.tabs.push(await page.evaluate(() => {
      const { activeElement } = document;
      return activeElement.labels?.[0]?.firstChild.textContent ?? (activeElement.id || activeElement.textContent);
    }));
    await page.keyboard.press('Tab');
  }
  const download = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Save screenshot' }).click();
  result.screenshot = (await readFile(await (await download).path())).toString('base64');

  await page.addInitScript(() => {
    const getContext = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind === 'webgl2' ? null : getContext.call(this, kind, ...rest);
    };
  });
  await page.reload();
  await ready(page);
  result.without = await page.locator('#message').textContent();
  result.violations.without = await violations(page);
  return { ...result, messages };
});
process.stdout.write(JSON.stringify(answer));
