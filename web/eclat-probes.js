// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

/**
 * Probes that `eclat probes` writes, in three.js: the light around a point, for what moves.
 *
 *     const probes = await EclatProbes.load('room.probes.json');
 *     const light = new LightProbe();
 *     scene.add(light);
 *     probes.at(object.position, light.sh); // whenever the object has moved
 *
 * A probe holds the coefficients of incident radiance in the order and with the constants of three.js, whose shader makes
 * irradiance E of them and reflects albedo / π · E: no factor of π appears here.
 */

import { FileLoader, SphericalHarmonics3 } from 'three';

const FORMAT = 'eclat-probes';
const VERSION = 1;
const NUMBERS = 27; // nine coefficients of R, G and B

export class EclatProbes {
  /** @param {object} file what the JSON file holds */
  constructor(file) {
    if (file?.format !== FORMAT) throw new Error(`EclatProbes: expected a file of the format ${FORMAT}`);
    if (file.version !== VERSION) {
      throw new Error(`EclatProbes: expected version ${VERSION} of the format, got ${file.version}`);
    }
    const [x, y, z] = file.counts;
    if (file.coefficients.length !== x * y * z || file.coefficients.some((row) => row.length !== NUMBERS)) {
      throw new Error(`EclatProbes: expected ${x * y * z} probes of ${NUMBERS} numbers`);
    }
    this.counts = file.counts;
    this.origin = file.origin; // position of the first probe in metres
    this.spacing = file.spacing; // in metres
    this.inside = new Set(file.inside); // the probes in solids, which hold the light of their neighbours
    this.unit = file.unit;
    this.coefficients = Float32Array.from(file.coefficients.flat());
    this.corner = new SphericalHarmonics3();
  }

  /** Reads the file at `url`. */
  static async load(url) {
    return new EclatProbes(JSON.parse(await new FileLoader().loadAsync(url)));
  }

  /** The coefficients of probe (x, y, z) in `target`. */
  probe(x, y, z, target = new SphericalHarmonics3()) {
    const index = x + this.counts[0] * (y + this.counts[1] * z);
    return target.fromArray(this.coefficients, index * NUMBERS);
  }

  /**
   * The coefficients at `position`, {x, y, z} in metres, trilinearly between the eight probes around it; outside of the
   * grid those of its border.
   */
  at(position, target = new SphericalHarmonics3()) {
    const low = [];
    const part = [];
    for (const [axis, name] of ['x', 'y', 'z'].entries()) {
      const last = this.counts[axis] - 1;
      const step = this.spacing[axis] > 0 ? (position[name] - this.origin[axis]) / this.spacing[axis] : 0;
      const inside = Math.min(Math.max(step, 0), last);
      low[axis] = Math.min(Math.floor(inside), Math.max(last - 1, 0));
      part[axis] = inside - low[axis];
    }
    target.zero();
    for (let i = 0; i < 8; ++i) {
      const up = [i & 1, (i >> 1) & 1, i >> 2];
      const weight = up.reduce((product, one, axis) => product * (one ? part[axis] : 1 - part[axis]), 1);
      if (weight === 0) continue; // also what lies beyond the last probe
      const [x, y, z] = low.map((first, axis) => first + up[axis]);
      target.add(this.probe(x, y, z, this.corner).scale(weight));
    }
    return target;
  }
}
