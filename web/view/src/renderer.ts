// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The passes of a picture: surfaces, lamps, splats, division, display.

import * as three from 'three';
import { Lamps, screenPass } from './lamps';
import { Gloss } from './gloss';
import type { GlossHeader, LightHeader, Message, RecordsHeader, SceneHeader } from './messages';
import { Records } from './records';
import { displayFragment } from './shaders/display';
import { divideFragment } from './shaders/screen';
import { makeContext, precisionOf, Targets, type Precision } from './targets';
import { floatTexture, makeSurfaces, makeView, type ShadowView, type Surfaces, type View } from './surfaces';
import type { Pose } from './pose';
import type { Beside } from './truth';

export type ToneMapping = 'none' | 'filmic' | 'agx';
export type Overlay = 'none' | 'weights' | 'density' | 'left-out' | 'records';

/** What the picture shows. */
export interface Look {
  exposure: number;
  toneMapping: ToneMapping;
  overlay: Overlay;
  direct: boolean;
  indirect: boolean;
  gradients: boolean;
  clearance: boolean;
  /** Where the picture of the server begins beside that of the page, as a share of the width from the left. */
  wipe: number;
  /** Whether the difference of both is shown instead of them. */
  difference: boolean;
}

export const USUAL_LOOK: Look = {
  exposure: 0,
  toneMapping: 'none',
  overlay: 'none',
  direct: true,
  indirect: true,
  gradients: true,
  clearance: true,
  wipe: 0.5,
  difference: false,
};

const TONE_MAPPINGS: Record<ToneMapping, number> = { none: 0, filmic: 1, agx: 2 };
const OVERLAYS: Record<Overlay, number> = { none: 0, weights: 1, density: 2, 'left-out': 3, records: 4 };

export class Renderer {
  readonly precision: Precision;
  readonly surfaces: Surfaces;
  readonly records: Records;
  private readonly gloss: Gloss;

  private readonly lamps: Lamps;
  private readonly camera = new three.Camera();
  private readonly inputs: Record<string, three.IUniform>;
  private readonly dividing: Record<string, three.IUniform>;
  private readonly displaying: Record<string, three.IUniform>;
  private readonly divide: three.Scene;
  private readonly display: three.Scene;
  private targets: Targets;

  private constructor(
    private readonly gl: three.WebGLRenderer,
    scene: Message<SceneHeader>,
    surfaces: Surfaces,
    private readonly view: View,
    lamp: ShadowView,
  ) {
    this.precision = precisionOf(gl);
    this.surfaces = surfaces;
    this.targets = new Targets(1, 1, this.precision);
    this.inputs = Object.fromEntries(
      ['positions', 'normals', 'albedos', 'radiances', 'lampLight', 'sums', 'glossSums', 'counts', 'picture'].map((name) => [name, { value: null }]),
    );
    this.records = new Records({ ...this.inputs, ...view });
    this.gloss = new Gloss({ ...this.inputs, ...view });
    this.lamps = new Lamps(gl, scene.header.lights, surfaces, lamp, this.inputs);
    const { sky } = scene.header;
    this.dividing = {
      ...this.inputs,
      eye: view.eye,
      sky: { value: sky ? floatTexture(scene, sky.array) : null },
      hasSky: { value: sky !== null },
      skyFromWorld: { value: new three.Matrix3().fromArray(sky?.to_world ?? [1, 0, 0, 0, 1, 0, 0, 0, 1]) },
      worldFromScreen: { value: new three.Matrix4() },
      size: { value: new three.Vector2() },
      showDirect: { value: true },
      showIndirect: { value: true },
    };
    this.displaying = {
      ...this.inputs,
      toneMapping: { value: 0 },
      overlay: { value: 0 },
      scale: { value: 1 },
      toneMappingExposure: { value: 1 },
      comparing: { value: false },
      pagePicture: { value: null },
      truth: { value: null },
      wipe: { value: 0 },
      showDifference: { value: false },
      differenceFloor: { value: 0 },
    };
    this.divide = screenPass(divideFragment, this.dividing);
    this.display = screenPass(displayFragment, this.displaying);
  }

