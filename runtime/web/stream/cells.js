// Which cell the camera is in, and which files it needs next: the policy of docs/streaming.md, "What a client does".
import { ABSENT, FAILED, LOADING, PRESENT } from './format.js';

/** Why a file is requested, in this order. */
export const LOOKUP = 0,
  ALL = 1,
  CELL = 2,
  DETAIL = 3,
  NEXT = 4;

const leastAhead = 1 / 64;  // of a page that the view probably does not show, where one that it shows whole has 1
const walkingSpeed = 1.5;  // meters per second: a camera that stands still may start to walk
const turn = 0.5;  // sideways distance per distance traveled
const timeSteps = 16;
const nextCells = 64;

const holds = (box, { x, y, z }) => x >= box[0] && x < box[3] && y >= box[1] && y < box[4] && z >= box[2] && z < box[5];
const volume = (box) => (box[3] - box[0]) * (box[4] - box[1]) * (box[5] - box[2]);
const beyond = (min, max, at) => Math.max(min - at, at - max, 0);

function squaredDistance(box, x, y, z) {
  return beyond(box[0], box[3], x) ** 2 + beyond(box[1], box[4], y) ** 2 + beyond(box[2], box[5], z) ** 2;
}

const nearest = (list, { x, y, z }) => {
  const away = list.map(({ box }) => squaredDistance(box, x, y, z));
  return list[away.indexOf(Math.min(...away))] ?? null;
};

/** The weight in steradians of the i-th page of a cell, or with `imageShares` of an image. */
export const weightOf = (cell, i, shares = cell.shares) => cell.weight * 2 ** (-shares[i] / 8);

const priorityOf = (file, weight) => weight / file.bytes;

/** How much of what has these headings is in the view, 0 to 1. */
function shareAhead(headings, { sectors }) {
  let sum = 0,
    count = 0;
  for (let k = 0; k < 8; ++k) {
    const has = (headings >> k) & 1;
    sum += has * sectors[k];
    count += has;
  }
  return count > 0 ? sum / count : 0;
}

/** That of the i-th page of a cell. */
export function pagePriority(cell, i, page, view) {
  const share = view.sees(page.box) ? shareAhead(cell.headings[i], view) : 0;
  return priorityOf(page, weightOf(cell, i) * Math.max(share, leastAhead));
}

export class Cells {
  cell = null;  // of the camera
  complete = null;  // the last one that had all its files
  unknown = true;  // a chunk that may have the cell is not there yet
  outside = false;
  clock = 1;  // increases with each change of the cell
  #stamp = 0;

  constructor(front) {
    this.front = front;
  }

  /** Allocates nothing once a cell is known. Returns whether the cell is another one. */
  move(eye) {
    let found = null;
    this.unknown = false;
    for (const chunk of this.front.chunks) {
      if (!holds(chunk.box, eye)) continue;
      if (chunk.cells === null) {
        this.unknown ||= chunk.state !== FAILED;
        continue;
      }
      for (const cell of chunk.cells) {
        if (!holds(cell.box, eye)) continue;
        const difference = found === null ? -1 : volume(cell.box) - volume(found.box);
        if (difference < 0 || (difference === 0 && cell.number < found.number)) found = cell;
      }
    }
    this.outside = found === null;
    if (found === null && this.cell === null) {
      const chunk = this.#nearestChunk(eye);
      if (chunk?.cells) found = nearest(chunk.cells, eye);
      this.unknown ||= chunk !== null && found === null;
    }
    found ??= this.cell;
    if (found === this.cell) return false;
    if (this.cell !== null) this.touch(this.cell);
    this.cell = found;
    ++this.clock;
    return true;
  }

