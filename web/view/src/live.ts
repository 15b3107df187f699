// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The web socket to the server, which solves the records that a view lacks; python/eclat/viewer/live.py describes its
// messages. A page that was exported has none.

import { decodeMessage, type Message, type RecordsHeader } from './messages';
import type { Pose } from './pose';

/** How far the server is. */
export interface State {
  readonly kind: 'state';
  readonly solving: boolean;
  readonly passes_left: number;
  readonly records: number;
}

export interface LiveHandlers {
  /** Takes in records that are new or have changed. */
  records(message: Message<RecordsHeader>): void;
  /** Is told how far the server is; nothing where the connection is lost. */
  state(state: State | undefined): void;
}

/** Milliseconds after which a lost connection is tried again. */
const PAUSE = 2000;

export class Live {
  private socket: WebSocket | undefined;
  private latest: string | undefined;

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
    this.latest = JSON.stringify({
      kind: 'wish',
      view: {
        to_world: pose.toWorld.clone().transpose().toArray(),
        half_extent: pose.extent(width / height),
        shift: pose.shift,
        orthographic: pose.orthographic,
        size: [width, height],
      },
    });
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(this.latest);
  }

  private open(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = 'arraybuffer';
    socket.addEventListener('open', () => this.latest && socket.send(this.latest));
    socket.addEventListener('message', ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === 'string') this.handlers.state(JSON.parse(data) as State);
      else this.handlers.records(decodeMessage<RecordsHeader>(data, 'records'));
    });
    socket.addEventListener('close', () => {
      this.handlers.state(undefined);
      window.setTimeout(() => this.open(), PAUSE);
    });
    this.socket = socket;
  }
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
