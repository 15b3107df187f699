// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The records of radiance on the graphics card: images of what each reflects, made when it comes, and the pass that draws the
// splats. Another order of harmonics makes all images anew.

import * as three from 'three';
import { screenPass } from './lamps';
import { arrayOf, type GlossHeader, type Message, type Reading } from './messages';
import { boxes, readingUniforms, readingValues, setUniforms, splatScene, type Switches, type Uniforms } from './records';
import { FLOATS, nearestRow, Rows } from './rows';
import { glossFragment, prefilterFragment, TILES_A_ROW } from './shaders/gloss';
import { splatVertex } from './shaders/splat';

/** Float of a row that holds the index of the lobe, where records of irradiance have their noise. */
const LOBE = 49;

/** The largest width of a texture of coefficients. */
const WIDTH = 4096;

/** Records whose coefficients are on the graphics card at once. */
const AT_ONCE = 4096;

/** Switches of records of radiance. */
export interface GlossSwitches extends Switches {
  order: number;
}

export class Gloss {
  readonly rows = new Rows();
  readonly splats: three.Scene;
  /** The order of the expansion; 0 where there are no records of radiance. */
  order = 0;

  private reading: Reading | undefined;
  private grid = 1;
  private coefficients = new Float32Array(0);
  private lobes = new Float32Array(0);
  private readonly boxes = boxes();
  private readonly uniforms: Uniforms;
  private images: three.WebGLRenderTarget | undefined;
  private capacity = 0;
  /** What of the images is not as the records and the order say: from the first to before the last record. */
  private stale: [number, number] = [0, 0];
  private shownOrder = 0;

  constructor(inputs: Uniforms) {
    this.uniforms = {
      ...inputs,
      ...readingUniforms(this.rows),
      values: { value: null },
      alongU: { value: null },
      alongV: { value: null },
      grid: { value: 1 },
    };
    this.splats = splatScene(this.boxes, splatVertex, glossFragment, this.uniforms);
  }

  get count(): number {
    return this.rows.count;
  }

  /** Takes in a message: its records replace those of the same numbers, or are appended. */
  accept(message: Message<GlossHeader>): void {
    const { first, count, reading, grid, order } = message.header;
    this.reading = reading;
    this.order = order;
    if (count === 0) return;
    this.grid = grid;
    const rows = (arrayOf(message, 'rows').data as Float32Array).slice();
    arrayOf(message, 'lobe_of').data.forEach((lobe, i) => (rows[i * FLOATS + LOBE] = lobe));
    this.rows.set(rows, first, count);
    this.boxes.instanceCount = count;
    const coefficients = arrayOf(message, 'coefficients').data as Float32Array;
    const size = this.floatsOfARecord();
    if (this.coefficients.length < count * size) {
      const grown = new Float32Array(Math.max(count * size, 2 * this.coefficients.length));
      grown.set(this.coefficients);
      this.coefficients = grown;
    }
    this.coefficients.set(coefficients, first * size);
    const lobes = arrayOf(message, 'lobes').data as Float32Array;
    if (lobes.length > 0) this.lobes = lobes.slice();
    const last = first + rows.length / FLOATS;
    const [from, to] = this.stale;
    this.stale = from < to ? [Math.min(from, first), Math.max(to, last)] : [first, last];
  }

  /** The number of the record whose ellipse holds a place most closely to its middle, or −1. */
  nearest(place: three.Vector3): number {
    return nearestRow(this.rows, this.reading?.relaxation ?? 1, place);
  }

  /** The coefficients (3, order², 4) of a record: values, and derivatives along u and v. */
  coefficientsOf(record: number): Float32Array {
    const size = this.floatsOfARecord();
    return this.coefficients.subarray(record * size, (record + 1) * size);
  }

  /** Has all images made anew: they depend on `lightScale`. */
  remake(): void {
    this.stale = [0, this.count];
  }

  switch(renderer: three.WebGLRenderer, switches: GlossSwitches): void {
    if (!this.reading) return;
    // As RadianceCache::relaxed_reach of the core: radiance is read half as far beyond the radius as irradiance.
    const farthest = 0.5 * (1 + this.reading.relaxation);
    setUniforms(this.uniforms, readingValues(this.reading, switches, farthest));
    const order = Math.min(this.order, switches.order);
    if (order !== this.shownOrder) this.stale = [0, this.count];
    this.shownOrder = order;
    this.filter(renderer);
  }

  private floatsOfARecord(): number {
    return 3 * this.order ** 2 * 4;
  }

  /** Makes the images that are stale. */
  private filter(renderer: three.WebGLRenderer): void {
    if (this.count > this.capacity) {
      this.images?.dispose();
      this.capacity = TILES_A_ROW * Math.ceil((1.5 * this.count) / TILES_A_ROW);
      this.images = imagesOf(this.capacity, this.grid);
      this.stale = [0, this.count];
    }
    const [from, to] = this.stale;
    this.stale = [0, 0];
    if (!this.images || from >= to) return;
    const lobes = floats(this.lobes, this.order ** 2 + 1);
    const before = renderer.getRenderTarget();
    renderer.setRenderTarget(this.images);
    for (let first = from; first < to; first += AT_ONCE) this.filterSome(renderer, first, Math.min(AT_ONCE, to - first), lobes);
    renderer.setRenderTarget(before);
    lobes.dispose();
    const [values, alongU, alongV] = this.images.textures;
    setUniforms(this.uniforms, { values, alongU, alongV, grid: this.grid });
  }

  private filterSome(renderer: three.WebGLRenderer, first: number, count: number, lobes: three.DataTexture): void {
    const order2 = this.order ** 2;
    const recordsARow = Math.floor(WIDTH / (3 * order2));
    const wide = recordsARow * 3 * order2;
    const texels = new Float32Array(4 * wide * Math.ceil(count / recordsARow));
    const size = this.floatsOfARecord();
    texels.set(this.coefficients.subarray(first * size, (first + count) * size));
    const coefficients = floats(texels, wide);
    const pass = screenPass(prefilterFragment, {
      records: { value: this.rows.texture },
      coefficients: { value: coefficients },
      lobes: { value: lobes },
      first: { value: first },
      count: { value: count },
      order2: { value: order2 },
      shownOrder2: { value: this.shownOrder ** 2 },
      grid: { value: this.grid },
      recordsARow: { value: recordsARow },
      lightScale: this.uniforms['lightScale']!,
    });
    renderer.render(pass, new three.Camera());
    coefficients.dispose();
  }
}

/** Makes the images of so many records. */
function imagesOf(records: number, grid: number): three.WebGLRenderTarget {
  return new three.WebGLRenderTarget(TILES_A_ROW * grid, Math.ceil(records / TILES_A_ROW) * grid, {
    count: 3,
    type: three.HalfFloatType,
    format: three.RGBAFormat,
    minFilter: three.LinearFilter,
    magFilter: three.LinearFilter,
    depthBuffer: false,
  });
}

function floats(values: Float32Array, width: number): three.DataTexture {
  const copy = new Float32Array(values);
  const texture = new three.DataTexture(copy, width, values.length / 4 / width, three.RGBAFormat, three.FloatType);
  texture.needsUpdate = true;
  return texture;
}
