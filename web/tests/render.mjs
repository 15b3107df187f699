// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Renders baked files in headless Chromium: node render.mjs CHROMIUM < request.json > answer.json
// The request is { page: URL of page.html, jobs: [see there] }; the answer { results, messages }: one result a job
// (what page.html returns, or { error }), and what the page said on its console. Code 3: the browser does not start.

import { text } from 'node:stream/consumers';
import { chromium } from 'playwright-core';

const { page: url, jobs } = JSON.parse(await text(process.stdin));

// SwiftShader draws where there is no graphics card, the same on all machines.
const args = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const browser = await chromium.launch({ executablePath: process.argv[2], args }).catch((error) => {
  console.error(error.message);
  process.exit(3);
});
const results = [];
const messages = [];
try {
  const page = await browser.newPage();
  page.on('console', (message) => messages.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => messages.push(`error: ${error.message}`));
  await page.goto(url);
  await page.waitForFunction(() => window.renderRadiance, null, { timeout: 30_000 }).catch((error) => {
    throw new Error(`${url} did not start: ${error.message}\n${messages.join('\n')}`);
  });
  for (const job of jobs) {
    results.push(await page.evaluate((j) => window.renderRadiance(j).catch((e) => ({ error: e.message })), job));
  }
} finally {
  await browser.close();
}
process.stdout.write(JSON.stringify({ results, messages }));
