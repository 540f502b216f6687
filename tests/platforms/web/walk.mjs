// The same walk as file_walk.cpp, through the functions that a page calls.
import { fnv_hash } from "./host.mjs";

const steps = 600;

class walk {
  constructor(host, db) {
    Object.assign(this, { host, c: host.c, db, hash: new fnv_hash() });
    const info = host.room(56);
    host.u32(info, 1)[0] = 56;
    this.info_status = host.c.sightcell_db_info(db, info);
    [, , , this.polygons, , this.draws, this.range_bound] = host.u32(info, 7);
    host.c.free(info);
    this.words = Math.floor((this.draws + 63) / 64);
    // Two boxes, a frame, an origin; two lists of ranges; commands, bits.
    this.box = host.room(24);
    this.frame = host.room(64);
    this.origin = host.room(24);
    this.ranges = [host.room(12 * this.polygons + 1), host.room(12 * this.polygons + 1)];
    this.counts = host.room(8);
    this.commands = host.room(20 * this.range_bound + 1);
    this.bits = host.room(8 * this.words + 1);
  }
  free() {
    for (const at of [this.box, this.frame, this.origin, ...this.ranges, this.counts, this.commands, this.bits]) {
      this.c.free(at);
    }
  }
  add_words(at, count) {
    for (const word of this.host.u32(at, count)) this.hash.add(word);
  }

  add_boxes() {
    const min = [Infinity, Infinity, Infinity];
    const max = [-Infinity, -Infinity, -Infinity];
    for (let cell = 0; cell < this.c.sightcell_db_cell_count(this.db); ++cell) {
      this.hash.add(this.c.sightcell_db_cell_box(this.db, cell, this.box, this.box + 12));
      this.add_words(this.box, 6);
      const b = this.host.f32(this.box, 6);
      for (let axis = 0; axis < 3; ++axis) {
        min[axis] = Math.min(min[axis], b[axis]);
        max[axis] = Math.max(max[axis], b[3 + axis]);
      }
    }
    const volumes = this.c.sightcell_db_volume_count(this.db);
    this.hash.add(volumes);
    for (let volume = 0; volume < volumes; ++volume) {
      this.hash.add(this.c.sightcell_db_volume_box(this.db, volume, this.box, this.box + 12));
      this.add_words(this.box, 6);
    }
    return { min, max };
  }

  add_changes(since) {
    const [added, removed] = this.ranges;
    const s = this.c.sightcell_view_changes(this.view, since, added, this.polygons, this.counts, removed, this.polygons,
      this.counts + 4);
    this.hash.add(s);
    this.add_words(added, 3 * this.host.u32(this.counts, 1)[0]);
    this.add_words(removed, 3 * this.host.u32(this.counts + 4, 1)[0]);
  }

  add_lists(min_gap) {
    const { host, c, view } = this;
    this.hash.add(c.sightcell_view_commands(view, min_gap, this.commands, 20, this.range_bound, host.out));
    this.add_words(this.commands, 5 * host.written());
    this.hash.add(c.sightcell_view_objects(view, this.bits, this.words));
    this.add_words(this.bits, 2 * this.words);
    const lines = host.list_u32(8, (dst, room, count) => c.sightcell_view_debug_lines(view, 31, dst, room, count));
    this.hash.add(0);
    for (const word of lines) this.hash.add(word);
  }

  add_end(eye) {
    const { host, c } = this;
    const stats = host.room(64);
    host.u32(stats, 1)[0] = 64;
    this.hash.add(c.sightcell_view_statistics(this.view, stats));
    this.add_words(stats + 8, 14);
    c.free(stats);
    const miss = host.room(32);
    host.f64(miss, 3).set(eye);
    host.u32(miss + 24, 2).fill(0);
    const text = host.room(512);
    this.hash.add(c.sightcell_db_misses_text(this.db, miss, 1, text, 512, host.out));
    for (const byte of host.bytes(text, host.written())) this.hash.add_byte(byte);
    c.free(text);
    c.free(miss);
  }

  move(step, state, all) {
    const { host, c, view } = this;
    const float = Math.fround;
    const ends = host.f32(this.box, 6);
    for (let axis = 0; axis < 3; ++axis) {
      state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
      const part = float(float(((state >>> 16) % 21) * 0.0625) - 0.125);
      const way = float(all.max[axis] - all.min[axis]);
      ends[axis] = float(all.min[axis] + float(way * part));
      ends[3 + axis] = float(ends[axis] + 0.375);
    }
    const eye = Array.from(ends.subarray(0, 3));
    this.hash.add(step % 7 === 0 ? c.sightcell_view_move_box(view, this.box, this.box + 12, this.frame)
      : c.sightcell_view_move(view, this.box, this.frame));
    this.add_words(this.frame, 4);
    const revision = host.u32(this.frame, 4)[3];
    this.hash.add(c.sightcell_view_box_visible(view, this.box, this.box + 12, host.out));
    this.hash.add(host.written());
    this.add_changes((revision - 1) >>> 0);
    this.add_lists(step % 5);
    return { state, eye };
  }

  go() {
    const { host, c } = this;
    const all = this.add_boxes();
    this.hash.add(this.info_status);
    return host.with_view(this.db, (view) => {
      this.view = view;
      this.hash.add(0);
      let at = { state: 1, eye: [0, 0, 0] };
      for (let step = 0; step < steps; ++step) {
        if (step % 100 === 0) {
          this.hash.add(c.sightcell_view_policy(view, step / 100 % 3, 1.5));
          host.f64(this.origin, 3).set([step / 100 % 2 === 0 ? 0.0 : 0.25, 0.0, 0.0]);
          this.hash.add(c.sightcell_view_origin(view, this.origin));
        }
        at = this.move(step, at.state, all);
      }
      this.add_end(at.eye);
      return this.hash.hex();
    });
  }
}

export function hash_of_walk(host, db) {
  const one = new walk(host, db);
  const hex = one.go();
  one.free();
  return hex;
}
