// Prints the same text of a file as decode_dump.cpp, through the functions that a page calls.
import { fnv_hash, require, status } from "./host.mjs";

// %.9g
export function nine_digits(value) {
  if (value === 0) return Object.is(value, -0) ? "-0" : "0";
  const [digits, exponent] = value.toExponential(8).split("e").map((part, i) => (i === 0 ? part : Number(part)));
  const short = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
  if (exponent >= -4 && exponent < 9) return short(value.toFixed(8 - exponent));
  return `${short(digits)}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
}

function facts_of(host, db) {
  const at = host.room(60);
  host.u32(at, 1)[0] = 60;
  require(host.c.sightcell_db_info(db, at) === status.ok, "no info");
  const [, version, layout, polygons, cells, draws, range_bound] = host.u32(at, 7);
  const [margin, max_pixel_error, confidence] = host.f32(at + 28, 3);
  const fingerprint = Buffer.from(host.bytes(at + 40, 16)).toString("hex");
  const [player_radius] = host.f32(at + 56, 1);
  host.c.free(at);
  return { version, layout, polygons, cells, draws, range_bound, margin, max_pixel_error, confidence, fingerprint,
    player_radius };
}

function draws_of(host, db) {
  const bytes = host.list(48, (dst, room, count) => host.c.sightcell_db_draws(db, dst, room, count));
  const list = [];
  for (let at = 0; at < bytes.length; at += 48) {
    list.push({ words: new Uint32Array(bytes.buffer, at, 10), tag: new BigUint64Array(bytes.buffer, at + 40, 1)[0] });
  }
  return list;
}

// Each byte of a name becomes one character, regardless of UTF-8.
function named_groups_of(host, db) {
  let text = "";
  for (let group = 0; group < host.c.sightcell_db_named_group_count(db); ++group) {
    const name = host.list(1, (dst, room, n) => host.c.sightcell_db_named_group_name(db, group, dst, room, n));
    const with_end = host.put(Uint8Array.of(...name, 0));
    const s = host.c.sightcell_db_find_named_group(db, with_end, host.out);
    if (s !== status.ok || host.written() !== group) text += "WRONG: a name is not found\n";
    host.c.free(with_end);
    text += `named group ${group}: ${Buffer.from(name).toString("latin1")}\n`;
  }
  const groups = host.list_u32(1, (dst, room, n) => host.c.sightcell_db_named_groups_of_draws(db, dst, room, n));
  groups.forEach((group, draw) => {
    if (group !== 0xFFFFFFFF) text += `named group of draw ${draw}: ${group}\n`;
  });
  return text;
}

// The part of a line after "sees".
function answers(host, view, cell, stored) {
  const set = host.list_u32(1, (dst, room, count) => host.c.sightcell_view_polygons(view, dst, room, count));
  const ranges = host.list_u32(3, (dst, room, count) => host.c.sightcell_view_ranges(view, dst, room, count));
  const indices = host.list_u32(1,
    (dst, room, count) => host.c.sightcell_view_indices(view, stored.indices, dst, room, count));
  let text = "";
  for (const polygon of set.slice().sort()) text += ` ${polygon}`;
  text += `\nranges ${cell}:`;
  const from_ranges = [];
  for (let i = 0; i < ranges.length; i += 3) {
    const [draw, first, count] = ranges.subarray(i, i + 3);
    text += ` ${draw} ${first} ${count}`;
    for (let k = 0; k < count; ++k) from_ranges.push(stored.order[stored.begins[draw] + first + k]);
  }
  const hash = new fnv_hash();
  for (const index of indices) hash.add(index);
  text += `\nindices ${cell}: ${hash.hex()}\n`;
  if (from_ranges.join() !== set.join()) text += `WRONG: the ranges of cell ${cell} are not its set\n`;
  return text;
}

function cells_of(host, db, count, stored) {
  return host.with_view(db, (view) => {
    let text = "";
    const box = host.room(36);
    const frame = host.room(64);
    for (let cell = 0; cell < count; ++cell) {
      require(host.c.sightcell_db_cell_box(db, cell, box, box + 12) === status.ok, "no box");
      const ends = Array.from(host.f32(box, 6));
      const numbers = ends.map(nine_digits);
      text += `cell ${cell}: ${numbers.slice(0, 3).join(" ")}  ${numbers.slice(3).join(" ")}  sees`;
      for (let axis = 0; axis < 3; ++axis) {
        host.f32(box + 24, 3)[axis] = Math.fround(0.5 * ends[axis]) + Math.fround(0.5 * ends[3 + axis]);
      }
      host.c.sightcell_view_move(view, 0, frame);  // outside all cells, so that the view does not keep the previous cell
      const s = host.c.sightcell_view_move(view, box + 24, frame);
      const [found, flags] = host.u32(frame, 2);
      if (s !== status.ok || found !== cell || (flags & 2) !== 0) text += ` from cell ${found} flags ${flags} status ${s}`;
      text += answers(host, view, cell, stored);
    }
    host.c.free(frame);
    host.c.free(box);
    return text;
  });
}

// Nothing for a file without viewpoints.
function viewpoints_of(host, db, facts) {
  if (!(facts.player_radius > 0)) return "";
  let text = `player_radius ${nine_digits(facts.player_radius)}\n`;
  const at = host.room(8);
  for (let cell = 0; cell < facts.cells; ++cell) {
    require(host.c.sightcell_db_cell_viewpoints(db, cell, at, at + 4) === status.ok, "no viewpoints");
    const [valid, outside] = Array.from(host.f32(at, 2), nine_digits);
    text += `viewpoints ${cell}: ${valid} ${outside}\n`;
  }
  host.c.free(at);
  return text;
}

export function dump(host, db) {
  const facts = facts_of(host, db);
  let text = `version ${facts.version}\nfingerprint ${facts.fingerprint}\npolygons ${facts.polygons}\n` +
    `margin ${nine_digits(facts.margin)}\nmax_pixel_error ${nine_digits(facts.max_pixel_error)}\n` +
    `confidence ${nine_digits(facts.confidence)}\nlayout ${facts.layout} cells ${facts.cells} draws ${facts.draws} ` +
    `range_bound ${facts.range_bound}\n`;
  const stored = { begins: [], order: host.list_u32(1, (dst, room, n) => host.c.sightcell_db_order(db, dst, room, n)) };
  draws_of(host, db).forEach(({ words, tag }, i) => {
    if (facts.layout === 0 || words[5] === stored.begins.length) stored.begins.push(words[8]);
    text += `draw ${i}: ${words.join(" ")} ${tag}\n`;
  });
  text += named_groups_of(host, db);
  const hash = new fnv_hash();
  for (const source of stored.order) hash.add(source);
  text += `order ${hash.hex()}\n`;
  stored.indices = host.put(Uint32Array.from({ length: 3 * facts.polygons }, (_, i) => Math.imul(i, 2654435761)));
  text += cells_of(host, db, facts.cells, stored);
  host.c.free(stored.indices);
  text += viewpoints_of(host, db, facts);
  return text;
}
