// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The page of `eclat view`: loads the messages of a scene, and draws it whenever something has changed.

import * as three from 'three';
import { decodeMessage, type GlossHeader, type LightHeader, type RecordsHeader, type SceneHeader } from './messages';
import { described, Live, Wishes } from './live';
import { Navigation } from './navigation';
import { fillPanel, type Panel } from './panel';
import { Pose } from './pose';
import { irradianceShown, radianceShown, recordFacts } from './record_facts';
import { USUAL_LOOK, type Look } from './look';
import { Renderer } from './renderer';
import { Truth } from './truth';

/** What tests and other pages may ask of this page. */
export interface EclatView {
  readonly precision: string;
  readonly records: number;
  readonly radianceRecords: number;
  /** How far the page is from the picture of the server that stands beside it, as relative RMSE; nothing where there is none. */
  readonly truth: Truth['figures'];
  /** Linear radiance (height, width, 4) of a camera of the scene, the first row at the bottom. */
  linear(camera: number, width: number, height: number, look?: Partial<Look>): Float32Array;
  /** The fragments of splats per pixel of such a picture, and those of them that serve their pixel. */
  work(camera: number, width: number, height: number): ReturnType<Renderer['work']>;
  /** The sums (n, 4) of (w E, w) at n points with normals. */
  sums(points: Float32Array, normals: Float32Array, look?: Partial<Look>): Float32Array;
  /** The estimated errors (n, 4) of what is read there: relative, and 1 where a record serves the point. */
  errors(points: Float32Array, normals: Float32Array): Float32Array;
}

declare global {
  interface Window {
    eclatView?: EclatView;
  }
}

function byId<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`The page has no element ${id}.`);
  return found as T;
}

async function load(name: string, done: (bytes: number, total: number) => void): Promise<ArrayBuffer> {
  const response = await fetch(`./data/${name}.eclat`);
  if (!response.ok || !response.body) throw new Error(`The ${name} cannot be loaded (${response.status}).`);
  const total = Number(response.headers.get('content-length') ?? 0);
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let bytes = 0;
  const reader = response.body.getReader();
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    parts.push(part.value);
    bytes += part.value.byteLength;
    done(bytes, total);
  }
  return new Blob(parts).arrayBuffer();
}

