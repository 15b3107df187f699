// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The passes of a picture: surfaces, lamps, splats, division, display.

import * as three from 'three';
import { depthPass, Lamps, screenPass } from './lamps';
import { Gloss } from './gloss';
import type { GlossHeader, LightHeader, Message, RecordsHeader, SceneHeader } from './messages';
import { OVERLAYS, TONE_MAPPINGS, USUAL_LOOK, type Look } from './look';
import { Records } from './records';
import { displayFragment } from './shaders/display';
import { errorFragment, unbendFragment } from './shaders/splat';
import { depthFragment, divideFragment } from './shaders/screen';
import { makeContext, precisionOf, Targets, texelsOf, type Precision } from './targets';
import { shareWithoutRecords } from './missing';
import { chosenPlanes, reflection, type Plane } from './mirrors';
import { mirrorsFragment } from './shaders/mirrors';
import { floatTexture, makeSurfaces, makeView, NO_CLIP, type ShadowView, type Surfaces, type View } from './surfaces';
import type { Pose } from './pose';
import type { Beside } from './truth';

/** The images of what mirrors, in the order of the geometry pass. */
const MIRROR_IMAGES = ['mirrorPositions', 'mirrorNormals', 'mirrorAlbedos', 'mirrorRadiances'];

/** What splats add for the overlays that need a pass of their own. */
const COUNTED = { density: 'count', records: 'outlines', clearance: 'clearance', noise: 'noise', error: 'errors' } as const;

export class Renderer {
  readonly precision: Precision;
  readonly surfaces: Surfaces;
  readonly records: Records;
  readonly gloss: Gloss;

