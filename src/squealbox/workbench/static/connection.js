// The conversation with the server: one JSON text up, one binary frame down. It comes back by itself after a restart.

const TEXT = new TextDecoder();

/** A frame's header with its arrays as Float32Array, each with its shape. */
export function unframed(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(TEXT.decode(new Uint8Array(buffer, 4, length)));
  let at = 4 + length;
  const arrays = {};
  for (const [name, shape] of header.arrays) {
    const size = shape.reduce((a, b) => a * b, 1);
    arrays[name] = new Float32Array(buffer, at, size);
    arrays[name].shape = shape;
    at += 4 * size;
  }
  header.arrays = arrays;
  return header;
}

/** Row i of an array of two dimensions. */
export const row = (array, i) => array.subarray(i * array.shape[1], (i + 1) * array.shape[1]);

export class Disconnected extends Error {}

export class Connection extends EventTarget {
  constructor() {
    super();
    this.waiting = new Map();
    this.next = 1;
    this.pause = 250;
    this.open = false;
  }

  start() {
    this.token ??= new URLSearchParams(location.search).get("token");
    const address = `ws://${location.host}/ws${this.token ? `?token=${encodeURIComponent(this.token)}` : ""}`;
    this.socket = new WebSocket(address);
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = (event) => this.#take(unframed(event.data));
    this.socket.onclose = () => this.#lost();
  }

  /** Ask, and get the answer's frame; `progress` is called with what comes before it. */
  ask(message, progress = null) {
    if (!this.open) return Promise.reject(new Disconnected("not connected"));
    const id = this.next++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject, progress });
      this.socket.send(JSON.stringify({ id, ...message }));
    });
  }

  #take(frame) {
    if (frame.kind === "hello") {
      if (location.search) history.replaceState(null, "", location.pathname + location.hash); // a cookie holds the token now
      this.open = true;
      this.pause = 250;
      this.dispatchEvent(new CustomEvent("hello", { detail: frame }));
      return;
    }
    const asked = this.waiting.get(frame.id);
    if (!asked) return;
    if (frame.kind === "progress") {
      asked.progress?.(frame);
      return;
    }
    this.waiting.delete(frame.id);
    asked.resolve(frame);
  }

  #lost() {
    this.open = false;
    for (const { reject } of this.waiting.values()) reject(new Disconnected("the connection was lost"));
    this.waiting.clear();
    this.dispatchEvent(new Event("lost"));
    setTimeout(() => this.start(), this.pause);
    this.pause = Math.min(2 * this.pause, 2000);
  }
}
