// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Moves the eye by pointer, touch and keys. In orbit, dragging turns the eye around a point; walking, it turns the gaze.

import * as three from 'three';
import type { Pose } from './pose';

export type Mode = 'orbit' | 'walk';

/** Radians that a drag across the whole canvas turns. */
const TURN = Math.PI;

/** Share of the diagonal of the scene that a second of walking crosses. */
const PACE = 0.12;

/** The least angle in radians between the gaze and the vertical. */
const STEEPEST = 0.02;

/** Pixels that a pointer may move in a click. */
const CLICK = 4;

/** Directions of keys: right, up, backward. */
const KEYS: Readonly<Record<string, readonly [number, number, number]>> = {
  KeyW: [0, 0, -1],
  ArrowUp: [0, 0, -1],
  KeyS: [0, 0, 1],
  ArrowDown: [0, 0, 1],
  KeyA: [-1, 0, 0],
  ArrowLeft: [-1, 0, 0],
  KeyD: [1, 0, 0],
  ArrowRight: [1, 0, 0],
  KeyE: [0, 1, 0],
  PageUp: [0, 1, 0],
  KeyQ: [0, -1, 0],
  PageDown: [0, -1, 0],
};

export class Navigation {
  mode: Mode = 'orbit';
  private distance: number;
  private dragged = 0;
  private readonly pressed = new Set<string>();
  private readonly pointers = new Map<number, { x: number; y: number }>();

  /** `changed` is called whenever the eye has moved, `clicked` with a place on the canvas, in its own pixels. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly pose: Pose,
    private readonly sceneUp: three.Vector3,
    private readonly changed: () => void,
    private readonly clicked: (x: number, y: number) => void,
  ) {
    this.distance = 0.5 * pose.diagonal;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.release(event));
    canvas.addEventListener('pointercancel', (event) => this.pointers.delete(event.pointerId));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('keydown', (event) => this.key(event));
    canvas.addEventListener('keyup', (event) => this.pressed.delete(event.code));
    canvas.addEventListener('blur', () => this.pressed.clear());
  }

  /** Sets what the eye turns around in orbit: the point that far ahead. */
  lookAtDistance(distance: number): void {
    this.distance = distance;
  }

  /** Walks as the pressed keys say, for some seconds. Returns whether the eye moves. */
  step(seconds: number): boolean {
    const direction = new three.Vector3();
    for (const code of this.pressed) {
      const [right, up, backward] = KEYS[code] ?? [0, 0, 0];
      direction
        .addScaledVector(this.pose.right, right)
        .addScaledVector(this.sceneUp, up)
        .addScaledVector(this.pose.backward, backward);
    }
    if (direction.lengthSq() === 0) return false;
    const fast = this.pressed.has('ShiftLeft') || this.pressed.has('ShiftRight') ? 3 : 1;
    this.shift(direction.normalize().multiplyScalar(seconds * fast * PACE * this.pose.diagonal));
    return true;
  }

  private down(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.dragged = 0;
  }

  private release(event: PointerEvent): void {
    this.pointers.delete(event.pointerId);
    if (this.dragged < CLICK) this.clicked(event.offsetX, event.offsetY);
  }

  private move(event: PointerEvent): void {
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    this.dragged += Math.hypot(event.clientX - last.x, event.clientY - last.y);
    const { clientWidth, clientHeight } = this.canvas;
    const [x, y] = [(event.clientX - last.x) / clientHeight, (event.clientY - last.y) / clientHeight];
    if (this.pointers.size === 2) {
      // Two fingers move the eye sideways, and forward by as much as they part.
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
      if (other) {
        const before = Math.hypot(last.x - other.x, last.y - other.y);
        const now = Math.hypot(event.clientX - other.x, event.clientY - other.y);
        this.pan(0.5 * x, 0.5 * y);
        this.dolly(-(now - before) / clientWidth);
      }
    } else if (event.buttons === 1 && !event.shiftKey) {
      this.turn(-x * TURN, -y * TURN);
    } else {
      this.pan(x, y);
    }
    last.x = event.clientX;
    last.y = event.clientY;
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.dolly(Math.max(-0.3, Math.min(0.3, event.deltaY * 1e-3)));
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.code in KEYS || event.code.startsWith('Shift')) {
      this.pressed.add(event.code);
      if (event.code in KEYS) event.preventDefault();
      this.changed();
    }
  }

  /** Turns the gaze by angles in radians, around the scene's vertical and around what points right. */
  private turn(aside: number, upwards: number): void {
    const { pose } = this;
    const pivot = pose.position.addScaledVector(pose.backward, -this.distance);
    const elevation = pose.backward.angleTo(this.sceneUp);
    // In orbit the eye goes down as the gaze goes up.
    const pitch = Math.max(STEEPEST - elevation, Math.min(Math.PI - STEEPEST - elevation, upwards));
    const turned = new three.Quaternion()
      .setFromAxisAngle(this.sceneUp, aside)
      .multiply(new three.Quaternion().setFromAxisAngle(pose.right, pitch));
    const backward = pose.backward.applyQuaternion(turned).normalize();
    const position = this.mode === 'orbit' ? pivot.addScaledVector(backward, this.distance) : pose.position;
    const right = pose.right.applyQuaternion(turned).normalize();
    const up = pose.up.applyQuaternion(turned).normalize();
    pose.toWorld.makeBasis(right, up, backward).setPosition(position);
    this.changed();
  }

  private pan(x: number, y: number): void {
    const wide = 2 * this.distance * this.pose.extent(1)[1];
    this.shift(this.pose.right.multiplyScalar(-x * wide).addScaledVector(this.pose.up, y * wide));
  }

  private dolly(share: number): void {
    const { pose } = this;
    if (pose.orthographic) {
      pose.halfExtent = [pose.halfExtent[0] * (1 + share), pose.halfExtent[1] * (1 + share)];
      this.changed();
      return;
    }
    this.shift(pose.backward.multiplyScalar(share * this.distance));
    if (this.mode === 'orbit') this.distance = Math.max(1e-3 * pose.diagonal, this.distance * (1 + share));
  }

  private shift(by: three.Vector3): void {
    this.pose.toWorld.setPosition(this.pose.position.add(by));
    this.changed();
  }
}