  private readonly lamps: Lamps;
  private readonly camera = new three.Camera();
  private readonly inputs: Record<string, three.IUniform>;
  private readonly dividing: Record<string, three.IUniform>;
  private readonly displaying: Record<string, three.IUniform>;
  private readonly mirroring: Record<string, three.IUniform>;
  private readonly unbending: Record<string, three.IUniform>;
  private readonly unbend: three.Scene;
  /** What the light in sums is multiplied with, a power of 2: their mean is about 1 then. Set when the first records come. */
  private readonly lightScale = { value: 1 };
  private readonly estimating: Record<string, three.IUniform>;
  private readonly estimate: three.Scene;
  private readonly setDepths: three.Scene;
  private readonly divide: three.Scene;
  private readonly mirror: three.Scene;
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
      ['positions', 'normals', 'albedos', 'radiances', 'lampLight', 'ways', 'sums', 'glossSums', 'counts', 'picture'].map((name) => [name, { value: null }]),
    );
    this.inputs['lightScale'] = this.lightScale;
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
    const { hasSky, sky: skyImage, skyFromWorld, size, showIndirect } = this.dividing;
    this.mirroring = {
      ...this.inputs,
      ...view,
      picture: { value: null }, // without mirrors, unlike that of the inputs
      hasSky: hasSky!, sky: skyImage!, skyFromWorld: skyFromWorld!, size: size!, showIndirect: showIndirect!,
      glass: { value: false },
      ...Object.fromEntries(MIRROR_IMAGES.map((name) => [name, { value: null }])),
      alphas: { value: surfaces.alphas },
      mirror0: { value: null },
      mirror1: { value: null },
      plane0: { value: new three.Vector4() },
      plane1: { value: new three.Vector4() },
      planes: { value: 0 },
      diagonal: { value: surfaces.bounds.getSize(new three.Vector3()).length() },
      pixelAngle: { value: 1 },
    };
    this.displaying = {
      ...this.inputs,
      toneMapping: { value: 0 },
      errors: { value: null },
      overlay: { value: 0 },
      scale: { value: 1 },
      toneMappingExposure: { value: 1 },
      diagonal: { value: 1 },
      comparing: { value: false },
      pagePicture: { value: null },
      truth: { value: null },
      wipe: { value: 0 },
      showDifference: { value: false },
      differenceFloor: { value: 0 },
    };
    this.estimating = { counts: { value: null }, sums: { value: null }, meanLuminance: { value: 0 }, lightScale: this.lightScale };
    this.unbending = { firstOrder: { value: null }, bendings: { value: null }, lightScale: this.lightScale };
    this.unbend = screenPass(unbendFragment, this.unbending);
    this.setDepths = depthPass(depthFragment, { positions: this.inputs['positions']!, viewProjection: view.viewProjection });
    this.estimate = screenPass(errorFragment, this.estimating);
    this.divide = screenPass(divideFragment, this.dividing);
    this.mirror = screenPass(mirrorsFragment, this.mirroring);
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
    const mean = this.lightScale.value === 1 ? this.records.meanLuminance : 0;
    if (mean > 0) {
      this.lightScale.value = 2 ** -Math.round(Math.log2(mean));
      this.gloss.remake();
    }
  }

  /**
   * Returns the share of a small picture in which surfaces lack records: matte ones, and those whose gloss records of radiance may
   * hold. It draws into the images of the picture, which must be drawn anew.
   */
  missing(pose: Pose, aspect: number): number {
    const [width, height] = [96, Math.max(1, Math.round(96 / aspect))];
    this.drawLinear(pose, USUAL_LOOK, width, height);
    const [sums, glossSums] = [this.targets.sums, this.targets.glossSums].map((target) => texelsOf(this.gl, target));
    const [positions, normals, albedos] = [0, 1, 2].map((number) => texelsOf(this.gl, this.targets.surfaces, number));
    if (!sums || !glossSums || !positions || !normals || !albedos) return 0;
    const images = { positions, normals, albedos, sums, glossSums };
    return shareWithoutRecords(images, pose.eye(), this.gloss.order > 0, this.surfaces.roughness);
  }

  acceptGloss(message: Message<GlossHeader>): void {
    this.gloss.accept(message);
  }

  /** Draws the picture into the canvas, beside the server's if there is one. */
  draw(pose: Pose, look: Look, width: number, height: number, beside?: Beside): void {
    this.gl.setSize(width, height, false);
    this.drawLinear(pose, look, width, height);
    this.set(this.displaying, 'diagonal', pose.diagonal);
    this.set(this.displaying, 'toneMapping', TONE_MAPPINGS[look.toneMapping]);
    this.set(this.displaying, 'overlay', OVERLAYS[look.overlay]);
    this.set(this.displaying, 'errors', this.targets.errors.texture);
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
    return texelsOf(this.gl, this.targets.picture);
  }

  /** Counts, for a picture, the fragments of splats and those of them that serve their pixel, both per pixel. */
  work(pose: Pose, width: number, height: number): { fragments: number; serving: number } {
    const mean = (adds: 'fragments' | 'count') => {
      this.drawLinear(pose, USUAL_LOOK, width, height);
      this.records.switch(USUAL_LOOK, adds);
      this.drawSplats(this.records.splats, this.targets.counts);
      const texels = texelsOf(this.gl, this.targets.counts);
      let sum = 0;
      for (let i = 0; i < texels.length; i += 4) sum += texels[i] ?? 0;
      return sum / (width * height);
    };
    return { fragments: mean('fragments'), serving: mean('count') };
  }

  /** Returns the positions and normals (height, width, 4) of the picture that was drawn last, the first row at the bottom. */
  readSurfaces(): [Float32Array, Float32Array] {
    return [texelsOf(this.gl, this.targets.surfaces), texelsOf(this.gl, this.targets.surfaces, 1)];
  }

  /** Returns the sums (height, width, 4) of (w E, w) over the records at points with normals, (height · width, 3) each. */
  readRecords(points: Float32Array, normals: Float32Array, width: number, height: number, look = USUAL_LOOK): Float32Array {
    return this.atPoints(points, normals, width, height, (targets) => {
      this.sumRecords(this.records.everywhere, look, targets);
      return texelsOf(this.gl, targets.sums);
    });
  }

  /** Returns at such points the estimated error relative to the irradiance there, and 1, or zeros where no record serves (height, width, 4). */
  readErrors(points: Float32Array, normals: Float32Array, width: number, height: number, look = USUAL_LOOK): Float32Array {
    return this.atPoints(points, normals, width, height, (targets) => {
      this.sumRecords(this.records.everywhere, look, targets);
      this.drawErrors(this.records.everywhere, look, targets);
      return texelsOf(this.gl, targets.errors);
    });
  }

  /** Does something with images of these points in place of those of surfaces. */
  private atPoints(
    points: Float32Array,
    normals: Float32Array,
    width: number,
    height: number,
    read: (targets: Targets) => Float32Array,
  ): Float32Array {
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
    const found = read(targets);
    targets.dispose();
    return found;
  }

  /** The place that the picture shows at a pixel, counted from its bottom left, or nothing. */
  placeAt(x: number, y: number): three.Vector3 | undefined {
    const texel = new Float32Array(4);
    this.gl.readRenderTargetPixels(this.targets.surfaces, x, y, 1, 1, texel, undefined, 0);
    return texel[3] ? new three.Vector3().fromArray(texel) : undefined;
  }

  private drawLinear(pose: Pose, look: Look, width: number, height: number): void {
    this.resize(width, height);
    const planes = look.mirrors && look.indirect ? chosenPlanes(this.surfaces.planes, pose) : [];
    planes.forEach((plane, i) => this.drawLight(pose, look, this.targets.mirrors[i] ?? null, plane));
    this.drawLight(pose, look, this.targets.base);
    const { gl, targets, mirroring } = this;
    planes.forEach(({ normal, offset }, i) => {
      this.set(mirroring, `plane${i}`, new three.Vector4(...normal.toArray(), offset));
      this.set(mirroring, `mirror${i}`, targets.mirrors[i]?.texture);
    });
    this.set(mirroring, 'planes', planes.length);
    this.set(mirroring, 'showIndirect', look.indirect && look.mirrors);
    this.set(mirroring, 'pixelAngle', (2 * pose.extent(width / height)[1]) / height);
    const { glass, behindGlass } = targets;
    this.drawMirrors(targets.surfaces, targets.base, behindGlass ?? targets.picture, false);
    if (!glass || !behindGlass) return;
    gl.setRenderTarget(glass);
    gl.clear();
    gl.render(this.surfaces.glass, this.camera);
    this.drawMirrors(glass, behindGlass, targets.picture, true);
  }

  /** Adds what surfaces mirror to a picture. */
  private drawMirrors(
    surfaces: three.WebGLRenderTarget,
    picture: three.WebGLRenderTarget,
    into: three.WebGLRenderTarget,
    glass: boolean,
  ): void {
    MIRROR_IMAGES.forEach((name, i) => this.set(this.mirroring, name, surfaces.textures[i]));
    this.set(this.mirroring, 'picture', picture.texture);
    this.set(this.mirroring, 'glass', glass);
    this.gl.setRenderTarget(into);
    this.gl.render(this.mirror, this.camera);
  }

  /** Draws the picture without mirrors: of the eye, or of what the eye sees in a plane. */
  private drawLight(pose: Pose, look: Look, into: three.WebGLRenderTarget | null, plane?: Plane): void {
    const { gl, targets } = this;
    const { width, height } = targets;
    const aspect = width / height;
    const mirrored = plane ? reflection(plane) : new three.Matrix4();
    this.view.viewProjection.value.copy(pose.viewProjection(aspect)).multiply(mirrored);
    this.view.eye.value.copy(pose.eye()).applyMatrix4(mirrored);
    // The mirror itself, and what lies in its plane, is not in the way of the mirrored eye.
    this.view.clip.value.copy(plane ? new three.Vector4(...plane.normal.toArray(), plane.offset + 1e-4 * pose.diagonal) : NO_CLIP);
    this.view.depths.value.copy(pose.depths);
    this.view.inMirror.value = plane !== undefined;
    this.gloss.switch(gl, look);
    for (const splats of [this.records.splats, this.gloss.splats]) turned(splats, plane !== undefined);
    this.bind();
    gl.setRenderTarget(targets.surfaces);
    gl.clear();
    gl.render(this.surfaces.seen, this.camera);
    gl.setRenderTarget(targets.ways);
    gl.render(this.setDepths, this.camera);
    gl.setRenderTarget(targets.light);
    gl.clear(true, false, false);
    for (const pass of this.lamps.passes) gl.render(pass, this.camera);
    this.sumRecords(this.records.splats, look, targets);
    this.drawSplats(this.gloss.splats, targets.glossSums);
    if (!plane) this.drawCounts(pose, look, width, height);
    this.set(this.dividing, 'showDirect', look.direct);
    this.set(this.dividing, 'showIndirect', look.indirect);
    (this.dividing['worldFromScreen']?.value as three.Matrix4).copy(this.view.viewProjection.value).invert();
    (this.dividing['size']?.value as three.Vector2).set(width, height);
    gl.setRenderTarget(into);
    gl.render(this.divide, this.camera);
  }

  /** Draws the sums of the records' light. */
  private sumRecords(splats: three.Scene, look: Look, targets: Targets): void {
    const { gl } = this;
    this.set(this.inputs, 'ways', null); // nothing may be read where it is drawn
    this.records.switch(look, 'ways');
    this.drawSplats(splats, targets.ways);
    this.set(this.inputs, 'ways', targets.ways.texture);
    this.records.switch(look);
    this.drawSplats(splats, targets.splats);
    this.set(this.unbending, 'firstOrder', targets.splats.textures[0]);
    this.set(this.unbending, 'bendings', targets.splats.textures[1]);
    gl.setRenderTarget(targets.sums);
    gl.render(this.unbend, this.camera);
  }

  /** Draws what overlays count. */
  private drawCounts(pose: Pose, look: Look, width: number, height: number): void {
    const { targets } = this;
    if (!(look.overlay in COUNTED)) return;
    if (look.overlay === 'error') return this.drawErrors(this.records.splats, look, targets);
    const pixelAngle = (2 * pose.extent(width / height)[1]) / height;
    this.records.switch(look, COUNTED[look.overlay as keyof typeof COUNTED], pixelAngle);
    this.drawSplats(this.records.splats, targets.counts);
  }

  /** Draws the estimated errors of the sums of the records' light. */
  private drawErrors(splats: three.Scene, look: Look, targets: Targets): void {
    const { gl } = this;
    this.records.switch(look, 'errors');
    this.drawSplats(splats, targets.counts);
    this.set(this.estimating, 'counts', targets.counts.texture);
    this.set(this.estimating, 'sums', targets.sums.texture);
    this.set(this.estimating, 'meanLuminance', this.records.meanLuminance);
    gl.setRenderTarget(targets.errors);
    gl.clear(true, false, false);
    gl.render(this.estimate, this.camera);
  }

  /** Adds splats to an image that is black before. */
  private drawSplats(splats: three.Scene, into: three.WebGLRenderTarget): void {
    this.gl.setRenderTarget(into);
    this.gl.clear(true, false, false);
    this.gl.render(splats, this.camera);
  }

  private resize(width: number, height: number): void {
    if (this.targets.width === width && this.targets.height === height) return;
    this.targets.dispose();
    this.targets = new Targets(width, height, this.precision, this.surfaces.glass.children.length > 0);
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
}

/** Turns the winding of what a pass draws, for mirrored eyes: three.js asks the matrix of the object for it. */
function turned(splats: three.Scene, mirrored: boolean): void {
  splats.children.forEach((object) => object.scale.setX(mirrored ? -1 : 1));
}
