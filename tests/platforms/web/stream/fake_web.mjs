// The package beside three.js in an empty project, and what it needs of a browser: a server whose answers a test
// decides, images that are counted, and time that passes as fast as a test likes.
import { webcrypto } from "node:crypto";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { require } from "../host.mjs";

export const base = "https://host/site/";

export function project_of(folder, three) {
  const project = mkdtempSync(join(tmpdir(), "sightcell-test-"));
  process.on("exit", () => rmSync(project, { recursive: true }));
  const modules = join(project, "node_modules");
  mkdirSync(modules);
  cpSync(folder, join(modules, "sightcell-stream"), { recursive: true });
  symlinkSync(resolve(three), join(modules, "three"));
  const load = (name) => import(pathToFileURL(join(modules, name)).href);
  return { project, load };
}

// Faults by name: a function that gets the number of the request, from 1, and returns "network", a status, a function
// that changes the bytes, or nothing. Requests that `holds` accepts wait for release().
export class FakeServer {
  log = [];  // { name, init }
  active = 0;
  most_active = 0;
  faults = new Map();
  contents = new Map();  // in place of files
  holds = () => false;
  #held = new Set();
  #random = 1;

  constructor(folder) {
    this.folder = folder;
    globalThis.fetch = (url, init) => this.#answer(String(url), init ?? {});
  }

  names(pattern = /./) {
    return this.log.map(({ name }) => name).filter((name) => pattern.test(name));
  }

  held() {
    return Array.from(this.#held, ({ name }) => name);
  }

  // Lets some of the held requests go; all without an argument.
  release(accepts = () => true) {
    for (const request of this.#held) if (accepts(request.name)) request.go();
  }

  #wait(name, signal) {
    this.#random = (this.#random * 48271) % 2147483647;
    const pause = this.#random % 8;
    return new Promise((go, stop) => {
      const request = { name, go };
      const end = (act) => (value) => {
        this.#held.delete(request);
        act(value);
      };
      request.go = end(go);
      signal?.addEventListener("abort", () => end(stop)(signal.reason));
      if (this.holds(name)) this.#held.add(request);
      else real_timeout(request.go, pause);
    });
  }

  async #answer(url, init) {
    require(url.startsWith(base), url);
    const name = url.slice(base.length);
    this.log.push({ name, init });
    this.most_active = Math.max(this.most_active, ++this.active);
    try {
      await this.#wait(name, init.signal);
      const fault = this.faults.get(name)?.(this.names().filter((each) => each === name).length);
      if (fault === "network") throw new TypeError("fetch failed");
      if (typeof fault === "number") return { ok: false, status: fault };
      const bytes = this.contents.get(name) ?? readFileSync(join(this.folder, name));
      const sent = typeof fault === "function" ? fault(Buffer.from(bytes)) : bytes;
      return { ok: true, status: 200, arrayBuffer: async () => new Uint8Array(sent).buffer };
    } finally {
      --this.active;
    }
  }
}

// Sizes of PNG and of lossy WebP with or without alpha.
function size_of(bytes) {
  if (bytes.toString("latin1", 1, 4) === "PNG") return [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
  const kind = bytes.toString("latin1", 12, 16);
  if (kind === "VP8X") return [1 + bytes.readUIntLE(24, 3), 1 + bytes.readUIntLE(27, 3)];
  require(kind === "VP8 ", `an image of type ${kind}`);
  return [bytes.readUInt16LE(26) & 0x3fff, bytes.readUInt16LE(28) & 0x3fff];
}

export const bitmaps = { open: 0, made: 0 };
globalThis.self = globalThis;
globalThis.createImageBitmap = async (blob) => {
  const bytes = Buffer.from(await blob.arrayBuffer());
  if (bytes.length < 32) throw new Error("no image");
  const [width, height] = size_of(bytes);
  ++bitmaps.made;
  ++bitmaps.open;
  let is_open = true;
  return {
    width,
    height,
    close() {
      require(is_open, "an image is closed twice");
      is_open = false;
      --bitmaps.open;
    },
  };
};

globalThis.crypto ??= webcrypto;  // node 18 has it under a flag

const real_timeout = globalThis.setTimeout,
  real = globalThis.performance,
  real_now = () => real.now();
export const clock = { skipped: 0, hurry: 1 };  // milliseconds; timers end so many times sooner
globalThis.setTimeout = (act, time, ...rest) => real_timeout(act, time / clock.hurry, ...rest);
// In node 18 performance.now cannot be assigned.
Object.defineProperty(globalThis, "performance", {
  value: { now: () => real_now() + clock.skipped, getEntriesByName: (name) => real.getEntriesByName(name) },
});

export async function until(condition, what) {
  const end = real_now() + 20000;
  while (!condition()) {
    require(real_now() < end, `${what}: not within 20 s`);
    await new Promise((go) => real_timeout(go, 1));
  }
}

// Time for what should not happen.
export const pause = (milliseconds = 40) => new Promise((go) => real_timeout(go, milliseconds));
