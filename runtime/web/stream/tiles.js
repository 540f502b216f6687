// A plugin for 3d-tiles-renderer. See tiles.d.ts for what it does.
import { Object3D } from 'three';
import { CameraView } from './camera_view.js';
import { Cells, pagePriority } from './cells.js';
import { ABSENT, CHUNK, FAILED, fetchFile, LOADING, openFront, PRESENT, readChunk } from './format.js';

const certain = 1e9;  // pixels: a screen-space error that no limit exceeds
const relistAfter = 100;  // milliseconds of movement between two lists of chunks

const pageOf = (tile) => tile.extras?.sightcell?.page;

export class CellTilesPlugin {
  name = 'SIGHTCELL_CELL_TILES_PLUGIN';
  #url;
  #onError;
  #tiles;
  #front = null;
  #cells;
  #failed = false;
  #view = new CameraView(2);
  #space = new Object3D();  // of the scene: Y up, where tiles have Z up
  #places = new Map();  // by page: its place in the list of the cell
  #needed = new WeakMap();  // by tile, for the cell
  #before;  // order of the queue
  #marked = false;
  #listed = 0;  // time of the list of chunks

  constructor(url, { onError = ({ message }) => console.warn(message) } = {}) {
    this.#url = url;
    this.#onError = onError;
    this.#space.rotation.x = Math.PI / 2;
  }

  get cell() {
    return this.#cells?.cell?.number ?? -1;
  }

  get complete() {
    return this.#cells !== undefined && !this.#cells.unknown && this.#cells.complete === this.#cells.cell;
  }

  visible(tile) {
    if (this.#failed) return true;
    if (this.#cells?.cell == null) return false;
    let needed = this.#needed.get(tile);
    if (needed === undefined) {
      const page = pageOf(tile);
      needed = page === undefined ? tile.children?.some((child) => this.visible(child)) === true : this.#needs(page);
      this.#needed.set(tile, needed);
    }
    return needed;
  }

  #needs(page) {
    const { everywhere } = this.#front,
      { complete } = this.#cells;
    return this.#places.has(page) || everywhere.pages.includes(page) || complete?.pages.includes(page) === true;
  }

  priority(tile) {
    const page = pageOf(tile),
      place = this.#places.get(page);
    if (page === undefined || this.#front?.everywhere.pages.includes(page)) return Infinity;
    if (place === undefined) return 0;
    return pagePriority(this.#cells.cell, place, this.#front.pages[page], this.#view);
  }

  // Called by 3d-tiles-renderer.

  init(tiles) {
    this.#tiles = tiles;
    this.#space.parent = tiles.group;
    this.#before = tiles.downloadQueue.priorityCallback;
    // The queue begins with its last tile. It can have tiles of others.
    const isOwn = (tile) => tile.internal?.renderer === tiles && pageOf(tile) !== undefined;
    tiles.downloadQueue.priorityCallback = (a, b) => {
      const difference = isOwn(a) && isOwn(b) ? this.priority(a) - this.priority(b) : 0;
      return difference || (this.#before?.(a, b) ?? 0);
    };
    for (const [type, listener] of this.#listeners) tiles.addEventListener(type, listener);
    this.#open().catch((error) => {
      this.#failed = true;
      this.#onError(error);
      tiles.dispatchEvent({ type: 'needs-update' });
    });
  }

  dispose() {
    for (const [type, listener] of this.#listeners) this.#tiles.removeEventListener(type, listener);
    this.#tiles.downloadQueue.priorityCallback = this.#before;
  }

  calculateTileViewError(tile, target) {
    if (this.#failed) return false;
    target.inView = this.visible(tile);
    target.error = certain;
    return true;
  }

  #setState(tile, state) {
    const file = this.#front?.pages[tile === null ? undefined : pageOf(tile)];
    if (file === undefined) return;
    file.state = state;
    this.#count();
  }

  #listeners = Object.entries({
    'update-before': () => this.#move(),
    'load-model': ({ tile }) => this.#setState(tile, PRESENT),
    'dispose-model': ({ tile }) => this.#setState(tile, ABSENT),
    'load-error': ({ tile }) => this.#setState(tile, FAILED),
  });

  async #open() {
    const front = await openFront(this.#url);
    this.#cells = new Cells(front);
    this.#front = front;
    for (const image of front.images) image.shown = 0;  // tiles load their images themselves
    this.#tiles.dispatchEvent({ type: 'needs-update' });
  }

  /** Pages without a tile are never there. */
  #markTiles() {
    const { root } = this.#tiles;
    if (!root || this.#marked) return;
    this.#marked = true;
    const pages = new Set();
    const collect = (tile) => {
      pages.add(pageOf(tile));
      tile.children?.forEach(collect);
    };
    collect(root);
    this.#front.pages.forEach((file, page) => {
      if (!pages.has(page)) file.state = FAILED;
    });
  }

  #move() {
    const [camera] = this.#tiles.cameras;
    if (this.#front === null || camera === undefined) return;
    this.#markTiles();
    const now = performance.now();
    if (!this.#view.move(camera, this.#space, now)) return;
    this.#view.look();
    if (this.#cells.move(this.#view.eye)) this.#changed();
    if (!this.#cells.unknown && now - this.#listed < relistAfter) return;
    this.#listed = now;
    const wanted = this.#cells.requests(this.#view).list;
    for (const file of wanted) if (file.kind === CHUNK) this.#load(file);
  }

  #changed() {
    this.#places.clear();
    this.#cells.cell.pages.forEach((page, i) => this.#places.set(page, i));
    this.#needed = new WeakMap();
    this.#count();
  }

  #count() {
    const { complete } = this.#cells;
    this.#cells.count();
    if (complete !== this.#cells.complete) this.#needed = new WeakMap();
    this.#tiles.dispatchEvent({ type: 'needs-update' });
  }

  async #load(chunk) {
    chunk.state = LOADING;
    try {
      chunk.cells = await readChunk(await fetchFile(chunk), chunk, this.#front);
      chunk.state = PRESENT;
      this.#failed = false;
    } catch (error) {
      chunk.state = error.id === 'io' ? ABSENT : FAILED;  // ABSENT: again when the camera moves
      this.#failed = this.#cells.cell === null;
      this.#onError(error);
    }
    if (this.#cells.move(this.#view.eye)) this.#changed();
    this.#tiles.dispatchEvent({ type: 'needs-update' });
  }
}
