// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Renders baked files: node render.mjs CHROMIUM < request.json > answer.json
// The request is { page: URL of page.html, jobs: [see there] }; the answer { results, messages }: one result a job
// (what page.html returns, or { error }), and what the page said on its console.

import { text } from 'node:stream/consumers';
import { inBrowser } from './browser.mjs';

const { page: url, jobs } = JSON.parse(await text(process.stdin));

const answer = await inBrowser(process.argv[2], async (page, messages) => {
  await page.goto(url);
  await page.waitForFunction(() => window.renderRadiance);
  const results = [];
  for (const job of jobs) {
    results.push(await page.evaluate((j) => window.renderRadiance(j).catch((e) => ({ error: e.message })), job));
  }
  return { results, messages };
});
process.stdout.write(JSON.stringify(answer));
