// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Asks the page of `eclat view` for the truth beside its picture: node view-truth.mjs CHROMIUM < request.json > answer.json
// The request is { page: URL, width, height, samples, steps }, with the size of the picture. Each step is { set, shot }: `set`
// maps labels of settings to what they become (a choice, a number of a slider, or whether a box is checked), `shot` asks for a PNG of
// the picture. The answer is { steps, messages }: after each step, when the truth has the samples, its figures, what the page tells, and
// the shot.

import { text } from 'node:stream/consumers';
import { inBrowser } from './browser.mjs';

const { page: url, width, height, samples, steps } = JSON.parse(await text(process.stdin));
const SHARE = 0.6; // of a narrow page's height is the picture, as style.css says

const answer = await inBrowser(process.argv[2], async (page, messages) => {
  await page.setViewportSize({ width, height: Math.round(height / SHARE) });
  await page.goto(url);
  await page.waitForFunction(() => window.eclatView || document.body.classList.contains('failed'));
  const done = [];
  for (const { set, shot } of steps) {
    for (const [label, value] of Object.entries(set)) {
      const control = page.getByLabel(label);
      if (typeof value === 'boolean') await control.setChecked(value);
      else if (typeof value === 'number') await control.fill(String(value));
      else await control.selectOption(value);
    }
    await page.waitForFunction(
      (samples) => window.eclatView.truth?.samples >= samples && window.eclatView.truth.pictures === 16,
      samples,
      { timeout: 300000 },
    );
    // What the page says of records that grow would cover a part of the picture.
    await page.waitForFunction(() => document.getElementById('live').hidden, undefined, { timeout: 200000 });
    const found = await page.evaluate(async () => {
      for (let i = 0; i < 3; ++i) await new Promise(requestAnimationFrame);
      return { figures: window.eclatView.truth, told: [...document.querySelectorAll('section p')].map((p) => p.textContent) };
    });
    if (shot) found.shot = (await page.locator('#picture').screenshot()).toString('base64');
    done.push(found);
  }
  return { steps: done, messages };
});
process.stdout.write(JSON.stringify(answer));
