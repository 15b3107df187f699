// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Opens the page of `eclat view` and waits until its records have grown: node view-live.mjs CHROMIUM < request.json > answer.json
// The request is { page: URL, width, height, shot }; the answer { begun, records, radiance, told, message, messages, requests, picture,
// shot }: the numbers of records at first and in the end, what the page told on the way, the linear picture of the first camera
// as float32 in base64, and a PNG of the page if a shot was asked for.

import { text } from 'node:stream/consumers';
import { inBrowser } from './browser.mjs';

const { page: url, width, height, shot } = JSON.parse(await text(process.stdin));

const answer = await inBrowser(process.argv[2], async (page, messages) => {
  const requests = [];
  page.on('request', (request) => requests.push(request.url()));
  await page.setViewportSize({ width: 640, height: 360 });
  // All that the page tells is kept, because it may tell it for less than the time between two looks.
  await page.addInitScript(() => {
    window.told = [];
    document.addEventListener('DOMContentLoaded', () => {
      const live = document.getElementById('live');
      const keep = () => live.hidden || window.told.push(live.textContent);
      new MutationObserver(keep).observe(live, { attributes: true, characterData: true, childList: true, subtree: true });
      keep();
    });
  });
  await page.goto(url);
  await page.waitForFunction(() => window.eclatView || document.body.classList.contains('failed'));
  const begun = await page.evaluate(() => window.eclatView?.records);
  const grown = () => window.told.length > 0 && document.getElementById('live').hidden;
  await page.waitForFunction(grown, undefined, { timeout: 150000 });
  const told = await page.evaluate(() => window.told);
  const found = await page.evaluate(
    ({ width, height }) => {
      const pixels = window.eclatView.linear(0, width, height);
      const bytes = new Uint8Array(pixels.buffer, pixels.byteOffset, pixels.byteLength);
      let binary = '';
      for (let i = 0; i < bytes.length; i += 32768) binary += String.fromCharCode(...bytes.subarray(i, i + 32768));
      return {
        picture: btoa(binary),
        records: window.eclatView.records,
        radiance: window.eclatView.radianceRecords,
        message: document.getElementById('message').textContent,
      };
    },
    { width, height },
  );
  if (shot) found.shot = (await page.screenshot()).toString('base64');
  return { ...found, begun, told, messages, requests };
});
process.stdout.write(JSON.stringify(answer));