  /** Builds everything that is drawn. Throws an Error where WebGL 2 or floats as targets are missing. */
  static async create(
    canvas: HTMLCanvasElement,
    scene: Message<SceneHeader>,
    light: Message<LightHeader>,
  ): Promise<Renderer> {
    const gl = makeContext(canvas);
    const view = makeView();
    const lamp = { ...makeView(), sunDirection: { value: new three.Vector3() } };
    const surfaces = await makeSurfaces(scene, light, view, lamp);
    return new Renderer(gl, scene, surfaces, view, lamp);
  }

  acceptRecords(message: Message<RecordsHeader>): void {
    this.records.accept(message);
  }

  /**
   * Returns the share of a small picture in which matte surfaces lack records. It draws into the images of the picture, which
   * must be drawn anew.
   */
  missing(pose: Pose, aspect: number): number {
    const [width, height] = [96, Math.max(1, Math.round(96 / aspect))];
    this.drawLinear(pose, USUAL_LOOK, width, height);
    const sums = this.read(this.targets.sums, width, height);
    const albedos = new Float32Array(sums.length);
    this.gl.readRenderTargetPixels(this.targets.surfaces, 0, 0, width, height, albedos, undefined, 2);
    let missing = 0;
    for (let i = 0; i < sums.length; i += 4) {
      const matte = Math.max(albedos[i] ?? 0, albedos[i + 1] ?? 0, albedos[i + 2] ?? 0) > 0;
      if (matte && !((sums[i + 3] ?? 0) > 0)) ++missing;
    }
    return missing / (width * height);
  }

  acceptGloss(message: Message<GlossHeader>): void {
    this.gloss.accept(this.gl, message);
  }

  /** Draws the picture into the canvas, beside the server's if there is one. */
  draw(pose: Pose, look: Look, width: number, height: number, beside?: Beside): void {
    this.gl.setSize(width, height, false);
    this.drawLinear(pose, look, width, height);
    this.set(this.displaying, 'toneMapping', TONE_MAPPINGS[look.toneMapping]);
    this.set(this.displaying, 'overlay', OVERLAYS[look.overlay]);
    this.set(this.displaying, 'scale', 2 ** look.exposure);
    this.set(this.displaying, 'toneMappingExposure', 2 ** look.exposure);
    this.set(this.displaying, 'comparing', beside !== undefined);
    this.set(this.displaying, 'pagePicture', beside?.page ?? null);
    this.set(this.displaying, 'truth', beside?.truth ?? null);
    this.set(this.displaying, 'differenceFloor', beside?.floor ?? 0);
    this.set(this.displaying, 'wipe', look.wipe * width);
    this.set(this.displaying, 'showDifference', look.difference);
    this.gl.setRenderTarget(null);
    this.gl.render(this.display, this.camera);
  }

  /** Draws the picture and returns its linear radiance (height, width, 4), the first row at the bottom. */
  readLinear(pose: Pose, look: Look, width: number, height: number): Float32Array {
    this.drawLinear(pose, look, width, height);
    return this.read(this.targets.picture, width, height);
  }

  /** Returns the positions and normals (height, width, 4) of the picture that was drawn last, the first row at the bottom. */
  readSurfaces(width: number, height: number): [Float32Array, Float32Array] {
    return [0, 1].map((image) => {
      const texels = new Float32Array(width * height * 4);
      this.gl.readRenderTargetPixels(this.targets.surfaces, 0, 0, width, height, texels, undefined, image);
      return texels;
    }) as [Float32Array, Float32Array];
  }

  /** Returns the sums (height, width, 4) of (w E, w) over the records at points with normals, (height · width, 3) each. */
  readRecords(points: Float32Array, normals: Float32Array, width: number, height: number): Float32Array {
    const targets = new Targets(width, height, this.precision);
    const texture = (values: Float32Array, fill: number) => {
      const data = new Float32Array(width * height * 4).fill(fill);
      for (let i = 0; i < width * height; ++i) data.set(values.subarray(3 * i, 3 * i + 3), 4 * i);
      const made = new three.DataTexture(data, width, height, three.RGBAFormat, three.FloatType);
      made.needsUpdate = true;
      return made;
    };
    this.set(this.inputs, 'positions', texture(points, 1));
    this.set(this.inputs, 'normals', texture(normals, 0));
    this.set(this.inputs, 'albedos', texture(normals, -1));
    this.records.switch(USUAL_LOOK);
    this.gl.setRenderTarget(targets.sums);
    this.gl.clear(true, false, false);
    this.gl.render(this.records.everywhere, this.camera);
    const sums = this.read(targets.sums, width, height);
    targets.dispose();
    return sums;
  }

