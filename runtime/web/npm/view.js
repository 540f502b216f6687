// A camera in an open file. What its functions return is in memory of JavaScript and not of the module: copies of a few
// kilobytes, made when the set changes, cost less than arrays that lose their elements when another file is opened.
import { badArgument, SightcellError } from './error.js';
import { constants, structs } from './layout.js';

const policies = { all: constants.OUTSIDE_ALL, nearest: constants.OUTSIDE_NEAREST, last: constants.OUTSIDE_LAST };
const pendingPolicies = { all: 0, last: constants.PENDING_LAST };

/** The result of a move. A view has one, which each of its moves fills again. */
class Frame {
  cell = -1;
  flags = 0;
  polygonCount = 0;
  revision = 0;

  get changed() { return (this.flags & constants.FRAME_CHANGED) !== 0; }
  get drawAll() { return (this.flags & constants.FRAME_DRAW_ALL) !== 0; }
  get outside() { return (this.flags & constants.FRAME_OUTSIDE) !== 0; }
  get pending() { return (this.flags & constants.FRAME_PENDING) !== 0; }
  get damaged() { return (this.flags & constants.FRAME_DAMAGED) !== 0; }
}

const { members: frameMembers } = structs.frame;

export class View {
  #heap;
  #view;
  #frameAt;
  #rangesAt;
  #bitsAt;
  #closed;
  #frame = new Frame();
  #moves = 0;
  #ranges;
  #objects;
  #rangesOf = -1;  // the move whose ranges are in #ranges.list
  #objectsOf = -1;

  static create(heap, db, database, closed) {
    heap.require(heap.c.sightcell_view_create(db, heap.scratch), 'createView()');
    return new View(heap, heap.written(), database, closed);
  }

  constructor(heap, view, database, closed) {
    const { rangeBound, drawCount } = database.info;
    this.database = database;
    this.#heap = heap;
    this.#view = view;
    this.#closed = closed;
    const words = 2 * Math.ceil(drawCount / 64);
    try {  // one block for the frame and the lists, so that no move allocates
      this.#frameAt = heap.allocate(structs.frame.size + structs.range.size * rangeBound + 8 + 4 * words);
    } catch (error) {
      heap.c.sightcell_view_destroy(view);
      throw error;
    }
    this.#bitsAt = this.#frameAt + structs.frame.size;
    this.#rangesAt = this.#bitsAt + 4 * words;
    this.#ranges = { all: new Uint32Array(3 * rangeBound), list: new Uint32Array(0) };
    this.#objects = new Uint8Array(drawCount);
  }

  #use(what) {
    if (this.#view === 0) throw new SightcellError('disposed', `sightcell: ${what} of a view after dispose()`);
    return this.#heap;
  }

