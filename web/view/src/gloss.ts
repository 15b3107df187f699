// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The records of radiance on the graphics card: images of what each reflects, made once, and the pass that draws the splats.

import * as three from 'three';
import { screenPass } from './lamps';
import { arrayOf, type GlossHeader, type Message, type Reading } from './messages';
import { boxes, readingUniforms, readingValues, setUniforms, splatScene, type Switches, type Uniforms } from './records';
import { FLOATS, Rows } from './rows';
import { glossFragment, prefilterFragment, TILES_A_ROW } from './shaders/gloss';
import { splatVertex } from './shaders/splat';

/** Floats of a row before the index of the lobe. */
const LOBE = 50;

/** The largest width of a texture of coefficients. */
const WIDTH = 4096;

export class Gloss {
  readonly rows = new Rows();
  readonly splats: three.Scene;

  private reading: Reading | undefined;
  private readonly boxes = boxes();
  private readonly uniforms: Uniforms;
  private images: three.WebGLRenderTarget | undefined;

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

  /** Takes in a message, which has all records of radiance. */
  accept(renderer: three.WebGLRenderer, message: Message<GlossHeader>): void {
    const { count, reading, grid } = message.header;
    this.reading = reading;
    this.boxes.instanceCount = count;
    this.images?.dispose();
    if (count === 0) return;
    const rows = (arrayOf(message, 'rows').data as Float32Array).slice();
    arrayOf(message, 'lobe_of').data.forEach((lobe, i) => (rows[i * FLOATS + LOBE] = lobe));
    this.rows.set(rows, 0, count);
    this.images = this.filtered(renderer, message);
    const [values, alongU, alongV] = this.images.textures;
    setUniforms(this.uniforms, { values, alongU, alongV, grid });
  }

  switch(switches: Switches): void {
    if (!this.reading) return;
    // As RadianceCache::relaxed_reach of the core: radiance is read half as far beyond the radius as irradiance.
    const farthest = 0.5 * (1 + this.reading.relaxation);
    setUniforms(this.uniforms, readingValues(this.reading, switches, farthest));
  }

  private filtered(renderer: three.WebGLRenderer, message: Message<GlossHeader>): three.WebGLRenderTarget {
    const { count, order, grid } = message.header;
    const order2 = order * order;
    const recordsARow = Math.floor(WIDTH / (3 * order2));
    const wide = recordsARow * 3 * order2;
    const texels = new Float32Array(4 * wide * Math.ceil(count / recordsARow));
    texels.set(arrayOf(message, 'coefficients').data as Float32Array);
    const lobes = arrayOf(message, 'lobes');
    const target = new three.WebGLRenderTarget(TILES_A_ROW * grid, Math.ceil(count / TILES_A_ROW) * grid, {
      count: 3,
      type: three.HalfFloatType,
      format: three.RGBAFormat,
      minFilter: three.LinearFilter,
      magFilter: three.LinearFilter,
      depthBuffer: false,
    });
    const inputs = [floats(texels, wide), floats(lobes.data as Float32Array, order2 + 1)];
    const pass = screenPass(prefilterFragment, {
      records: { value: this.rows.texture },
      coefficients: { value: inputs[0] },
      lobes: { value: inputs[1] },
      count: { value: count },
      order2: { value: order2 },
      grid: { value: grid },
      recordsARow: { value: recordsARow },
    });
    renderer.setRenderTarget(target);
    renderer.clear(true, false, false);
    renderer.render(pass, new three.Camera());
    inputs.forEach((texture) => texture.dispose());
    return target;
  }
}

function floats(values: Float32Array, width: number): three.DataTexture {
  const copy = new Float32Array(values);
  const texture = new three.DataTexture(copy, width, values.length / 4 / width, three.RGBAFormat, three.FloatType);
  texture.needsUpdate = true;
  return texture;
}
