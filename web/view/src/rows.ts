// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Rows of records in a texture, which grows with them.

import * as three from 'three';
import { RECORDS_A_ROW, TEXELS } from './shaders/records';

export const FLOATS = 4 * TEXELS;

/** Returns the number of the row whose ellipse of `reach` radii holds a place most closely to its middle, or −1. */
export function nearestRow({ values, count }: Rows, reach: number, place: three.Vector3): number {
  let [best, least] = [-1, reach];
  const [d, stretch, normal] = [new three.Vector3(), new three.Vector3(), new three.Vector3()];
  for (let i = 0; i < count; ++i) {
    const at = i * FLOATS;
    const radius = values[at + 3] ?? 0;
    d.fromArray(values, at).sub(place);
    const off = Math.abs(d.dot(normal.fromArray(values, at + 4)));
    const share = Math.sqrt(Math.max(0, d.lengthSq() - d.dot(stretch.fromArray(values, at + 8)) ** 2)) / radius;
    if (share < least && off < 0.1 * radius + 0.2 * d.length()) [best, least] = [i, share];
  }
  return best;
}

export class Rows {
  values = new Float32Array(RECORDS_A_ROW * FLOATS);
  count = 0;
  readonly texture: three.DataTexture;

  constructor() {
    this.texture = new three.DataTexture(this.values, RECORDS_A_ROW * TEXELS, 1, three.RGBAFormat, three.FloatType);
    this.texture.needsUpdate = true;
  }

  /** Sets the rows from `first` on; there are `count` of them then. */
  set(rows: Float32Array, first: number, count: number): void {
    const capacity = RECORDS_A_ROW * Math.max(1, Math.ceil(count / RECORDS_A_ROW));
    if (this.values.length < capacity * FLOATS) {
      const grown = new Float32Array(capacity * FLOATS);
      grown.set(this.values);
      this.values = grown;
      this.texture.dispose(); // a texture on the graphics card has one size
    }
    this.values.set(rows, first * FLOATS);
    this.count = count;
    this.texture.image = {
      data: this.values,
      width: RECORDS_A_ROW * TEXELS,
      height: this.values.length / FLOATS / RECORDS_A_ROW,
    };
    this.texture.needsUpdate = true;
  }
}