  #nearestChunk(eye) {
    return nearest(
      this.front.chunks.filter(({ state }) => state !== FAILED),
      eye,
    );
  }

  /** Marks the files of a cell as needed now. */
  touch(cell) {
    for (const page of cell.pages) this.front.pages[page].needed = this.clock;
    for (const image of cell.images) for (const file of this.front.images[image].files) file.needed = this.clock;
  }

  /** Files that are there and that no cell needs now, those first that were needed least recently. */
  removable() {
    ++this.clock;
    for (const cell of [this.front.everywhere, this.cell, this.complete]) if (cell !== null) this.touch(cell);
    const unused = ({ state, needed, cells }) => state === PRESENT && needed < this.clock && cells === undefined;
    return this.front.files.filter(unused).sort((a, b) => a.needed - b.needed);
  }

  /** An image has a file, or never will. */
  settled(image) {
    const { files, shown } = this.front.images[image];
    return shown >= 0 || files.every(({ state }) => state === FAILED);
  }

  /** Weights, and files that are missing, of the cell. A cell that misses none becomes the complete one. */
  count() {
    const { cell, front } = this;
    const sum = { weight: 0, present: 0, missing: 0, failed: 0 };
    const count = (page, weight) => {
      const { state } = front.pages[page];
      sum.weight += weight;
      if (state === PRESENT) sum.present += weight;
      else if (state === FAILED) ++sum.failed;
      else ++sum.missing;
    };
    for (const page of front.everywhere.pages) count(page, 0);
    cell?.pages.forEach((page, i) => count(page, weightOf(cell, i)));
    for (const list of [front.everywhere.images, cell?.images ?? []]) {
      for (const image of list) sum.missing += Number(!this.settled(image));
    }
    if (sum.missing === 0 && cell !== null) this.complete = cell;
    return sum;
  }

  /** Meters from the eye to the nearest box of a page that is still to come, of the cell or of all cells. */
  clearDistance({ x, y, z }) {
    if (this.unknown) return 0;
    let least = Infinity;
    for (const pages of [this.front.everywhere.pages, this.cell?.pages ?? []]) {
      for (const page of pages) {
        const { state, box } = this.front.pages[page];
        if (state !== PRESENT && state !== FAILED) least = Math.min(least, squaredDistance(box, x, y, z));
      }
    }
    return Math.sqrt(least);
  }

  /** Files to load, in order. All files that are wanted get the stamp that is returned, also those on their way.
   * view: { eye, velocity, seconds, sees(box), sectors }. */
  requests(view) {
    const { front, cell } = this;
    const stamp = ++this.#stamp,
      list = [];
    let part = [];
    const add = (file, reason, priority = 0) => {
      if (file.wanted === stamp) return;
      file.wanted = stamp;
      if (file.state !== ABSENT) return;
      file.reason = reason;
      file.priority = priority;
      part.push(file);
    };
    const end = () => {
      list.push(...part.sort((a, b) => b.priority - a.priority));
      part = [];
    };
    // The smallest file of an image; larger: the one after the largest that is there.
    const addImage = ({ files, shown }, reason, weight, larger) => {
      for (const file of files) if (file.state === LOADING) file.wanted = stamp;
      if (shown >= 0 !== larger || files.some(({ state }) => state === LOADING)) return;
      const file = files.find(({ state }, i) => state === ABSENT && i > shown);
      if (file) add(file, reason, priorityOf(file, weight));
    };
    const addCell = (from, reason) => {
      from.pages.forEach((page, i) => {
        const file = front.pages[page];
        add(file, reason, file.state === ABSENT ? pagePriority(from, i, file, view) : 0);
      });
      from.images.forEach((image, i) =>
        addImage(front.images[image], reason, weightOf(from, i, from.imageShares), false),
      );
      end();
    };
    for (const chunk of front.chunks) if (holds(chunk.box, view.eye)) add(chunk, LOOKUP);
    if (cell === null && part.length === 0) {
      const chunk = this.#nearestChunk(view.eye);
      if (chunk !== null) add(chunk, LOOKUP);
    }
    end();
    for (const page of front.everywhere.pages) add(front.pages[page], ALL);
    for (const image of front.everywhere.images) addImage(front.images[image], ALL, 0, false);
    end();
    if (cell !== null) {
      addCell(cell, CELL);
      cell.images.forEach((image, i) =>
        addImage(front.images[image], DETAIL, weightOf(cell, i, cell.imageShares), true),
      );
    }
    for (const image of front.everywhere.images) addImage(front.images[image], DETAIL, 0, true);
    end();
    for (const next of this.#next(view)) {
      if (next.cells === undefined) {
        this.touch(next);
        addCell(next, NEXT);
      } else {
        add(next, NEXT);
        end();
      }
    }
    return { list, stamp };
  }

  /** Chunks that are not there and cells that the camera can reach soon, in this order. */
  #next({ eye, velocity, seconds }) {
    const speed = Math.hypot(velocity.x, velocity.y, velocity.z);
    const reached = [];
    const reach = (what) => {
      for (let step = 0; step <= timeSteps; ++step) {
        const time = (seconds * step) / timeSteps;
        const squared = squaredDistance(
          what.box,
          eye.x + velocity.x * time,
          eye.y + velocity.y * time,
          eye.z + velocity.z * time,
        );
        // Plus half the distance of a step, so that consecutive steps leave no gap.
        const radius = turn * Math.max(speed, walkingSpeed) * time + (0.5 * speed * seconds) / timeSteps;
        if (squared <= radius * radius) return { what, step, squared };
      }
      return null;
    };
    for (const chunk of seconds > 0 ? this.front.chunks : []) {
      const first = reach(chunk);
      if (first === null) continue;
      if (chunk.cells === null) reached.push(first);
      else for (const cell of chunk.cells) reached.push(reach(cell));
    }
    return reached
      .filter((each) => each !== null)
      .sort((a, b) => a.step - b.step || a.squared - b.squared)
      .slice(0, nextCells)
      .map(({ what }) => what);
  }
}
