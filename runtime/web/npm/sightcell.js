// The module and the files that it has open. See sightcell.d.ts for what each function does.
import { Database } from './database.js';
import { badArgument, SightcellError } from './error.js';
import { Heap } from './heap.js';
import { constants } from './layout.js';

export { SightcellError } from './error.js';

/** Which lines View.debugLines returns. */
export const DebugLines = Object.freeze({
  cell: constants.DEBUG_CELL,
  kept: constants.DEBUG_KEPT,
  neighbors: constants.DEBUG_NEIGHBORS,
  volumes: constants.DEBUG_VOLUMES,
  outsideRegion: constants.DEBUG_OUTSIDE_REGION,
});

// A bundler that resolved this name would fail for pages, which never reach the import.
const files = 'node:fs/promises';

async function bytesOf(url, init) {
  const where = new URL(url, globalThis.document?.baseURI);
  try {
    if (where.protocol === 'file:') {
      const { readFile } = await import(/* webpackIgnore: true */ /* @vite-ignore */ files);
      return await readFile(where);
    }
    const response = await fetch(where, init);
    if (!response.ok) throw new Error(`status ${response.status}`);
    return new Uint8Array(await response.arrayBuffer());
  } catch (error) {
    if (error.name === 'AbortError') throw error;  // the caller's own signal
    throw new SightcellError('io', `sightcell: ${where}: ${error.message}`, { cause: error });
  }
}

function asBytes(value, what) {
  if (ArrayBuffer.isView(value)) return new Uint8Array(value.buffer, value.byteOffset, value.byteLength);
  const shared = typeof SharedArrayBuffer !== 'undefined' && value instanceof SharedArrayBuffer;
  if (value instanceof ArrayBuffer || shared) return new Uint8Array(value);
  throw badArgument(`${what} takes an ArrayBuffer or a view of one`);
}

async function instanceOf(wasm) {
  if (wasm instanceof WebAssembly.Module) return WebAssembly.instantiate(wasm);
  if (typeof wasm === 'string' || wasm instanceof URL) wasm = await bytesOf(wasm);
  return (await WebAssembly.instantiate(wasm)).instance;
}

export class Sightcell {
  #heap;
  #databases = new Set();

  constructor(heap) { this.#heap = heap; }

  static async load({ wasm = new URL('sightcell.wasm', import.meta.url) } = {}) {
    const { exports } = await instanceOf(wasm);
    const version = exports.sightcell_version?.();
    if (version !== constants.API_VERSION) {
      throw new SightcellError('version', `sightcell: the module has version ${version} of the interface, and this ` +
        `package was made for ${constants.API_VERSION}. Serve the sightcell.wasm of this package.`);
    }
    return new Sightcell(new Heap(exports));
  }

  open(bytes) {
    if (this.#heap === null) throw new SightcellError('disposed', 'sightcell: open() after dispose()');
    const database = Database.open(this.#heap, asBytes(bytes, 'open()'), () => this.#databases.delete(database));
    this.#databases.add(database);
    return database;
  }

  async openUrl(url, init) {
    return this.open(await bytesOf(url, init));
  }

  dispose() {
    for (const database of this.#databases) database.dispose();
    this.#heap = null;
  }

  get disposed() { return this.#heap === null; }
  get memoryBytes() { return this.#heap === null ? 0 : this.#heap.c.memory.buffer.byteLength; }
}
