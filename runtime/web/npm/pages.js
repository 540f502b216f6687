// A .pvs file of a server, of which only the pages that are needed are downloaded: the tables at its beginning, and then
// the sets of a few cells at a time. Sightcell.openUrl in sightcell.d.ts describes what a page of the web notices of it.
import { SightcellError } from './error.js';
import { constants, structs } from './layout.js';

const firstWait = 1000, mostWait = 30000;  // milliseconds after which a download that failed is tried again

const ioError = (url, problem, cause) => new SightcellError('io', `sightcell: ${url}: ${problem}`, { cause });

/** Fetches, with errors of ours. The signal of the caller ends with an error of its own. */
export async function download(url, init, use) {
  try {
    return await use(await fetch(url, init));
  } catch (error) {
    if (error.name === 'AbortError' || error instanceof SightcellError) throw error;
    throw ioError(url, error.message, error);
  }
}

export async function bodyOf(response) {
  if (!response.ok) throw new Error(`status ${response.status}`);
  return new Uint8Array(await response.arrayBuffer());
}

// use(response, its Content-Range as numbers; undefined if there is none that a page may read)
function downloadRange(url, init, begin, end, use) {
  const headers = new Headers(init.headers);
  headers.set('Range', `bytes=${begin}-${end - 1}`);
  return download(url, { ...init, headers }, (response) => {
    const [, first, last, size] = response.headers.get('Content-Range')?.match(/^bytes (\d+)-(\d+)\/(\d+)$/) ?? [];
    return use(response, first && { begin: Number(first), end: Number(last) + 1, size: Number(size) });
  });
}

/** The first bytes of a file, and its size. All of it where the server ignores the range, or does not let the page read
 * where a range begins (Access-Control-Expose-Headers). */
export async function beginningOf(url, init, count) {
  const found = await downloadRange(url, init, 0, count, async (response, range) => {
    const unknown = response.status === 206 && range?.begin !== 0;
    if (unknown || response.status === 416) {  // 416: an empty file
      await response.body?.cancel();
      return undefined;
    }
    const bytes = await bodyOf(response);
    const { end, size } = response.status === 206 ? range : { end: bytes.length, size: bytes.length };
    if (bytes.length !== end) throw new Error(`announced bytes 0 to ${end - 1}, and ${bytes.length} bytes arrived`);
    return { bytes, size };
  });
  if (found !== undefined) return found;
  const bytes = await download(url, init, bodyOf);
  return { bytes, size: bytes.length };
}

// The module calls functions of WebAssembly only, so a module of its own forwards its calls:
// (module (import "p" "f" (func (param i32 i64 i32 i32) (result i32))) (export "f" (func 0)))
const forwarding = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 9, 1, 96, 4, 127, 126, 127, 127, 1, 127,
  2, 7, 1, 1, 112, 1, 102, 0, 0, 7, 5, 1, 1, 102, 0, 0);

/** The sources that a module can ask, and the number of the function that it calls for all of them. */
function sourcesOf(heap) {
  if (heap.sources === undefined) {
    const sources = new Map();
    const request = (user, offset, size, ticket) => sources.get(user).request(Number(offset), size >>> 0, ticket);
    const { exports } = new WebAssembly.Instance(new WebAssembly.Module(forwarding), { p: { f: request } });
    const table = heap.c.__indirect_function_table;
    const number = table.grow(1);
    table.set(number, exports.f);
    heap.sources = { sources, number, last: 0 };
  }
  return heap.sources;
}

export class Pages {
  #heap;
  #url;
  #init;
  #known;  // the first bytes of the file
  #size;
  #loaded;
  #failed;
  #number;
  #db = 0;
  #opening = true;
  #closed = new AbortController();
  #answered;  // while the file is opened: a promise of the one answer that the module waits for
  #wait = firstWait;
  #timers = new Set();