async function start(): Promise<void> {
  const canvas = byId<HTMLCanvasElement>('picture');
  const progress = byId<HTMLProgressElement>('progress');
  const names = ['scene', 'light', 'records', 'gloss'];
  const shares = new Map<string, number>();
  const [sceneBytes, lightBytes, recordBytes, glossBytes] = await Promise.all(
    names.map((name) =>
      load(name, (bytes, total) => {
        shares.set(name, total > 0 ? bytes / total : 0);
        progress.value = [...shares.values()].reduce((a, b) => a + b, 0) / names.length;
      }),
    ),
  );
  const scene = decodeMessage<SceneHeader>(sceneBytes as ArrayBuffer, 'scene');
  const { header } = scene;
  document.title = `${header.name} – Éclat`;
  canvas.setAttribute('aria-label', `The scene ${header.name} with global illumination`);
  const renderer = await Renderer.create(canvas, scene, decodeMessage<LightHeader>(lightBytes as ArrayBuffer, 'light'));
  renderer.acceptRecords(decodeMessage<RecordsHeader>(recordBytes as ArrayBuffer, 'records'));
  renderer.acceptGloss(decodeMessage<GlossHeader>(glossBytes as ArrayBuffer, 'gloss'));
  progress.hidden = true;

  const look: Look = { ...USUAL_LOOK, exposure: header.exposure };
  const pose = new Pose(renderer.surfaces.bounds.getSize(new three.Vector3()).length());
  let stale = true;
  const changed = () => (stale = true);
  const navigation = new Navigation(canvas, pose, new three.Vector3(...header.up).normalize(), changed, (x, y) =>
    inspect(x, y),
  );
  const showCamera = (number: number) => {
    const camera = header.cameras[number];
    if (!camera) return;
    pose.follow(camera);
    navigation.lookAtDistance(pose.position.distanceTo(renderer.surfaces.bounds.getCenter(new three.Vector3())));
    changed();
  };
  showCamera(0);

  const draw = () => {
    const ratio = window.devicePixelRatio;
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (width > 0 && height > 0) renderer.draw(pose, look, width, height, truth?.beside);
  };
  const relit = () => {
    truth?.redraw();
    changed();
  };
  let hemispheres = 0; // requests so far
  let everywhere = false; // whether the server computes all surfaces
  const live = Live.connect({
    records: (message) => {
      renderer.acceptRecords(message);
      tell();
      relit();
    },
    gloss: (message) => {
      renderer.acceptGloss(message);
      tell();
      relit();
    },
    hemisphere: (message) => {
      if (message.header.number === hemispheres) panel.hemisphere.accept(message, look);
    },
    truth: (message) => truth?.accept(message),
    state: (state) => {
      everywhere = state?.everywhere ?? false;
      tell();
      byId('live').textContent = described(state);
      byId('live').hidden = state !== undefined && !state.solving;
    },
  });
  const truth: Truth | undefined = live && new Truth(live, renderer, (text) => (panel.truth.textContent = text), changed);
  const panel: Panel = fillPanel(byId('panel'), {
    look,
    cameras: header.cameras.map((camera) => camera.name),
    notes: header.notes,
    changed: () => {
      changed();
      panel.hemisphere.draw(look); // it follows exposure and order
    },
    relit,
    showCamera,
    ...(truth ? { chooseTruth: (way) => truth.choose(way) } : {}),
    setMode: (mode) => (navigation.mode = mode),
    copyCamera: () => copyCamera(pose, header, canvas),
    saveScreenshot: () => {
      draw(); // a picture can be read only in the task that drew it
      canvas.toBlob((blob) => blob && save(blob, `${header.name}.png`));
    },
    inspectMiddle: () => inspect(canvas.clientWidth / 2, canvas.clientHeight / 2),
    toggleFullScreen: () =>
      void (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen()),
  });
  const inspect = (x: number, y: number) => {
    draw(); // the places of the picture as it is now
    const ratio = window.devicePixelRatio;
    const place = renderer.placeAt(Math.round(x * ratio), Math.round((canvas.clientHeight - y) * ratio) - 1);
    const [number, glossy] = place ? [renderer.records.nearest(place), renderer.gloss.nearest(place)] : [-1, -1];
    const facts: [string, string][] = number < 0 ? [['No record', 'serves this place']] : recordFacts(renderer.records, number, header);
    if (glossy >= 0) facts.push(['Record of radiance', `${glossy}, of order ${renderer.gloss.order}`]);
    panel.showRecord(facts);
    const seen =
      glossy >= 0 ? radianceShown(renderer.gloss, glossy) : number >= 0 ? irradianceShown(renderer.records, number) : undefined;
    panel.hemisphere.begin(live ? seen : undefined);
    if (seen) live?.hemisphere(seen.place.toArray(), seen.normal.clone().normalize().toArray(), ++hemispheres);
  };
  byId('panel').hidden = false;
  const tell = () => {
    panel.showOrder(renderer.gloss.order);
    panel.facts.textContent =
      `${header.name}: ${renderer.surfaces.triangles.toLocaleString('en')} triangles, ` +
      `${renderer.records.count.toLocaleString('en')} records of ${renderer.records.reading?.method ?? ''}` +
      (renderer.gloss.count > 0 ? `, ${renderer.gloss.count.toLocaleString('en')} of radiance.` : '.') +
      (everywhere ? ' The surfaces that nobody looks at are being computed.' : '') +
      (renderer.precision === 'half' ? ' This graphics card cannot blend floats; sums are rounded to half floats, which changes most pixels by 0.01 %, and few by more than 0.1 %.' : '');
  };
  tell();
  const wishes = live && new Wishes(() => live.wish(pose, canvas.clientWidth, canvas.clientHeight));
  if (live) byId('panel').append(cacheLink());

  let last = performance.now();
  let seen = '';
  const frame = (now: number) => {
    const moves = navigation.step(Math.min(0.1, (now - last) / 1000));
    last = now;
    if (stale || moves) {
      stale = false;
      draw();
    }
    const view = [...pose.toWorld.elements, ...pose.halfExtent, canvas.clientWidth, canvas.clientHeight].join();
    wishes?.step(now, view !== seen, () => {
      changed(); // the measure draws over the picture
      return renderer.missing(pose, canvas.clientWidth / canvas.clientHeight);
    });
    truth?.step(now, view !== seen, pose, look, canvas.clientWidth, canvas.clientHeight);
    seen = view;
    requestAnimationFrame(frame);
  };
  new ResizeObserver(changed).observe(canvas);
  requestAnimationFrame(frame);
  window.eclatView = interfaceOf(renderer, header, pose.diagonal, truth);
}

