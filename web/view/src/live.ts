// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The web socket to the server, which solves the records that a view lacks; python/eclat/viewer/live.py describes its
// messages. A page that was exported has none.

import { decodeAny, type GlossHeader, type HemisphereHeader, type Message, type RecordsHeader, type TruthHeader } from './messages';
import type { Pose } from './pose';
import type { Way } from './truth';

/** How far the server is. */
export interface State {
  readonly kind: 'state';
  readonly solving: boolean;
  readonly passes_left: number;
  readonly everywhere: boolean;
  readonly records: number;
}

export interface LiveHandlers {
  /** Takes in records that are new or have changed. */
  records(message: Message<RecordsHeader>): void;
  /** Takes in records of radiance. */
  gloss(message: Message<GlossHeader>): void;
  /** Takes in what a record sees. */
  hemisphere(message: Message<HemisphereHeader>): void;
  /** Takes in a picture of the server. */
  truth(message: Message<TruthHeader>): void;
  /** Is told how far the server is; nothing where the connection is lost. */
  state(state: State | undefined): void;
}

/** Milliseconds after which a lost connection is tried again. */
const PAUSE = 2000;

export class Live {
  private socket: WebSocket | undefined;
  /** The latest requests, which a connection that was lost must hear again. */
  private wished: string | undefined;
  private rendered: string | undefined;
  private inspected: string | undefined;

  /** Returns the connection to the server of this page, or nothing if it has none. */
  static connect(handlers: LiveHandlers): Live | undefined {
    const name = document.querySelector<HTMLMetaElement>('meta[name="eclat-live"]')?.content;
    return name ? new Live(new URL(name, document.baseURI), handlers) : undefined;
  }

  private constructor(
    private readonly address: URL,
    private readonly handlers: LiveHandlers,
  ) {
    address.protocol = 'ws:';
    this.open();
  }

  /** Asks for the records that this view lacks. */
  wish(pose: Pose, width: number, height: number): void {
    this.wished = JSON.stringify({ kind: 'wish', view: viewOf(pose, width, height) });
    this.send(this.wished);
  }

  /** Asks for pictures of this view, which get better until `stop`; they have the number. */
  truth(pose: Pose, width: number, height: number, by: Way, number: number): void {
    this.rendered = JSON.stringify({ kind: 'truth', view: viewOf(pose, width, height), by, number });
    this.send(this.rendered);
  }

  /** Asks for what a point sees; the answer has the number. */
  hemisphere(place: readonly number[], normal: readonly number[], number: number): void {
    this.inspected = JSON.stringify({ kind: 'hemisphere', place, normal, number });
    this.send(this.inspected);
  }

  /** Ends these pictures. */
  stop(): void {
    this.rendered = undefined;
    this.send(JSON.stringify({ kind: 'stop' }));
  }

  private send(text: string | undefined): void {
    if (text && this.socket?.readyState === WebSocket.OPEN) this.socket.send(text);
  }

  private open(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = 'arraybuffer';
    socket.addEventListener('open', () => [this.wished, this.rendered, this.inspected].forEach((text) => this.send(text)));
    socket.addEventListener('message', ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === 'string') {
        this.handlers.state(JSON.parse(data) as State);
        return;
      }
      const message = decodeAny(data, 'answer of the server');
      if (message.header.kind === 'truth') this.handlers.truth(message as Message<TruthHeader>);
      else if (message.header.kind === 'gloss') this.handlers.gloss(message as Message<GlossHeader>);
      else if (message.header.kind === 'hemisphere') {
        this.inspected = undefined;
        this.handlers.hemisphere(message as Message<HemisphereHeader>);
      }
      else this.handlers.records(message as Message<RecordsHeader>);
    });
    socket.addEventListener('close', () => {
      this.handlers.state(undefined);
      window.setTimeout(() => this.open(), PAUSE);
    });
    this.socket = socket;
  }
}

function viewOf(pose: Pose, width: number, height: number): object {
  return {
    to_world: pose.toWorld.clone().transpose().toArray(),
    half_extent: pose.extent(width / height),
    shift: pose.shift,
    orthographic: pose.orthographic,
    size: [width, height],
  };
}

/** Milliseconds for which a view must rest before its records are asked for. */
const REST = 250;

/** The share of a picture that may lack records without being asked for: cracks at edges, which nobody sees. */
const TOLERATED = 0.002;

/** Asks for the records of a view when it rests and lacks some. */
export class Wishes {
  private moved = 0;
  private asked = false;

  constructor(private readonly ask: () => void) {}

  /** Must be called with every frame; `missing` measures the share of the picture that lacks records. */
  step(now: number, moves: boolean, missing: () => number): void {
    if (moves) {
      this.moved = now;
      this.asked = false;
    }
    if (this.asked || now - this.moved < REST) return;
    this.asked = true;
    if (missing() > TOLERATED) this.ask();
  }
}

/** Tells in words how far the server is. */
export function described(state: State | undefined): string {
  if (!state) return 'The server does not answer; the records so far stay.';
  const records = `${state.records.toLocaleString('en')} records`;
  return state.solving
    ? `Records are missing here; they are being computed: ${records}, ${state.passes_left} passes left.`
    : `${records}.`;
}