  get disposed() { return this.#view === 0; }
  get frame() { return this.#frame; }

  /** Puts the corners of a box in the scratch block. */
  #putBox(heap, box, what) {
    const at = heap.scratch;
    heap.putPoint(heap.f32, at / 4, box?.min, what);
    heap.putPoint(heap.f32, at / 4 + 3, box?.max, what);
    return at;
  }

  #moved(heap, status, what) {
    // A position that is no number moves the view, too: it returns everything. So the frame is read before the error.
    const word = (name) => heap.u32[(this.#frameAt + frameMembers[name].at) / 4];
    const frame = this.#frame;
    frame.cell = word('cell') | 0;  // SIGHTCELL_NO_CELL becomes -1
    frame.flags = word('flags');
    frame.polygonCount = word('polygon_count');
    frame.revision = word('revision');
    if (frame.changed || status !== constants.OK) ++this.#moves;
    heap.require(status, what);
    return frame;
  }

  move(position) {
    const heap = this.#use('move()');
    heap.putPoint(heap.f32, heap.scratch / 4, position, 'move()');
    return this.#moved(heap, heap.c.sightcell_view_move(this.#view, heap.scratch, this.#frameAt), 'move()');
  }

  moveBox(box) {
    const heap = this.#use('moveBox()');
    const at = this.#putBox(heap, box, 'moveBox()');
    return this.#moved(heap, heap.c.sightcell_view_move_box(this.#view, at, at + 12, this.#frameAt), 'moveBox()');
  }

  setOrigin(origin) {
    const heap = this.#use('setOrigin()');
    heap.putPoint(heap.f64, heap.scratch / 8, origin, 'setOrigin()');
    heap.require(heap.c.sightcell_view_origin(this.#view, heap.scratch), 'setOrigin()');
  }

  setPolicy(outside, maxDistance = Infinity, whilePending = 'all') {
    const heap = this.#use('setPolicy()');
    if (!Object.hasOwn(policies, outside)) throw badArgument('setPolicy() takes "all", "nearest" or "last"');
    if (!Object.hasOwn(pendingPolicies, whilePending)) throw badArgument('setPolicy() takes "all" or "last" at the end');
    const policy = policies[outside] + pendingPolicies[whilePending];
    heap.require(heap.c.sightcell_view_policy(this.#view, policy, maxDistance), 'setPolicy()');
  }

  showNamedGroup(group, shown) {
    const heap = this.#use('showNamedGroup()');
    const number = typeof group === 'string' ? this.database.namedGroups().indexOf(group) : group;
    heap.require(heap.c.sightcell_view_show_named_group(this.#view, number, shown ? 1 : 0), 'showNamedGroup()');
  }

  ranges() {
    const heap = this.#use('ranges()');
    if (this.#rangesOf === this.#moves) return this.#ranges.list;
    const status = heap.c.sightcell_view_ranges(this.#view, this.#rangesAt, this.database.info.rangeBound, heap.scratch);
    heap.require(status, 'ranges()');
    const count = 3 * heap.written();
    this.#ranges.all.set(heap.u32.subarray(this.#rangesAt / 4, this.#rangesAt / 4 + count));
    this.#ranges.list = this.#ranges.all.subarray(0, count);
    this.#rangesOf = this.#moves;
    return this.#ranges.list;
  }

  objects() {
    const heap = this.#use('objects()');
    if (this.#objectsOf === this.#moves) return this.#objects;
    const status = heap.c.sightcell_view_objects(this.#view, this.#bitsAt, Math.ceil(this.#objects.length / 64));
    heap.require(status, 'objects()');
    const bits = heap.u32.subarray(this.#bitsAt / 4);  // 64-bit words with the lower half first
    for (let draw = 0; draw < this.#objects.length; ++draw) this.#objects[draw] = bits[draw >> 5] >>> (draw & 31) & 1;
    this.#objectsOf = this.#moves;
    return this.#objects;
  }

  indices(storedIndices, target) {
    const ranges = this.ranges();
    const { firstStored } = this.database;
    let length = 0;
    for (let i = 2; i < ranges.length; i += 3) length += 3 * ranges[i];
    if (length > target.length) {
      throw new SightcellError('capacity', `sightcell: indices() has ${length} indices for ${target.length} elements`);
    }
    for (let i = 0, at = 0; i < ranges.length; i += 3) {
      const begin = 3 * (firstStored[ranges[i]] + ranges[i + 1]);
      const list = storedIndices.subarray(begin, begin + 3 * ranges[i + 2]);
      target.set(list, at);
      at += list.length;
    }
    return length;
  }

  polygons() {
    const heap = this.#use('polygons()');
    return heap.listOfWords('polygons()', (...to) => heap.c.sightcell_view_polygons(this.#view, ...to));
  }

  importance() {
    const heap = this.#use('importance()');
    const words = heap.listOfWords('importance()',
      (...to) => heap.c.sightcell_view_importance(this.#view, ...to));
    return new Float32Array(words.buffer);
  }

  boxVisible(box) {
    const heap = this.#use('boxVisible()');
    const at = this.#putBox(heap, box, 'boxVisible()');
    heap.require(heap.c.sightcell_view_box_visible(this.#view, at, at + 12, at + 24), 'boxVisible()');
    return heap.written(6) !== 0;
  }

  debugLines(kinds) {
    const heap = this.#use('debugLines()');
    const { size, members } = structs.debug_line;
    return heap.list(size, 'debugLines()',
      (...to) => heap.c.sightcell_view_debug_lines(this.#view, kinds, ...to),
      (at, count) => {
        const lines = { positions: new Float32Array(6 * count), kinds: new Uint32Array(count),
          numbers: new Uint32Array(count) };
        for (let i = 0, line = at; i < count; ++i, line += size) {
          const [from, to] = [members.from, members.to].map((member) => (line + member.at) / 4);
          lines.positions.set(heap.f32.subarray(from, from + 3), 6 * i);
          lines.positions.set(heap.f32.subarray(to, to + 3), 6 * i + 3);
          lines.kinds[i] = heap.u32[(line + members.kind.at) / 4];
          lines.numbers[i] = heap.u32[(line + members.number.at) / 4];
        }
        return lines;
      });
  }

  statistics() {
    const heap = this.#use('statistics()');
    return heap.readSized('view_stats', 'statistics()', (at) => heap.c.sightcell_view_statistics(this.#view, at));
  }

  dispose() {
    if (this.#view === 0) return;
    this.#heap.c.sightcell_view_destroy(this.#view);
    this.#heap.free(this.#frameAt);
    this.#view = 0;
    this.#closed();
  }
}
