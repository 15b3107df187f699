// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Opens a page that shows `eclat view` in a frame, as a notebook does: node view-frame.mjs CHROMIUM URL > answer.json
// The answer is { title, records, shot, messages }: the title of the frame, the records of its page when its view is solved, a PNG of the frame, and what the pages said on their console.

import { inBrowser } from './browser.mjs';

const answer = await inBrowser(process.argv[2], async (page, messages) => {
  await page.setViewportSize({ width: 640, height: 480 });
  await page.goto(process.argv[3]);
  const element = page.locator('iframe');
  const frame = await (await element.elementHandle()).contentFrame();
  await frame.waitForFunction(() => window.eclatView || document.body.classList.contains('failed'));
  await frame.waitForFunction(() => window.eclatView.records > 0 && document.getElementById('live').hidden);
  return {
    title: await element.getAttribute('title'),
    records: await frame.evaluate(() => window.eclatView.records),
    shot: (await element.screenshot()).toString('base64'),
    messages,
  };
});
process.stdout.write(JSON.stringify(answer));
