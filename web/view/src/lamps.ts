// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Points, spots and suns: shadow maps, which are drawn once because nothing moves, and the passes that add their light.

import * as three from 'three';
import type { LightEntry, PointEntry, SpotEntry, SunEntry } from './messages';
import { adding } from './records';
import { lampFragment, screenVertex } from './shaders/screen';
import type { ShadowView, Surfaces } from './surfaces';
import { withoutVersion } from './surfaces';

/** Width in texels of a side of a cube, and of the map of a sun. */
const CUBE = 1024;
const FLAT = 4096;

/** The sides of a cube map: where a camera looks, and what is up in the image. */
const SIDES: readonly [three.Vector3, three.Vector3][] = [
  [new three.Vector3(1, 0, 0), new three.Vector3(0, -1, 0)],
  [new three.Vector3(-1, 0, 0), new three.Vector3(0, -1, 0)],
  [new three.Vector3(0, 1, 0), new three.Vector3(0, 0, 1)],
  [new three.Vector3(0, -1, 0), new three.Vector3(0, 0, -1)],
  [new three.Vector3(0, 0, 1), new three.Vector3(0, -1, 0)],
  [new three.Vector3(0, 0, -1), new three.Vector3(0, -1, 0)],
];

const FALLOFFS = { none: 0, smooth: 1, linear: 2 };

export class Lamps {
  /** One pass over the whole picture for each lamp. */
  readonly passes: readonly three.Scene[];

  constructor(
    renderer: three.WebGLRenderer,
    entries: readonly LightEntry[],
    surfaces: Surfaces,
    view: ShadowView,
    inputs: Record<string, three.IUniform>,
  ) {
    this.passes = entries.map((entry) => {
      const map = entry.kind === 'sun' ? sunMap(renderer, entry, surfaces, view) : cubeMap(renderer, entry, surfaces, view);
      return screenPass(lampFragment, { ...inputs, ...map, ...lampUniforms(entry) }, true);
    });
  }
}

/** A pass over the whole picture. */
export function screenPass(fragment: string, uniforms: Record<string, three.IUniform>, adds = false): three.Scene {
  const material = new three.RawShaderMaterial({
    glslVersion: three.GLSL3,
    vertexShader: withoutVersion(screenVertex),
    fragmentShader: withoutVersion(fragment),
    uniforms,
    depthTest: false,
    depthWrite: false,
    ...(adds ? adding : { blending: three.NoBlending }),
  });
  return overPicture(material);
}

/** A pass over the whole picture that sets depths. */
export function depthPass(fragment: string, uniforms: Record<string, three.IUniform>): three.Scene {
  const material = new three.RawShaderMaterial({
    glslVersion: three.GLSL3,
    vertexShader: withoutVersion(screenVertex),
    fragmentShader: withoutVersion(fragment),
    uniforms,
    depthFunc: three.AlwaysDepth,
    colorWrite: false,
  });
  return overPicture(material);
}

function overPicture(material: three.Material): three.Scene {
  const triangle = new three.BufferGeometry();
  triangle.setAttribute('position', new three.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
  const mesh = new three.Mesh(triangle, material);
  mesh.frustumCulled = false;
  const scene = new three.Scene();
  scene.add(mesh);
  return scene;
}

function lampUniforms(entry: LightEntry): Record<string, three.IUniform> {
  const spot = entry.kind === 'spot' ? entry : undefined;
  const radians = (degrees: number) => (degrees * Math.PI) / 180;
  const [inner, outer] = [radians(spot?.inner_angle ?? 0), radians(spot?.outer_angle ?? 0)];
  return {
    kind: { value: entry.kind === 'sun' ? 1 : 0 },
    lampPosition: { value: entry.kind === 'sun' ? new three.Vector3() : new three.Vector3(...entry.position) },
    lampDirection: { value: entry.kind === 'point' ? new three.Vector3(0, 0, 1) : new three.Vector3(...entry.direction) },
    power: { value: new three.Vector3(...(entry.kind === 'sun' ? entry.irradiance : entry.intensity)) },
    falloff: { value: spot ? (spot.smooth ? FALLOFFS.smooth : FALLOFFS.linear) : FALLOFFS.none },
    innerAngle: { value: inner },
    outerAngle: { value: outer },
    cosInner: { value: Math.cos(inner) },
    cosOuter: { value: Math.cos(outer) },
  };
}

const MAP = {
  type: three.FloatType,
  format: three.RedFormat,
  minFilter: three.NearestFilter,
  magFilter: three.NearestFilter,
} as const;

function cubeMap(
  renderer: three.WebGLRenderer,
  entry: PointEntry | SpotEntry,
  surfaces: Surfaces,
  view: ShadowView,
): Record<string, three.IUniform> {
  const target = new three.WebGLCubeRenderTarget(CUBE, MAP);
  const at = new three.Vector3(...entry.position);
  const far = 2 * (at.distanceTo(surfaces.bounds.getCenter(new three.Vector3())) + size(surfaces));
  const projection = new three.Matrix4().makePerspective(-1e-4 * far, 1e-4 * far, 1e-4 * far, -1e-4 * far, 1e-4 * far, far);
  view.eye.value.set(at.x, at.y, at.z, 1);
  SIDES.forEach(([forward, up], side) => {
    const pose = new three.Matrix4().lookAt(at, at.clone().add(forward), up).setPosition(at);
    view.viewProjection.value.multiplyMatrices(projection, pose.invert());
    draw(renderer, surfaces, target, side);
  });
  return { cube: { value: target.texture }, flatMap: { value: null }, texel: { value: 2 / CUBE } };
}

function sunMap(
  renderer: three.WebGLRenderer,
  entry: SunEntry,
  surfaces: Surfaces,
  view: ShadowView,
): Record<string, three.IUniform> {
  const width = Math.min(FLAT, renderer.capabilities.maxTextureSize);
  const target = new three.WebGLRenderTarget(width, width, MAP);
  const direction = new three.Vector3(...entry.direction);
  const up = Math.abs(direction.y) < 0.9 ? new three.Vector3(0, 1, 0) : new three.Vector3(1, 0, 0);
  const center = surfaces.bounds.getCenter(new three.Vector3());
  const half = 0.5 * size(surfaces);
  const pose = new three.Matrix4().lookAt(center, center.clone().add(direction), up).setPosition(center);
  const axes = pose.clone();
  const toMap = new three.Matrix4().makeOrthographic(-half, half, half, -half, -half, half).multiply(pose.invert());
  view.viewProjection.value.copy(toMap);
  view.eye.value.set(-direction.x, -direction.y, -direction.z, 0);
  view.sunDirection.value.copy(direction);
  draw(renderer, surfaces, target);
  return {
    cube: { value: null },
    flatMap: { value: target.texture },
    toMap: { value: toMap },
    mapX: { value: new three.Vector3().setFromMatrixColumn(axes, 0) },
    mapY: { value: new three.Vector3().setFromMatrixColumn(axes, 1) },
    tangent: { value: Math.tan((entry.angular_radius * Math.PI) / 180) },
    farthest: { value: 2 * half },
    texel: { value: (2 * half) / width },
  };
}

function draw(renderer: three.WebGLRenderer, surfaces: Surfaces, target: three.WebGLRenderTarget, side = 0): void {
  renderer.setRenderTarget(target, side);
  renderer.setClearColor(new three.Color(1e30, 1e30, 1e30), 1);
  renderer.clear();
  renderer.render(surfaces.shading, new three.Camera());
  renderer.setClearColor(0, 0);
}

function size(surfaces: Surfaces): number {
  return surfaces.bounds.getSize(new three.Vector3()).length();
}
