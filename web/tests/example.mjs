// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Looks at example.html with each of its lights: node example.mjs CHROMIUM URL > answer.json
// The answer is { shown, messages }: by light, what the page tells instead of a scene ("" where it shows one) and a PNG of
// it in base64; and what it said on its console.

import { inBrowser } from './browser.mjs';

const [executable, url] = process.argv.slice(2);

const answer = await inBrowser(executable, async (page, messages) => {
  await page.setViewportSize({ width: 640, height: 360 });
  await page.goto(url);
  const shown = {};
  for (const light of ['exr', 'embedded', 'none']) {
    await page.check(`input[value=${light}]`);
    await page.waitForFunction(() => document.querySelector('output').textContent !== 'loading …');
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const message = await page.textContent('output');
    shown[light] = { message, png: (await page.screenshot()).toString('base64') };
  }
  return { shown, messages };
});
process.stdout.write(JSON.stringify(answer));
