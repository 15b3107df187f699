// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Asks the page of `eclat view` for pictures and sums of records: node view.mjs CHROMIUM < request.json > answer.json
// The request is { page: URL, pictures: [{ camera, width, height, look, work }], points, normals, looks, shot, halves }: float32 arrays in base64,
// or no points, the looks with which sums are asked for, and
// whether the graphics card shall blend no floats. The answer is { pictures, work, seconds, sums, errors, shot, result, records,
// precision, message, messages, requests }: linear pictures, for those with `work` its counts and the seconds of a picture, sums of
// each look, one after another, and estimated errors at the first 2000 points, as float32 in base64; a PNG of the page if a shot was asked for; the global variable that the shot names
// as its `result`; what the page shows instead of a picture; what it said on its console; and the addresses that it asked for.

import { text } from 'node:stream/consumers';
import { inBrowser } from './browser.mjs';

const { page: url, pictures = [], points, normals, looks = [{}], shot, halves } = JSON.parse(await text(process.stdin));

const answer = await inBrowser(process.argv[2], async (page, messages) => {
  const requests = [];
  page.on('request', (request) => requests.push(request.url()));
  // What the page itself draws meanwhile is small, because software WebGL is slow.
  await page.setViewportSize(shot ? { width: shot.width, height: shot.height } : { width: 480, height: 120 });
  if (halves) {
    await page.addInitScript(() => {
      const { getExtension } = WebGL2RenderingContext.prototype;
      WebGL2RenderingContext.prototype.getExtension = function (name) {
        return name === 'EXT_float_blend' ? null : getExtension.call(this, name);
      };
    });
  }
  await page.goto(url);
  await page.waitForFunction(() => window.eclatView || document.body.classList.contains('failed'));
  const message = await page.evaluate(() => document.getElementById('message').textContent);
  const found = message
    ? {}
    : await page.evaluate(
        ({ pictures, points, normals, looks }) => {
          const encoded = (floats) => {
            const bytes = new Uint8Array(floats.buffer, floats.byteOffset, floats.byteLength);
            let binary = '';
            for (let i = 0; i < bytes.length; i += 32768) binary += String.fromCharCode(...bytes.subarray(i, i + 32768));
            return btoa(binary);
          };
          const decoded = (base64) => new Float32Array(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer);
          const { eclatView } = window;
          return {
            pictures: pictures.map((p) => encoded(eclatView.linear(p.camera, p.width, p.height, p.look))),
            sums: points && looks.map((look) => encoded(eclatView.sums(decoded(points), decoded(normals), look))),
            errors: points && encoded(eclatView.errors(decoded(points).subarray(0, 6000), decoded(normals).subarray(0, 6000))),
            work: pictures.map((p) => p.work && eclatView.work(p.camera, p.width, p.height)),
            seconds: pictures.map((p) => {
              if (!p.work) return undefined;
              const before = performance.now();
              eclatView.linear(p.camera, p.width, p.height);
              return (performance.now() - before) / 1000;
            }),
            records: eclatView.records,
            precision: eclatView.precision,
          };
        },
        { pictures, points, normals, looks },
      );
  if (shot) {
    if (shot.script) await page.evaluate(shot.script);
    await page.waitForTimeout(shot.wait ?? 500);
    found.shot = (await page.screenshot()).toString('base64');
    if (shot.result) found.result = await page.evaluate((name) => window[name], shot.result);
  }
  return { ...found, message, messages, requests };
});
process.stdout.write(JSON.stringify(answer));
