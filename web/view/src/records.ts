// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The records of irradiance on the graphics card, and the pass that draws a splat for each of them.

import * as three from 'three';
import { arrayOf, type Message, type Reading, type RecordsHeader } from './messages';
import { FLOATS, nearestRow, Rows } from './rows';
import { everywhereVertex, splatFragment, splatVertex } from './shaders/splat';
import { withoutVersion } from './surfaces';

const WEIGHTS: Record<Reading['weight'], number> = { tabellion: 0, ward: 1, 'split-sphere': 2 };

/** What splats add, by the numbers of `overlay` in shaders/splat.ts. */
const ADDED = ['light', 'count', 'outlines', 'fragments', 'clearance', 'noise', 'ways', 'errors'] as const;

/** Switches of the page. */
export interface Switches {
  gradients: boolean;
  clearance: boolean;
  clamping: boolean;
  weight: Weighting;
}

/** By which weight records are read: that with which they were solved, or another. */
export type Weighting = 'solved' | Reading['weight'];

export type Uniforms = Record<string, three.IUniform>;

/** The uniforms of `reading` in shaders/records.ts. */
export function readingUniforms(rows: Rows): Uniforms {
  return {
    records: { value: rows.texture },
    weightKind: { value: 0 },
    relaxation: { value: 2 },
    tolerance: { value: 1 },
    rotationGradient: { value: true },
    translationGradient: { value: true },
    clearanceTest: { value: true },
    neighborClamping: { value: true },
  };
}

export function setUniforms(uniforms: Uniforms, values: Readonly<Record<string, unknown>>): void {
  for (const [name, value] of Object.entries(values)) {
    const uniform = uniforms[name];
    if (!uniform) throw new Error(`There is no uniform ${name}.`);
    uniform.value = value;
  }
}

/** The values of these uniforms. `relaxation` is how much farther than their radii records are read at most. */
export function readingValues(reading: Reading, switches: Switches, relaxation: number): Record<string, unknown> {
  return {
    weightKind: WEIGHTS[switches.weight === 'solved' ? reading.weight : switches.weight],
    relaxation,
    tolerance: reading.spacing,
    rotationGradient: switches.gradients && reading.rotation_gradient,
    translationGradient: switches.gradients && reading.translation_gradient,
    clearanceTest: switches.clearance,
    neighborClamping: switches.clamping,
  };
}

export class Records {
  readonly rows = new Rows();
  reading: Reading | undefined;

  /** Adds (w E, w) of all records to a picture, and in a second one what gradients change beside the mean way. */
  readonly splats: three.Scene;

  /** The same without their boxes: each record is evaluated at every pixel. */
  readonly everywhere: three.Scene;

  private readonly boxes = boxes();
  private readonly triangles = new three.InstancedBufferGeometry();
  private readonly uniforms: Uniforms;

  constructor(inputs: Uniforms) {
    this.triangles.setAttribute('position', new three.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.triangles.instanceCount = 0;
    this.uniforms = { ...inputs, ...readingUniforms(this.rows), overlay: { value: 0 }, pixelAngle: { value: 1 } };
    this.splats = splatScene(this.boxes, splatVertex, splatFragment, this.uniforms);
    this.everywhere = splatScene(this.triangles, everywhereVertex, splatFragment, this.uniforms, false);
  }

  get count(): number {
    return this.rows.count;
  }

  /** The mean luminance of the irradiance of all records. */
  get meanLuminance(): number {
    const { values, count } = this.rows;
    let sum = 0;
    for (let i = 12; i < count * FLOATS; i += FLOATS) {
      sum += 0.2126 * (values[i] ?? 0) + 0.7152 * (values[i + 1] ?? 0) + 0.0722 * (values[i + 2] ?? 0);
    }
    return count > 0 ? sum / count : 0;
  }

  /** Takes in a message: its records replace those of the same numbers, or are appended. */
  accept(message: Message<RecordsHeader>): void {
    const { first, count, reading } = message.header;
    this.rows.set(arrayOf(message, 'rows').data as Float32Array, first, count);
    this.reading = reading;
    this.boxes.instanceCount = this.triangles.instanceCount = count;
  }

  /**
   * Sets how the records are read, and what splats add: their light, the number that serve a pixel, outlines of that width at distance 1, the number
   * of fragments, values of the records with their weights, the ways from them, or what their estimated error consists of.
   */
  switch(switches: Switches, adds: (typeof ADDED)[number] = 'light', pixelAngle = 1): void {
    if (!this.reading) return;
    setUniforms(this.uniforms, readingValues(this.reading, switches, this.reading.relaxation));
    setUniforms(this.uniforms, { overlay: ADDED.indexOf(adds), pixelAngle });
  }

  /** The number of the record whose ellipse holds a place most closely to its middle, or −1. */
  nearest(place: three.Vector3): number {
    return nearestRow(this.rows, this.reading?.relaxation ?? 1, place);
  }
}

/** A box for each record. */
export function boxes(): three.InstancedBufferGeometry {
  const box = new three.BoxGeometry(2, 2, 2);
  const geometry = new three.InstancedBufferGeometry();
  geometry.setIndex(box.index);
  geometry.setAttribute('position', box.getAttribute('position'));
  geometry.instanceCount = 0;
  return geometry;
}

/** A pass that draws splats. Boxes are drawn by their far sides, where these lie behind the surface that is seen. */
export function splatScene(
  geometry: three.BufferGeometry,
  vertexShader: string,
  fragmentShader: string,
  uniforms: Uniforms,
  depthTest = true,
): three.Scene {
  const material = new three.RawShaderMaterial({
    glslVersion: three.GLSL3,
    vertexShader: withoutVersion(vertexShader),
    fragmentShader: withoutVersion(fragmentShader),
    uniforms,
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

/** Adds colours to what is there. */
export const adding = {
  blending: three.CustomBlending,
  blendEquation: three.AddEquation,
  blendSrc: three.OneFactor,
  blendDst: three.OneFactor,
} as const;
