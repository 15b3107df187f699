// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The images that passes draw into, and what the graphics card must be able to do.

import * as three from 'three';
import { MOST_PLANES } from './mirrors';

/** How sums are held: half floats where floats cannot be blended. docs/guides/view.md says what these cost. */
export type Precision = 'float' | 'half';

export function precisionOf(renderer: three.WebGLRenderer): Precision {
  return renderer.extensions.has('EXT_float_blend') ? 'float' : 'half';
}

/** Makes the context of a canvas. Throws an Error that says what the browser lacks. */
export function makeContext(canvas: HTMLCanvasElement): three.WebGLRenderer {
  const context = canvas.getContext('webgl2', { antialias: false, alpha: false, depth: false });
  if (!context) {
    throw new Error('This page needs WebGL 2, which this browser or its graphics driver does not offer.');
  }
  if (!context.getExtension('EXT_color_buffer_float')) {
    throw new Error('This page needs pictures of floats (EXT_color_buffer_float), which this graphics driver does not offer.');
  }
  const renderer = new three.WebGLRenderer({ canvas, context });
  renderer.outputColorSpace = three.LinearSRGBColorSpace; // the display pass encodes
  renderer.setPixelRatio(1);
  renderer.setClearColor(0, 0);
  renderer.autoClear = false;
  return renderer;
}

/** The images of one size. */
export class Targets {
  /** positions, normals, albedos, radiances; see shaders/surfaces.ts. The images of splats share another depth. */
  readonly surfaces: three.WebGLRenderTarget;
  /** The light of lamps. */
  readonly light: three.WebGLRenderTarget;
  /** The sums of ways from records, with their weights. */
  readonly ways: three.WebGLRenderTarget;
  /** The sums of splats to first order, and of what gradients change beside the mean way. */
  readonly splats: three.WebGLRenderTarget;
  /** The sums of splats of which half of the second is taken away. */
  readonly sums: three.WebGLRenderTarget;
  /** The sums of splats of radiance. */
  readonly glossSums: three.WebGLRenderTarget;
  /** The number of splats, for an overlay. */
  readonly counts: three.WebGLRenderTarget;
  /** The estimated errors, for an overlay. */
  readonly errors: three.WebGLRenderTarget;
  /** The linear picture before mirrors are added, and with them. */
  readonly base: three.WebGLRenderTarget;
  readonly picture: three.WebGLRenderTarget;
  /** The same as `surfaces` of the nearest glass, and the picture without it; missing where there is no glass. */
  readonly glass: three.WebGLRenderTarget | undefined;
  readonly behindGlass: three.WebGLRenderTarget | undefined;
  /** The pictures of mirrored eyes, with smaller ones of themselves. */
  readonly mirrors: readonly three.WebGLRenderTarget[];

  constructor(
    readonly width: number,
    readonly height: number,
    precision: Precision,
    glass = false,
  ) {
    const depthTexture = new three.DepthTexture(width, height, three.FloatType);
    const blended = precision === 'float' ? three.FloatType : three.HalfFloatType;
    const make = (type: three.TextureDataType, count = 1, depth = false) =>
      new three.WebGLRenderTarget(width, height, {
        count,
        type,
        format: three.RGBAFormat,
        minFilter: three.NearestFilter,
        magFilter: three.NearestFilter,
        depthBuffer: depth,
        ...(depth ? { depthTexture } : {}),
      });
    this.surfaces = ownDepth(width, height);
    this.glass = glass ? ownDepth(width, height) : undefined;
    this.behindGlass = glass ? make(three.FloatType) : undefined;
    this.light = make(blended);
    this.ways = make(blended, 1, true);
    this.splats = make(blended, 2, true);
    this.sums = make(three.FloatType);
    this.glossSums = make(blended, 1, true);
    this.counts = make(blended, 1, true);
    this.errors = make(three.FloatType);
    this.base = make(three.FloatType);
    this.picture = make(three.FloatType);
    this.mirrors = Array.from(
      { length: MOST_PLANES },
      () =>
        new three.WebGLRenderTarget(width, height, {
          type: three.HalfFloatType,
          format: three.RGBAFormat,
          minFilter: three.LinearMipmapLinearFilter,
          magFilter: three.LinearFilter,
          generateMipmaps: true,
          depthBuffer: false,
        }),
    );
  }

  dispose(): void {
    this.glass?.dispose();
    this.behindGlass?.dispose();
    const { surfaces, light, ways, splats, sums, glossSums, counts, errors, base, picture, mirrors } = this;
    for (const target of [surfaces, light, ways, splats, sums, glossSums, counts, errors, base, picture, ...mirrors]) target.dispose();
  }
}

/** Images of surfaces, with a depth of their own. */
function ownDepth(width: number, height: number): three.WebGLRenderTarget {
  return new three.WebGLRenderTarget(width, height, {
    count: 4,
    type: three.FloatType,
    format: three.RGBAFormat,
    minFilter: three.NearestFilter,
    magFilter: three.NearestFilter,
    depthBuffer: true,
  });
}

/** Reads an image (height, width, 4), the first row at the bottom: the one with that number, if the target has several. */
export function texelsOf(gl: three.WebGLRenderer, target: three.WebGLRenderTarget, number = 0): Float32Array {
  const { width, height } = target;
  const texels = target.texture.type === three.FloatType ? new Float32Array(width * height * 4) : new Uint16Array(width * height * 4);
  gl.readRenderTargetPixels(target, 0, 0, width, height, texels, undefined, number);
  return texels instanceof Float32Array ? texels : Float32Array.from(texels, (half) => three.DataUtils.fromHalfFloat(half));
}
