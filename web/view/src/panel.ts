// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The settings beside the picture: plain controls with labels, which keys and screen readers reach.

import { HemisphereView } from './hemisphere';
import type { Mode } from './navigation';
import type { Weighting } from './records';
import type { Look, Overlay, ToneMapping } from './look';
import type { Way } from './truth';

export interface PanelActions {
  readonly look: Look;
  readonly cameras: readonly string[];
  readonly notes: readonly string[];
  changed(): void;
  /** Is called in addition where the linear picture has changed. */
  relit(): void;
  showCamera(number: number): void;
  setMode(mode: Mode): void;
  copyCamera(): Promise<string>;
  saveScreenshot(): void;
  toggleFullScreen(): void;
  inspectMiddle(): void;
  /** Chooses how the server renders this view beside the page's picture; missing where there is no server. */
  readonly chooseTruth?: (way: Way) => void;
}

const TONE_MAPPINGS: readonly [ToneMapping, string][] = [
  ['none', 'None'],
  ['filmic', 'Filmic'],
  ['agx', 'AgX'],
];
const OVERLAYS: readonly [Overlay, string][] = [
  ['none', 'None'],
  ['weights', 'Sum of weights'],
  ['density', 'Splats per pixel'],
  ['records', 'Records and their radii'],
  ['clearance', 'Distance to the nearest obstacle'],
  ['noise', 'Noise of the records, up to 10 %'],
  ['error', 'Estimated error of the records'],
  ['left-out', 'What is approximated'],
  ['lobes', 'Lobes from records, and traced'],
];
const LEGENDS: Record<Overlay, string> = {
  none: '',
  weights: 'From dark blue to yellow: sums of weights from 0 to 4. Red: no record serves the place.',
  density: 'From dark blue to yellow: 0 to 63 splats that serve a pixel.',
  records: 'Yellow: the places of records. Blue: the ellipses of their radii.',
  clearance: 'From dark blue to yellow: a thousandth of the diagonal of the scene to all of it.',
  noise: 'From dark blue to yellow: standard errors of irradiance from 0 to 10 %.',
  error:
    'From dark blue (0.1 %) over green (1 %) to yellow (10 % and more), by logarithm: how wrong irradiance may be as far as its records ' +
    'know, from their curvature, the distance to them, and their noise. Red: no record serves the place.',
  'left-out': 'Stripes. Red: matte surfaces without records. Orange: rough gloss. Blue: mirrors and glass.',
  lobes:
    'Green: matte light from records. Blue: gloss from records. Turquoise: both. Orange, also in stripes: gloss that eclat ' +
    'render traces and this page approximates. Red: matte light that no record serves.',
};
const WEIGHTINGS: readonly [Weighting, string][] = [
  ['solved', 'As they were solved'],
  ['tabellion', 'Tabellion and Lamorlette'],
  ['ward', 'Ward and Heckbert'],
  ['split-sphere', 'Split sphere'],
];
const MODES: readonly [Mode, string][] = [
  ['orbit', 'Orbit'],
  ['walk', 'Walk'],
];
const WAYS: readonly [Way, string][] = [
  ['off', 'Off'],
  ['paths', 'By paths'],
  ['records', 'By records, as eclat render'],
];

/** What the page writes into the panel. */
export interface Panel {
  readonly facts: HTMLElement;
  /** What is told about the picture of the server. */
  readonly truth: HTMLElement;
  /** What the record that was clicked sees. */
  readonly hemisphere: HemisphereView;
  /** Shows the facts about a record, by their names. */
  showRecord(facts: readonly (readonly [string, string])[]): void;
  /** Offers orders of harmonics up to the greatest; 0 offers none. */
  showOrder(greatest: number): void;
}