  /** The place that the picture shows at a pixel, counted from its bottom left, or nothing. */
  placeAt(x: number, y: number): three.Vector3 | undefined {
    const texel = new Float32Array(4);
    this.gl.readRenderTargetPixels(this.targets.surfaces, x, y, 1, 1, texel, undefined, 0);
    return texel[3] ? new three.Vector3().fromArray(texel) : undefined;
  }

  private drawLinear(pose: Pose, look: Look, width: number, height: number): void {
    this.resize(width, height);
    const aspect = width / height;
    this.view.viewProjection.value.copy(pose.viewProjection(aspect));
    this.view.eye.value.copy(pose.eye());
    this.records.switch(look);
    this.gloss.switch(look);
    this.bind();
    const { gl, targets } = this;
    gl.setRenderTarget(targets.surfaces);
    gl.clear();
    gl.render(this.surfaces.seen, this.camera);
    gl.setRenderTarget(targets.light);
    gl.clear(true, false, false);
    for (const pass of this.lamps.passes) gl.render(pass, this.camera);
    gl.setRenderTarget(targets.sums);
    gl.clear(true, false, false);
    gl.render(this.records.splats, this.camera);
    gl.setRenderTarget(targets.glossSums);
    gl.clear(true, false, false);
    gl.render(this.gloss.splats, this.camera);
    if (look.overlay === 'density' || look.overlay === 'records') {
      const pixelAngle = (2 * pose.extent(aspect)[1]) / height;
      this.records.switch(look, look.overlay === 'density' ? 'count' : 'outlines', pixelAngle);
      gl.setRenderTarget(targets.counts);
      gl.clear(true, false, false);
      gl.render(this.records.splats, this.camera);
    }
    this.set(this.dividing, 'showDirect', look.direct);
    this.set(this.dividing, 'showIndirect', look.indirect);
    (this.dividing['worldFromScreen']?.value as three.Matrix4).copy(this.view.viewProjection.value).invert();
    (this.dividing['size']?.value as three.Vector2).set(width, height);
    gl.setRenderTarget(targets.picture);
    gl.render(this.divide, this.camera);
  }

  private resize(width: number, height: number): void {
    if (this.targets.width === width && this.targets.height === height) return;
    this.targets.dispose();
    this.targets = new Targets(width, height, this.precision);
  }

  private bind(): void {
    const { surfaces, light, sums, glossSums, counts, picture } = this.targets;
    ['positions', 'normals', 'albedos', 'radiances'].forEach((name, i) => this.set(this.inputs, name, surfaces.textures[i]));
    this.set(this.inputs, 'lampLight', light.texture);
    this.set(this.inputs, 'sums', sums.texture);
    this.set(this.inputs, 'glossSums', glossSums.texture);
    this.set(this.inputs, 'counts', counts.texture);
    this.set(this.inputs, 'picture', picture.texture);
  }

  private set(uniforms: Record<string, three.IUniform>, name: string, value: unknown): void {
    const uniform = uniforms[name];
    if (uniform) uniform.value = value;
  }

  private read(target: three.WebGLRenderTarget, width: number, height: number): Float32Array {
    if (target.texture.type === three.FloatType) {
      const pixels = new Float32Array(width * height * 4);
      this.gl.readRenderTargetPixels(target, 0, 0, width, height, pixels);
      return pixels;
    }
    const halves = new Uint16Array(width * height * 4);
    this.gl.readRenderTargetPixels(target, 0, 0, width, height, halves);
    return Float32Array.from(halves, (half) => three.DataUtils.fromHalfFloat(half));
  }
}
