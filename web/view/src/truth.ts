// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The picture that the server renders of this very view, beside that of the page: a border between both, the map of their
// difference, and its figure.

import * as three from 'three';
import { awayFromEdges, compared, floorOf, type Figures, type Halves } from './comparison';
import type { Live } from './live';
import { arrayOf, type Message, type TruthHeader } from './messages';
import type { Pose } from './pose';
import type { Look } from './look';
import type { Renderer } from './renderer';

/** How the server renders: not at all, by paths, or as `eclat render` with the records so far. */
export type Way = 'off' | 'paths' | 'records';

/** Milliseconds for which a view must rest before it is rendered. */
const REST = 300;

/**
 * Pictures of the page, each shifted to another place of a grid in the pixel, whose mean is compared: the server averages over
 * pixels, too. They come in an order that spreads them early.
 */
const SIDE = 4;
const ORDER = [0, 10, 2, 8, 5, 15, 7, 13, 1, 11, 3, 9, 4, 14, 6, 12];
const PICTURES = ORDER.length;

/** What both pictures are for the display pass. */
export interface Beside {
  /** The mean of the page's pictures, and the truth; row 0 at the bottom and at the top. */
  readonly page: three.Texture;
  readonly truth: three.Texture;
  /** The constant that keeps relative differences of black places finite, as in comparison.ts. */
  readonly floor: number;
}

/** A view, as it was asked for. */
interface Asked {
  readonly pose: Pose;
  readonly number: number;
}

export class Truth {
  private way: Way = 'off';
  private asked: Asked | undefined;
  private number = 0;
  private moved = 0;
  private halves: Halves | undefined;
  private samples = 0;
  private sum = new Float32Array(0);
  private taken = 0;
  private away: Uint8Array | undefined;
  private textures: { page: three.DataTexture; truth: three.DataTexture } | undefined;
  private floor = 0;

  /** `tell` shows a text; `changed` is called when the picture must be drawn anew. */
  constructor(
    private readonly live: Live,
    private readonly renderer: Renderer,
    private readonly tell: (text: string) => void,
    private readonly changed: () => void,
  ) {}

  /** What is shown beside each other, or nothing yet. */
  get beside(): Beside | undefined {
    return this.textures && this.taken > 0 ? { ...this.textures, floor: this.floor } : undefined;
  }

  /** The number of samples per pixel of the truth, and the error of the page's mean; nothing before both are there. */
  get figures(): (Figures & { samples: number; pictures: number }) | undefined {
    if (!this.halves || !this.away || this.taken === 0) return undefined;
    const mean = this.sum.map((x) => x / this.taken);
    return { ...compared(mean, this.halves, this.away), samples: this.samples, pictures: this.taken };
  }

  choose(way: Way): void {
    this.way = way;
    this.forget();
    this.tell(way === 'off' ? '' : 'The server begins to render this view.');
  }

  /** Takes in the truth, unless it belongs to a view that was left. */
  accept(message: Message<TruthHeader>): void {
    if (message.header.number !== this.asked?.number) return;
    const [height = 0, width = 0] = arrayOf(message, 'first').shape;
    const [first, second] = ['first', 'second'].map((name) => arrayOf(message, name).data as Float32Array);
    if (!first || !second) return;
    if (this.halves?.width !== width || this.halves.height !== height) this.begin(width, height);
    this.halves = { width, height, first, second };
    this.samples = message.header.samples;
    this.floor = floorOf(this.halves);
    if (this.textures) {
      const texels = this.textures.truth.image.data as Float32Array;
      for (let i = 0; i < width * height; ++i) {
        for (let k = 0; k < 3; ++k) texels[4 * i + k] = 0.5 * ((first[3 * i + k] ?? 0) + (second[3 * i + k] ?? 0));
      }
      this.textures.truth.needsUpdate = true;
    }
    this.report();
  }

  /** The page's pictures must be drawn anew, because records or settings have changed. */
  redraw(): void {
    this.sum.fill(0);
    this.taken = 0;
    this.away = undefined;
  }

  /** Must be called with every frame: asks for the truth when the view rests, and draws the page's pictures. */
  step(now: number, moves: boolean, pose: Pose, look: Look, width: number, height: number): void {
    if (this.way === 'off') return;
    if (moves) {
      this.moved = now;
      if (this.asked) this.forget();
    }
    if (!this.asked) {
      if (now - this.moved < REST || width === 0 || height === 0) return;
      this.asked = { pose: pose.copy(), number: ++this.number };
      this.live.truth(this.asked.pose, width, height, this.way, this.asked.number);
    }
    if (this.halves && this.taken < PICTURES) this.draw(this.asked.pose, look, this.halves);
  }

  /** Draws one more picture. */
  private draw(pose: Pose, look: Look, { width, height }: Halves): void {
    const shifted = pose.copy();
    const place = ORDER[this.taken] ?? 0;
    const [x, y] = [place % SIDE, Math.floor(place / SIDE)].map((i) => (i + 0.5) / SIDE - 0.5) as [number, number];
    shifted.shift = [pose.shift[0] + x / width, pose.shift[1] + y / height];
    const picture = this.renderer.readLinear(shifted, look, width, height);
    this.away ??= awayFromEdges(...this.renderer.readSurfaces(), pose.eye().toArray(), width, height);
    picture.forEach((value, i) => (this.sum[i] = (this.sum[i] ?? 0) + value));
    ++this.taken;
    if (this.textures) {
      const texels = this.textures.page.image.data as Float32Array;
      this.sum.forEach((value, i) => (texels[i] = value / this.taken));
      this.textures.page.needsUpdate = true;
    }
    this.report();
  }

  private begin(width: number, height: number): void {
    this.redraw();
    this.sum = new Float32Array(4 * width * height);
    Object.values(this.textures ?? {}).forEach((texture) => texture.dispose());
    this.textures = { page: floats(width, height), truth: floats(width, height) };
  }

  private forget(): void {
    if (this.asked) this.live.stop();
    this.asked = this.halves = undefined;
    Object.values(this.textures ?? {}).forEach((texture) => texture.dispose());
    this.textures = undefined;
    this.redraw();
    this.changed();
  }

  private report(): void {
    const figures = this.figures;
    const percent = (error: number) => `${(100 * error).toFixed(2)} %`;
    if (figures) {
      const away = figures.away === undefined ? '' : ` (away from edges ${percent(figures.away)})`;
      this.tell(
        `${figures.samples.toLocaleString('en')} samples a pixel: relative RMSE ${percent(figures.whole)}${away}, without the noise of the truth.`,
      );
    }
    this.changed();
  }
}

function floats(width: number, height: number): three.DataTexture {
  const texels = new Float32Array(4 * width * height);
  const texture = new three.DataTexture(texels, width, height, three.RGBAFormat, three.FloatType);
  texture.minFilter = texture.magFilter = three.NearestFilter;
  texture.needsUpdate = true;
  return texture;
}
