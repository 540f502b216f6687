// The module and the files that it has open. See sightcell.d.ts for what each function does.
import { Database } from './database.js';
import { badArgument, SightcellError } from './error.js';
import { pvsOfGlb } from './glb.js';
import { Heap } from './heap.js';
import { constants } from './layout.js';
import { beginningOf, bodyOf, download, Pages } from './pages.js';

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

const urlOf = (url) => new URL(url, globalThis.document?.baseURI);

async function bytesOf(url, init) {
  if (url.protocol !== 'file:') return download(url, init, bodyOf);
  try {
    const { readFile } = await import(/* webpackIgnore: true */ /* @vite-ignore */ files);
    return await readFile(url);
  } catch (error) {
    throw new SightcellError('io', `sightcell: ${url}: ${error.message}`, { cause: error });
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
  if (typeof wasm === 'string' || wasm instanceof URL) wasm = await bytesOf(urlOf(wasm));
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

  #use(what) {
    if (this.#heap === null) throw new SightcellError('disposed', `sightcell: ${what} after dispose()`);
    return this.#heap;
  }

  #add(open) {
    const database = open(() => this.#databases.delete(database));
    this.#databases.add(database);
    return database;
  }

  open(bytes) {
    const heap = this.#use('open()');
    return this.#add((closed) => Database.open(heap, pvsOfGlb(asBytes(bytes, 'open()')), closed));
  }

  async openUrl(url, options = {}) {
    const { whole = false, firstBytes = 65536, residentBytes = 2 ** 24, pageLoaded, pageFailed, ...init } = options;
    const where = urlOf(url);
    const openWhole = async () => this.open(await bytesOf(where, init));
    if (whole || where.protocol === 'file:') return openWhole();
    const first = await beginningOf(where, init, firstBytes);
    if (first.bytes.length === first.size) return this.open(first.bytes);
    const pages = new Pages(this.#use('openUrl()'), where, init, first, { pageLoaded, pageFailed });
    let db;
    try {
      db = await pages.open(residentBytes);
    } catch (error) {
      if (error.id === 'capacity') return openWhole();  // a page can be larger than residentBytes
      throw error;
    }
    try {
      return this.#add((closed) => Database.ofPages(this.#use('openUrl()'), db, () => {
        closed();
        pages.close();
      }));
    } catch (error) {
      pages.close(db);
      throw error;
    }
  }

  dispose() {
    for (const database of this.#databases) database.dispose();
    this.#heap = null;
  }

  get disposed() { return this.#heap === null; }
  get memoryBytes() { return this.#heap === null ? 0 : this.#heap.c.memory.buffer.byteLength; }
}