/** Fills the panel. */
export function fillPanel(panel: HTMLElement, actions: PanelActions): Panel {
  const { look } = actions;
  const set = <K extends keyof Look>(key: K) => (value: Look[K]) => {
    look[key] = value;
    actions.changed();
  };
  const relight = <K extends keyof Look>(key: K) => (value: Look[K]) => {
    set(key)(value);
    actions.relit();
  };
  const camera = section('Camera');
  if (actions.cameras.length > 0) {
    const names = actions.cameras.map((name, i): [string, string] => [String(i), name]);
    camera.append(choice('Camera of the scene', names, '0', (i) => actions.showCamera(Number(i))));
  }
  camera.append(choice('Navigation', MODES, 'orbit', (mode) => actions.setMode(mode)));
  const copied = element('p', { role: 'status' });
  camera.append(
    button('Copy camera as flags', () => void actions.copyCamera().then((text) => (copied.textContent = text))),
    copied,
  );

  const picture = section('Picture');
  picture.append(
    slider('Exposure in stops', [-8, 8, 0.1], look.exposure, stops, set('exposure')),
    choice('Tone mapping', TONE_MAPPINGS, look.toneMapping, set('toneMapping')),
    button('Save screenshot', () => actions.saveScreenshot()),
    button('Full screen', () => actions.toggleFullScreen()),
  );

  const light = section('Light and records');
  const order = choice('Order of harmonics', [], '', (n) => relight('order')(Number(n)));
  order.hidden = true;
  const legend = element('p', { role: 'status', class: 'legend' });
  light.append(
    choice('Overlay', OVERLAYS, look.overlay, (overlay) => {
      legend.textContent = LEGENDS[overlay];
      set('overlay')(overlay);
    }),
    legend,
    checkbox('Direct light', look.direct, relight('direct')),
    checkbox('Light from records', look.indirect, relight('indirect')),
    checkbox('Gradients', look.gradients, relight('gradients')),
    checkbox('Mirrors, approximated', look.mirrors, relight('mirrors')),
    checkbox('Clearance test', look.clearance, relight('clearance')),
    checkbox('Radii bounded by neighbours', look.clamping, relight('clamping')),
    choice('Weights', WEIGHTINGS, look.weight, relight('weight')),
    order,
  );

  const showOrder = (greatest: number) => {
    order.hidden = greatest === 0;
    const select = order.querySelector('select');
    if (!select || select.length === greatest) return;
    const numbers = Array.from({ length: greatest }, (_, i) => greatest - i);
    select.replaceChildren(...numbers.map((n) => new Option(n === greatest ? `${n}, all` : String(n), n === greatest ? 'Infinity' : String(n))));
  };
  const truth = section('Truth');
  const compared = element('p', { role: 'status' });
  const { chooseTruth } = actions;
  if (chooseTruth) {
    truth.append(
      choice('Render this view beside', WAYS, 'off', chooseTruth),
      slider('Border between page and truth', [0, 1, 0.01], look.wipe, percent, set('wipe')),
      checkbox('Map of the difference', look.difference, set('difference')),
      compared,
    );
  }

  const record = section('Record');
  const shown = element('dl', { 'aria-live': 'polite' });
  const hemisphere = new HemisphereView();
  record.append(button('Inspect the record in the middle', () => actions.inspectMiddle()), shown, hemisphere.element);

  const facts = section('Scene');
  const told = element('p', {});
  facts.append(told);
  if (actions.notes.length > 0) {
    const list = document.createElement('ul');
    for (const note of actions.notes) list.append(Object.assign(document.createElement('li'), { textContent: note }));
    facts.append(list);
  }
  const keys = element('p', { id: 'keys' });
  keys.textContent =
    'Click to inspect a record. Drag to turn, drag with Shift or the right button to move, scroll to go nearer. In the picture, the keys W A S D or the ' +
    'arrows walk, E and Q go up and down, and Shift is faster. Two fingers move and zoom.';
  facts.append(keys);
  panel.append(camera, picture, light, ...(chooseTruth ? [truth] : []), record, facts);
  const showRecord = (found: readonly (readonly [string, string])[]) =>
    shown.replaceChildren(
      ...found.flatMap(([name, value]) => [
        Object.assign(element('dt', {}), { textContent: name }),
        Object.assign(element('dd', {}), { textContent: value }),
      ]),
    );
  return { facts: told, truth: compared, hemisphere, showRecord, showOrder };
}

function element<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Record<string, string>): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

function section(title: string): HTMLElement {
  const made = element('section', {});
  made.append(Object.assign(element('h2', {}), { textContent: title }));
  return made;
}

function labelled(text: string, control: HTMLElement): HTMLElement {
  const label = element('label', {});
  label.append(Object.assign(element('span', {}), { textContent: text }), control);
  return label;
}

function choice<T extends string>(
  text: string,
  options: readonly (readonly [T, string])[],
  chosen: T,
  change: (value: T) => void,
): HTMLElement {
  const select = element('select', {});
  for (const [value, shown] of options) select.append(new Option(shown, value, value === chosen, value === chosen));
  select.addEventListener('change', () => change(select.value as T));
  return labelled(text, select);
}

function checkbox(text: string, checked: boolean, change: (value: boolean) => void): HTMLElement {
  const input = element('input', { type: 'checkbox' });
  input.checked = checked;
  input.addEventListener('change', () => change(input.checked));
  const label = labelled(text, input);
  label.className = 'switch';
  return label;
}

const stops = (x: number) => `${x >= 0 ? '+' : '−'}${Math.abs(x).toFixed(1)}`;
const percent = (x: number) => `${(100 * x).toFixed(0)} %`;

function slider(
  text: string,
  [min, max, step]: readonly [number, number, number],
  value: number,
  told: (value: number) => string,
  change: (value: number) => void,
): HTMLElement {
  const input = element('input', { type: 'range', min: `${min}`, max: `${max}`, step: `${step}` });
  input.value = String(value);
  const shown = element('output', {});
  const tell = () => (shown.textContent = told(input.valueAsNumber));
  tell();
  input.addEventListener('input', () => {
    tell();
    change(input.valueAsNumber);
  });
  const label = labelled(text, input);
  label.append(shown);
  return label;
}

function button(text: string, press: () => void): HTMLButtonElement {
  const made = element('button', { type: 'button' });
  made.textContent = text;
  made.addEventListener('click', press);
  return made;
}
