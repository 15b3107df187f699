// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Where the eye is, and what it sees.

import * as three from 'three';
import type { CameraEntry } from './messages';

/** Distances of the clipping planes, in units of the diagonal of the scene. */
const NEAR = 2e-5;
const FAR = 20;

export class Pose {
  readonly toWorld = new three.Matrix4();
  /** Half the width and height of the picture at distance 1 (orthographic: in metres), for the aspect below. */
  halfExtent: [number, number] = [0.5, 0.5];
  aspect = 1;
  orthographic = false;
  shift: readonly [number, number] = [0, 0];
  fovAxis: CameraEntry['fov_axis'] = 'y';

  /** `diagonal` is that of the scene in metres. */
  constructor(readonly diagonal: number) {}

  /** Takes the place of a camera of the scene. */
  follow(camera: CameraEntry): void {
    this.toWorld.fromArray(camera.to_world).transpose();
    this.halfExtent = [...camera.half_extent];
    this.aspect = camera.size[0] / camera.size[1];
    this.orthographic = camera.orthographic;
    this.shift = camera.shift;
    this.fovAxis = camera.fov_axis;
  }

  /** Half the width and height of a picture of another aspect: the camera's axis keeps its field of view. */
  extent(aspect: number): [number, number] {
    const [width, height] = this.halfExtent;
    const axis = this.fovAxis;
    if (axis === 'diagonal') {
      const down = Math.hypot(width, height) / Math.hypot(aspect, 1);
      return [down * aspect, down];
    }
    const wide = axis === 'smaller' ? aspect < 1 : axis === 'larger' ? aspect >= 1 : axis === 'x';
    const was = axis === 'smaller' ? this.aspect < 1 : axis === 'larger' ? this.aspect >= 1 : axis === 'x';
    const half = was ? width : height;
    return wide ? [half, half / aspect] : [half * aspect, half];
  }

  copy(): Pose {
    const made = new Pose(this.diagonal);
    made.toWorld.copy(this.toWorld);
    made.halfExtent = [...this.halfExtent];
    const { aspect, orthographic, shift, fovAxis } = this;
    return Object.assign(made, { aspect, orthographic, shift, fovAxis });
  }

  viewProjection(aspect: number): three.Matrix4 {
    const [near, far] = this.orthographic ? [-FAR * this.diagonal, FAR * this.diagonal] : [NEAR * this.diagonal, FAR * this.diagonal];
    const at = this.orthographic ? 1 : near;
    const [width, height] = this.extent(aspect);
    const left = (2 * this.shift[0] - 1) * width * at;
    const right = (2 * this.shift[0] + 1) * width * at;
    const top = (1 - 2 * this.shift[1]) * height * at;
    const bottom = (-1 - 2 * this.shift[1]) * height * at;
    const projection = this.orthographic
      ? new three.Matrix4().makeOrthographic(left, right, top, bottom, near, far)
      : new three.Matrix4().makePerspective(left, right, top, bottom, near, far);
    return projection.multiply(this.toWorld.clone().invert());
  }

  /** The depth at which a perspective view begins, as a logarithm of 2, and one over the logarithm of how much deeper it ends. */
  get depths(): three.Vector2 {
    return new three.Vector2(Math.log2(NEAR * this.diagonal), 1 / Math.log2(FAR / NEAR));
  }

  /** The position and 1, or the direction towards an eye at infinity and 0. */
  eye(): three.Vector4 {
    const p = this.orthographic ? this.backward : this.position;
    return new three.Vector4(p.x, p.y, p.z, this.orthographic ? 0 : 1);
  }

  get position(): three.Vector3 {
    return new three.Vector3().setFromMatrixPosition(this.toWorld);
  }
  get right(): three.Vector3 {
    return new three.Vector3().setFromMatrixColumn(this.toWorld, 0);
  }
  get up(): three.Vector3 {
    return new three.Vector3().setFromMatrixColumn(this.toWorld, 1);
  }
  get backward(): three.Vector3 {
    return new three.Vector3().setFromMatrixColumn(this.toWorld, 2);
  }

  /** The vertical field of view in degrees, of a picture of that aspect. */
  verticalFov(aspect: number): number {
    return (2 * Math.atan(this.extent(aspect)[1]) * 180) / Math.PI;
  }
}
