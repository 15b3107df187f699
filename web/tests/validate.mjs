// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Khronos' glTF validator: node validate.mjs FILE… > answer.json, an object of each file's issues.

import { readFile } from 'node:fs/promises';
import { validateBytes } from 'gltf-validator';

const answer = {};
for (const file of process.argv.slice(2)) {
  const report = await validateBytes(new Uint8Array(await readFile(file)), { maxIssues: 0 });
  answer[file] = report.issues.messages;
}
process.stdout.write(JSON.stringify(answer));