function interfaceOf(renderer: Renderer, header: SceneHeader, diagonal: number, truth?: Truth): EclatView {
  const poseOf = (number: number) => {
    const camera = header.cameras[number];
    if (!camera) throw new Error(`The scene has no camera ${number}.`);
    const pose = new Pose(diagonal);
    pose.follow(camera);
    return pose;
  };
  const rowsOf = (points: Float32Array) => Math.ceil(points.length / 3 / 64);
  return {
    precision: renderer.precision,
    get records() {
      return renderer.records.count;
    },
    get radianceRecords() {
      return renderer.gloss.count;
    },
    get truth() {
      return truth?.figures;
    },
    linear: (number, width, height, look = {}) =>
      renderer.readLinear(poseOf(number), { ...USUAL_LOOK, ...look }, width, height),
    work: (number, width, height) => renderer.work(poseOf(number), width, height),
    sums: (points, normals, look = {}) =>
      renderer.readRecords(points, normals, 64, rowsOf(points), { ...USUAL_LOOK, ...look }).subarray(0, (points.length / 3) * 4),
    errors: (points, normals) => renderer.readErrors(points, normals, 64, rowsOf(points)).subarray(0, (points.length / 3) * 4),
  };
}

/** A link that saves the records, with those that were solved for views, as the usual cache file. */
function cacheLink(): HTMLElement {
  const link = document.createElement('a');
  link.href = './cache.npz';
  link.download = 'cache.npz';
  link.textContent = 'Save the records as a cache file';
  const paragraph = document.createElement('p');
  paragraph.append(link);
  return paragraph;
}

/** Copies the flags that give `eclat render` this camera. Returns what to tell. */
async function copyCamera(pose: Pose, header: SceneHeader, canvas: HTMLCanvasElement): Promise<string> {
  const world = (v: three.Vector3) => v.toArray().map((x, i) => +(x + (header.center[i] ?? 0)).toFixed(5));
  const { clientWidth: width, clientHeight: height } = canvas;
  const ahead = pose.position.addScaledVector(pose.backward, -0.1 * pose.diagonal);
  const flags =
    `--camera-from ${world(pose.position)} --camera-to ${world(ahead)} ` +
    `--camera-up ${pose.up.toArray().map((x) => +x.toFixed(5))} ` +
    `--fov ${pose.verticalFov(width / height).toFixed(4)} --size ${width}x${height}`;
  try {
    await navigator.clipboard.writeText(flags);
    return `Copied: ${flags}`;
  } catch {
    return flags; // without permission to write to the clipboard, the text can be selected
  }
}

function save(blob: Blob, name: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}

start().catch((error: unknown) => {
  byId('progress').hidden = true;
  byId('message').textContent = error instanceof Error ? error.message : String(error);
  document.body.classList.add('failed');
});
