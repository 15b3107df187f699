// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

import { chromium } from 'playwright-core';

/**
 * Runs `work(page, messages)` in headless Chromium, with what the page says on its console in `messages`. The process ends
 * with code 3 where the browser does not start.
 */
export async function inBrowser(executablePath, work) {
  // SwiftShader draws where there is no graphics card, the same on all machines.
  const args = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
  const browser = await chromium.launch({ executablePath, args }).catch((error) => {
    console.error(error.message);
    process.exit(3);
  });
  const messages = [];
  try {
    const page = await browser.newPage();
    page.setDefaultTimeout(100000); // software WebGL on a busy machine takes its time
    page.on('console', (message) => {
      // Reading pixels waits for the picture, of which the driver warns; a page that measures its own picture must.
      if (!message.text().includes('GPU stall due to ReadPixels')) messages.push(`${message.type()}: ${message.text()}`);
    });
    page.on('pageerror', (error) => messages.push(`error: ${error.message}`));
    return await work(page, messages).catch((error) => {
      throw new Error([error.message, ...messages].join('\n'));
    });
  } finally {
    await browser.close();
  }
}
