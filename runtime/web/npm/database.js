// An open .pvs file.
import { SightcellError } from './error.js';
import { constants, structs } from './layout.js';
import { View } from './view.js';

const layouts = ['instanced', 'merged'];
const none = 0xFFFFFFFF;

const hex = (bytes) => bytes.map((byte) => byte.toString(16).padStart(2, '0')).join('');

export class Database {
  #heap;
  #db;
  #bytes;
  #closed;
  #paged = false;
  #views = new Set();
  #info;
  #draws;
  #firstStored;

  static open(heap, bytes, closed) {
    const at = heap.put(bytes);
    const status = heap.c.sightcell_db_open(at, bytes.byteLength, 0, heap.scratch);
    const db = heap.written();
    if (status !== constants.OK) {
      heap.free(at);
      heap.require(status, 'open()');
    }
    return new Database(heap, db, at, closed);
  }

  /** A file whose pages arrive later. */
  static ofPages(heap, db, closed) {
    const database = new Database(heap, db, 0, closed);
    database.#paged = true;
    return database;
  }

  constructor(heap, db, bytes, closed) {
    this.#heap = heap;
    this.#db = db;
    this.#bytes = bytes;
    this.#closed = closed;
    const info = heap.readSized('info', 'info', (at) => heap.c.sightcell_db_info(db, at));
    this.#info = Object.freeze({
      ...info,
      layout: layouts[info.layout] ?? `layout ${info.layout}`,
      sceneFingerprint: hex(info.sceneFingerprint),
      volumeCount: heap.c.sightcell_db_volume_count(db) >>> 0,
    });
  }

  #use(what) {
    if (this.#db === 0) throw new SightcellError('disposed', `sightcell: ${what} of a file after dispose()`);
    return this.#heap;
  }

  get disposed() { return this.#db === 0; }
  get info() { return this.#info; }
  get paged() { return this.#paged; }

  /** The draw table, read once: a file has thousands of draws, and a page looks each of them up. */
  get draws() {
    const heap = this.#use('draws');
    this.#draws ??= heap.list(structs.draw.size, 'draws',
      (...to) => heap.c.sightcell_db_draws(this.#db, ...to),
      (at, count) => Object.freeze(Array.from({ length: count }, (_, i) => {
        const draw = heap.read('draw', at + structs.draw.size * i);
        if (draw.material === none) draw.material = -1;
        return Object.freeze(draw);
      })));
    return this.#draws;
  }

  /** The first stored number of each draw, or of each draw group of a merged file: what ranges count from. */
  get firstStored() {
    const merged = this.#info.layout === 'merged';
    if (this.#firstStored === undefined) {
      this.#firstStored = [];
      this.draws.forEach((draw, i) => { this.#firstStored[merged ? draw.group : i] = draw.firstStored; });
    }
    return this.#firstStored;
  }

  order() {
    const heap = this.#use('order()');
    return heap.listOfWords('order()', (...to) => heap.c.sightcell_db_order(this.#db, ...to));
  }

  #box(what, call) {
    const heap = this.#use(what);
    const min = heap.scratch;
    heap.require(call(min, min + 12), what);
    return { min: Array.from(heap.f32.subarray(min / 4, min / 4 + 3)),
      max: Array.from(heap.f32.subarray(min / 4 + 3, min / 4 + 6)) };
  }

  cellBox(cell) {
    return this.#box('cellBox()', (min, max) => this.#heap.c.sightcell_db_cell_box(this.#db, cell, min, max));
  }

  volumeBox(volume) {
    return this.#box('volumeBox()', (min, max) => this.#heap.c.sightcell_db_volume_box(this.#db, volume, min, max));
  }

  cellViewpoints(cell) {
    const heap = this.#use('cellViewpoints()');
    const at = heap.scratch;
    heap.require(heap.c.sightcell_db_cell_viewpoints(this.#db, cell, at, at + 4), 'cellViewpoints()');
    return { validShare: heap.f32[at / 4], outsideShare: heap.f32[at / 4 + 1] };
  }

  namedGroups() {
    const heap = this.#use('namedGroups()');
    const count = heap.c.sightcell_db_named_group_count(this.#db) >>> 0;
    return Array.from({ length: count }, (_, group) => heap.list(1, 'namedGroups()',
      (...to) => heap.c.sightcell_db_named_group_name(this.#db, group, ...to),
      (at, size) => heap.text.decode(heap.u8.subarray(at, at + size))));
  }

  namedGroupsOfDraws() {
    const heap = this.#use('namedGroupsOfDraws()');
    const groups = heap.listOfWords('namedGroupsOfDraws()',
      (...to) => heap.c.sightcell_db_named_groups_of_draws(this.#db, ...to));
    return new Int32Array(groups.buffer);  // SIGHTCELL_NO_NAMED_GROUP becomes -1
  }

  prefetch(position, velocity, seconds) {
    const heap = this.#use('prefetch()');
    const at = heap.scratch;
    heap.putPoint(heap.f32, at / 4, position, 'prefetch()');
    heap.putPoint(heap.f32, at / 4 + 3, velocity, 'prefetch()');
    heap.require(heap.c.sightcell_db_prefetch(this.#db, at, at + 12, seconds), 'prefetch()');
  }

  check() {
    const heap = this.#use('check()');
    heap.require(heap.c.sightcell_db_check(this.#db), 'check()');
  }

  statistics() {
    const heap = this.#use('statistics()');
    return heap.readSized('db_stats', 'statistics()', (at) => heap.c.sightcell_db_statistics(this.#db, at));
  }

  createView() {
    const heap = this.#use('createView()');
    const view = View.create(heap, this.#db, this, () => this.#views.delete(view));
    this.#views.add(view);
    return view;
  }

  dispose() {
    if (this.#db === 0) return;
    for (const view of this.#views) view.dispose();
    this.#heap.c.sightcell_db_close(this.#db);
    this.#heap.free(this.#bytes);
    this.#db = 0;
    this.#closed();
  }
}
