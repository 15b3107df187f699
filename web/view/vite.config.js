// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Builds the page of `eclat view` into the Python package, where the wheel takes it from.

import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vite';

export default defineConfig({
  base: './',
  build: {
    outDir: fileURLToPath(new URL('../../python/eclat/viewer/page', import.meta.url)),
    emptyOutDir: true,
    target: 'es2022',
    chunkSizeWarningLimit: 1000,
    // The policy of the server allows no inlined data, and no script beside the page's own.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
  },
});
