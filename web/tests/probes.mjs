// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance from probes by three.js' own formula: node probes.mjs < request.json > answer.json
// The request is { file, points, normals }; the answer is a list of [r, g, b].

import { readFileSync } from 'node:fs';
import { text } from 'node:stream/consumers';
import { LightProbe, Vector3 } from 'three';
import { EclatProbes } from '../eclat-probes.js';

const { file, points, normals } = JSON.parse(await text(process.stdin));
const probes = new EclatProbes(JSON.parse(readFileSync(file, 'utf8')));
const light = new LightProbe();
const answer = points.map((point, i) => {
  probes.at(new Vector3(...point), light.sh);
  return light.sh.getIrradianceAt(new Vector3(...normals[i]), new Vector3()).toArray();
});
process.stdout.write(JSON.stringify(answer));
