// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The records on the graphics card: a texture of their rows, and one box for each of them.

import * as three from 'three';
import { arrayOf, type Message, type Reading, type RecordsHeader } from './messages';
import { RECORDS_A_ROW, TEXELS } from './shaders/records';
import { everywhereVertex, splatFragment, splatVertex } from './shaders/splat';
import { withoutVersion } from './surfaces';

const FLOATS = 4 * TEXELS;
const WEIGHTS: Record<Reading['weight'], number> = { tabellion: 0, ward: 1, 'split-sphere': 2 };

/** Switches of the page. */
export interface Switches {
  gradients: boolean;
  clearance: boolean;
}

export class Records {
  /** The rows, in the order of the records. */
  rows = new Float32Array(0);
  count = 0;
  reading: Reading | undefined;

  /** Adds (w E, w) of all records to a picture. */
  readonly splats: three.Scene;

  /** The same without their boxes: each record is evaluated at every pixel. */
  readonly everywhere: three.Scene;

  private readonly boxes = new three.InstancedBufferGeometry();
  private readonly triangles = new three.InstancedBufferGeometry();
  private readonly texture: three.DataTexture;
  readonly uniforms: Record<string, three.IUniform>;

  constructor(inputs: Record<string, three.IUniform>) {
    const box = new three.BoxGeometry(2, 2, 2);
    this.boxes.setIndex(box.index);
    this.boxes.setAttribute('position', box.getAttribute('position'));
    this.triangles.setAttribute('position', new three.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.boxes.instanceCount = this.triangles.instanceCount = 0;
    this.texture = this.makeTexture(1);
    this.uniforms = {
      ...inputs,
      records: { value: this.texture },
      weightKind: { value: 0 },
      relaxation: { value: 2 },
      tolerance: { value: 1 },
      rotationGradient: { value: true },
      translationGradient: { value: true },
      clearanceTest: { value: true },
      overlay: { value: 0 },
    };
    this.splats = this.makeScene(this.boxes, splatVertex, true);
    this.everywhere = this.makeScene(this.triangles, everywhereVertex, false);
  }

  /** Takes in a message: its records replace those of the same numbers, or are appended. */
  accept(message: Message<RecordsHeader>): void {
    const { first, count, reading } = message.header;
    const sent = arrayOf(message, 'rows').data as Float32Array;
    const capacity = RECORDS_A_ROW * Math.max(1, Math.ceil(count / RECORDS_A_ROW));
    if (this.rows.length < capacity * FLOATS) {
      const grown = new Float32Array(capacity * FLOATS);
      grown.set(this.rows);
      this.rows = grown;
      this.texture.dispose();
    }
    this.rows.set(sent, first * FLOATS);
    this.count = count;
    this.reading = reading;
    this.texture.image = {
      data: this.rows,
      width: RECORDS_A_ROW * TEXELS,
      height: this.rows.length / FLOATS / RECORDS_A_ROW,
    };
    this.texture.needsUpdate = true;
    this.boxes.instanceCount = this.triangles.instanceCount = count;
    this.set('weightKind', WEIGHTS[reading.weight]);
    this.set('relaxation', reading.relaxation);
    this.set('tolerance', reading.spacing);
  }

  switch(switches: Switches): void {
    this.set('rotationGradient', switches.gradients && (this.reading?.rotation_gradient ?? true));
    this.set('translationGradient', switches.gradients && (this.reading?.translation_gradient ?? true));
    this.set('clearanceTest', switches.clearance);
  }

  set(name: string, value: unknown): void {
    const uniform = this.uniforms[name];
    if (!uniform) throw new Error(`Splats have no uniform ${name}.`);
    uniform.value = value;
  }

  private makeScene(geometry: three.BufferGeometry, vertexShader: string, depthTest: boolean): three.Scene {
    const material = new three.RawShaderMaterial({
      glslVersion: three.GLSL3,
      vertexShader: withoutVersion(vertexShader),
      fragmentShader: withoutVersion(splatFragment),
      uniforms: this.uniforms,
      side: depthTest ? three.BackSide : three.DoubleSide,
      depthFunc: three.GreaterEqualDepth,
      depthTest,
      depthWrite: false,
      ...adding,
    });
    const mesh = new three.Mesh(geometry, material);
    mesh.frustumCulled = false;
    return new three.Scene().add(mesh);
  }

  private makeTexture(height: number): three.DataTexture {
    const width = RECORDS_A_ROW * TEXELS;
    const data = new Float32Array(width * height * 4);
    const texture = new three.DataTexture(data, width, height, three.RGBAFormat, three.FloatType);
    texture.needsUpdate = true;
    return texture;
  }
}

/** Adds colours to what is there. */
export const adding = {
  blending: three.CustomBlending,
  blendEquation: three.AddEquation,
  blendSrc: three.OneFactor,
  blendDst: three.OneFactor,
} as const;