  constructor(heap, url, init, { bytes, size }, { pageLoaded, pageFailed }) {
    this.#heap = heap;
    this.#url = url;
    this.#init = init;
    this.#known = bytes;
    this.#size = size;
    this.#loaded = pageLoaded ?? (() => {});
    this.#failed = pageFailed ?? ((error) => console.warn(error.message));
    const all = sourcesOf(heap);
    this.#number = ++all.last;
    all.sources.set(this.#number, this);
  }

  /** Begins to open the file and ends when its tables are there. Returns the address of the db. */
  async open(residentBytes) {
    const { c } = this.#heap;
    let first;  // the bytes with the header, which can have pages, too
    const { members, size } = structs.source;
    let status = this.#heap.borrow(size, (at) => {
      const { data } = this.#heap;
      data.setUint32(at + members.user.at, this.#number, true);
      data.setBigUint64(at + members.size.at, BigInt(this.#size), true);
      data.setUint32(at + members.request.at, sourcesOf(this.#heap).number, true);
      return c.sightcell_db_begin_source(at, 0, BigInt(residentBytes), this.#heap.scratch);
    });
    this.#db = this.#heap.written();
    try {
      while (status === constants.PENDING) {
        await this.#answered;
        first ??= this.#known;
        status = c.sightcell_db_opened(this.#db);
      }
      this.#heap.require(status, 'openUrl()');
    } catch (error) {
      this.close(this.#db);
      throw error;
    }
    this.#opening = false;
    this.#known = first;
    return this.#db;
  }

  /** What the module calls. Answers later, so that no call of the module is inside of another. */
  request(offset, size, ticket) {
    const answered = this.#read(offset, offset + size).then((bytes) => this.#deliver(ticket, bytes));
    if (this.#opening) this.#answered = answered;
    else answered.catch((error) => this.#fail(error, ticket));
    return constants.OK;
  }

  #deliver(ticket, bytes) {
    if (this.#closed.signal.aborted) return;
    const at = this.#heap.put(bytes);
    const status = this.#heap.c.sightcell_db_deliver(this.#db, ticket, at, bytes.length);
    this.#heap.free(at);
    if (this.#opening) return;
    this.#wait = firstWait;
    // The bytes were not wanted any more, or others are wanted more.
    if (status !== constants.ERR_STALE && status !== constants.ERR_CAPACITY) this.#heap.require(status, this.#url);
    this.#loaded();
  }

  // The module asks again as soon as it is told, which is in the next frame. So it is told later.
  #fail(error, ticket) {
    if (this.#closed.signal.aborted) return;
    const timer = setTimeout(() => {
      this.#timers.delete(timer);
      this.#heap.c.sightcell_db_deliver(this.#db, ticket, 0, 0);
    }, this.#wait);
    timer.unref?.();  // in node, nothing waits for it
    this.#timers.add(timer);
    this.#wait = Math.min(2 * this.#wait, mostWait);
    this.#failed(error);
  }

  async #read(begin, end) {
    const known = this.#known;
    if (end <= known.length) return known.subarray(begin, end);
    const from = Math.max(begin, known.length);
    // The caller's signal is for opening: one that ends after a time would end all later downloads.
    const init = this.#opening ? this.#init : { ...this.#init, signal: this.#closed.signal };
    const rest = await downloadRange(this.#url, init, from, end, async (response, range) => {
      const bytes = await bodyOf(response);
      const whole = response.status === 200 && bytes.length === this.#size;  // the server ignores ranges from now on
      const right = range?.begin === from && range.size === this.#size && bytes.length === end - from;
      if (!whole && !right) {
        const sent = range ? `bytes ${range.begin} to ${range.end - 1} of ${range.size}` : 'no range';
        throw new Error(`asked for bytes ${from} to ${end - 1} of ${this.#size}, the server sent ${bytes.length} bytes ` +
          `and stated ${sent}. If the file has changed, open it again.`);
      }
      if (!whole) return bytes;
      this.#known = bytes;
      return bytes.subarray(from, end);
    });
    if (from === begin) return rest;
    const all = new Uint8Array(end - begin);
    all.set(known.subarray(begin));
    all.set(rest, from - begin);
    if (this.#opening) this.#known = all;  // the module asks for the first bytes twice: the header, then all tables
    return all;
  }

  /** After the db is closed, or to close it. */
  close(db = 0) {
    this.#heap.c.sightcell_db_close(db);
    this.#closed.abort();
    for (const timer of this.#timers) clearTimeout(timer);
    sourcesOf(this.#heap).sources.delete(this.#number);
  }
}
