// The package gives the answers of the native runtime, and takes back what it takes.
// usage: package_test.mjs PACKAGE_FOLDER GOLDEN_FOLDER ANSWERS TOWN.pvs
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { fnv_hash, require, requires_clusters } from "../host.mjs";
import { dump } from "./dump.mjs";

const [folder, golden, answers, town] = process.argv.slice(2);
const { DebugLines, Sightcell, SightcellError } =
  await import(pathToFileURL(resolve(folder, "sightcell.js")).href);
const sightcell = await Sightcell.load();
const lines = (path) => readFileSync(path, "utf8").split("\n").filter((line) => line !== "");
const is_old = (name) => name.startsWith("v0_");  // version 0, which the module is built without
const file = (name) => readFileSync(join(golden, name));
const equal = (found, expected, what) => {
  require(JSON.stringify(found) === JSON.stringify(expected), `${what}: ${found} instead of ${expected}`);
};

// The id of the error that act throws, or "ok".
function id_of(act) {
  try {
    act();
    return "ok";
  } catch (error) {
    require(error instanceof SightcellError && error.message.startsWith("sightcell: "), `${error.stack}`);
    return error.id;
  }
}

// Of all golden files, every answer is the native one.
function same_answers() {
  let read = 0;
  for (const line of lines(answers)) {
    const [name, size, expected] = line.split(" ");
    if (is_old(name)) {
      equal(id_of(() => sightcell.open(file(`${name}.pvs`))), "version", name);
      continue;
    }
    const db = sightcell.open(file(`${name}.pvs`));
    const hash = new fnv_hash();
    const text = dump(db);
    hash.add_text(text);
    equal(`${text.length} ${hash.hex()}`, `${size} ${expected}`, `${name}:\n${text}`);
    db.dispose();
    ++read;
  }
  require(read > 0, `${answers} lists nothing`);
  return read;
}

// A draw is visible where it has a range, or in a merged file where one of its polygons is visible.
function objects_are_those_of_the_set(bytes, name) {
  const db = sightcell.open(bytes);
  const view = db.createView();
  for (let cell = 0; cell < db.info.cellCount; ++cell) {
    const { min, max } = db.cellBox(cell);
    view.moveBox({ min, max: max.map((end, axis) => Math.fround(0.5 * (min[axis] + end))) });
    const visible = new Set(view.polygons());
    const expected = db.draws.map(({ firstSource, polygonCount }) =>
      Number(Array.from({ length: polygonCount }, (_, i) => firstSource + i).some((source) => visible.has(source))));
    equal(Array.from(view.objects()), expected, `${name}, objects of cell ${cell}`);
  }
  db.dispose();
}

// Each draw of the set has importance, and no other.
function importance_is_of_the_set() {
  const db = sightcell.open(file("v1_importance.pvs"));
  const view = db.createView();
  equal(Array.from(view.importance()), db.draws.map(() => 0), "importance before the first move");
  for (let cell = 0; cell < db.info.cellCount; ++cell) {
    const { min, max } = db.cellBox(cell);
    view.moveBox({ min, max: max.map((end, axis) => Math.fround(0.5 * (min[axis] + end))) });
    equal(Array.from(view.importance(), (angle) => Number(angle > 0)), Array.from(view.objects()),
      `importance in cell ${cell}`);
  }
  view.move([-1e6, 0, 0]);
  equal(id_of(() => view.importance()), "stale", "importance outside");
  const plain = sightcell.open(file("v1_small.pvs"));
  equal(id_of(() => plain.createView().importance()), "absent", "importance of a file without");
  plain.dispose();
  db.dispose();
}

// A box inside of a volume is visible from the cells that list the volume.
function boxes_are_visible_with_their_volume() {
  const db = sightcell.open(file("v1_volumes.pvs"));
  const view = db.createView();
  let visible = 0, tested = 0;
  for (const line of lines(join(golden, "v1_volumes.txt"))) {
    const [, cell, list] = line.match(/^volumes of (\d+):(.*)/) ?? [];
    if (cell === undefined) continue;
    const listed = new Set((list.match(/\d+/g) ?? []).map(Number));
    const box = db.cellBox(Number(cell));
    view.move(box.min.map((end, axis) => 0.5 * (end + box.max[axis])));
    for (let volume = 0; volume < db.info.volumeCount; ++volume) {
      const { min, max } = db.volumeBox(volume);
      const middle = min.map((end, axis) => 0.5 * (end + max[axis]));
      const [x, y, z] = middle;
      equal(view.boxVisible({ min: middle, max: { x, y, z } }), listed.has(volume), `volume ${volume} from ${line}`);
      visible += Number(listed.has(volume));
      ++tested;
    }
  }
  require(visible > 0 && visible < tested, `${visible} of ${tested} boxes are visible`);
  db.dispose();
}

function a_view_moves() {
  const db = sightcell.open(file("v1_groups.pvs"));
  const view = db.createView();
  equal([view.ranges().length, view.frame.cell], [0, -1], "before the first move");
  const frame = view.move([0.5, 0.5, 0.5]);
  require(frame === view.frame && frame.changed && frame.cell === 0, "the first move");
  const ranges = view.ranges();
  require(!view.move([0.6, 0.5, 0.5]).changed && view.ranges() === ranges, "nothing changed");
  view.move([50, 50, 50]);
  require(frame.outside && frame.drawAll && frame.cell === -1, "outside all cells");
  equal(frame.polygonCount, db.info.polygonCount, "polygons outside all cells");
  view.setPolicy("last");
  view.move([0.5, 0.5, 0.5]);
  require(view.move([50, 50, 50]).outside && !frame.drawAll, "the last set outside all cells");
  view.setOrigin([50, 50, 50]);
  equal(view.move([-49.5, -49.5, -49.5]).cell, 0, "the cell relative to an origin");

  const before = frame.polygonCount;
  view.showNamedGroup("door", false);
  require(view.move([-49.5, -49.5, -49.5]).changed && frame.polygonCount < before, "a closed door");
  view.showNamedGroup(db.namedGroups().indexOf("door"), true);
  view.move([-49.5, -49.5, -49.5]);
  equal(frame.polygonCount, before, "polygons with an open door");
  equal(Number(view.statistics().moves), 8, "moves");

  const box = view.debugLines(DebugLines.cell);
  equal([box.positions.length, box.numbers.length, Array.from(new Set(box.kinds))], [72, 12, [DebugLines.cell]], "lines");
  equal([Math.min(...box.positions), Math.max(...box.positions)], [-50, -49], "ends of lines relative to an origin");
  db.dispose();
}

// What sightcell bake --embed writes: JSON, and a BIN chunk with other bytes before the file.
function glb_of(json, pvs, before = 4) {
  const text = Buffer.from(JSON.stringify(json)), pad = (size) => size + (4 - size % 4) % 4;
  const chunk = pad(text.length), binary = pad(before + pvs.length);
  const glb = Buffer.alloc(28 + chunk + binary, " ");
  [0x46546c67, 2, glb.length, chunk, 0x4e4f534a].forEach((value, i) => glb.writeUInt32LE(value, 4 * i));
  text.copy(glb, 20);
  glb.writeUInt32LE(binary, 20 + chunk);
  glb.writeUInt32LE(0x004e4942, 24 + chunk);
  pvs.copy(glb, 28 + chunk + before);
  return glb;
}

function files_in_a_glb_open() {
  const pvs = file("v1_small.pvs"), view = { buffer: 0, byteOffset: 4, byteLength: pvs.length };
  const json = { bufferViews: [{}, view], extras: { sightcell: { pvs: { bufferView: 1 } } } };
  const [inside, plain] = [glb_of(json, pvs), pvs].map((bytes) => sightcell.open(bytes));
  equal(dump(inside), dump(plain), "the file in a .glb");
  const bad = (changed) => id_of(() => sightcell.open(glb_of({ ...json, ...changed }, pvs)));
  equal(bad({ extras: {} }), "absent", "a .glb without a file");
  for (const other of [undefined, {}, { ...view, buffer: 1 }, { ...view, byteOffset: -4 }, { ...view, byteLength: "7" },
    { ...view, byteOffset: 2 ** 40 }, { ...view, byteLength: pvs.length + 9 }]) {
    equal(bad({ bufferViews: [{}, other] }), "corrupt", `the view ${JSON.stringify(other)}`);
  }
  const whole = glb_of(json, pvs);
  for (let size = 0; size < whole.length; size += size < 400 ? 1 : 97) {
    require(["truncated", "not_ours", "corrupt"].includes(id_of(() => sightcell.open(whole.subarray(0, size)))), `${size}`);
  }
  inside.dispose();
  plain.dispose();
}

function errors_have_ids() {
  let damaged = 0;
  for (const line of lines(join(golden, "golden_errors", "statuses.txt"))) {
    const [name, outcome] = line.split(" ");
    const expected = requires_clusters(file(`golden_errors/${name}`)) ? "version" : outcome;
    const found = id_of(() => {
      const db = sightcell.open(file(`golden_errors/${name}`));
      try {
        db.check();
      } finally {
        db.dispose();
      }
    });
    equal(found, expected, name);
    ++damaged;
  }
  require(damaged > 200, "too few damaged files");
  equal(id_of(() => sightcell.open(new Uint8Array(100))), "not_ours", "zeros");
  equal(id_of(() => sightcell.open(new Uint8Array(0))), "truncated", "no bytes");
  equal(id_of(() => sightcell.open("v1_tiny.pvs")), "argument", "a name");
  const view = sightcell.open(file("v1_tiny.pvs")).createView();
  equal(id_of(() => view.move([0, NaN, 0])), "argument", "a NaN");
  require(view.frame.drawAll && view.objects().every((visible) => visible === 1), "everything is visible after a NaN");
  for (const point of [undefined, null, [0, 1], { x: 1, y: 2 }, ["0", "1", "2"]]) {
    equal(id_of(() => view.move(point)), "argument", `the point ${point}`);
  }
  equal(id_of(() => view.boxVisible({ min: [0, 0, 0] })), "argument", "a box without max");
  equal(id_of(() => view.boxVisible({ min: [1, 0, 0], max: [0, 0, 0] })), "argument", "a box inside out");
  equal(id_of(() => view.setPolicy("none")), "argument", "a policy");
  equal(id_of(() => view.showNamedGroup("door", true)), "argument", "a named group that does not exist");
  equal(id_of(() => view.database.cellBox(1e6)), "argument", "a cell that does not exist");
  view.move([0.5, 0.5, 0.5]);
  equal(id_of(() => view.indices(new Uint32Array(100), new Uint32Array(2))), "capacity", "a short index list");
  view.database.dispose();
}

async function everything_is_disposed() {
  const own = await Sightcell.load({ wasm: readFileSync(join(folder, "sightcell.wasm")) });
  const db = own.open(file("v1_small.pvs"));
  const [view, other] = [db.createView(), db.createView()];
  other.dispose();
  other.dispose();
  require(other.disposed && !view.disposed && !db.disposed, "one view is disposed");
  equal(id_of(() => other.move([0, 0, 0])), "disposed", "move after dispose");
  own.dispose();
  own.dispose();
  require(view.disposed && db.disposed && own.disposed, "a module disposes what it has open");
  db.dispose();
  for (const act of [() => view.move([0, 0, 0]), () => view.ranges(), () => view.objects(), () => view.boxVisible({}),
    () => view.debugLines(1), () => db.order(), () => db.draws, () => db.createView(), () => db.check(),
    () => own.open(file("v1_small.pvs"))]) {
    equal(id_of(act), "disposed", act);
  }
}

function cycle(bytes, keep_view) {
  const db = sightcell.open(bytes);
  const view = db.createView();
  view.move([0.5, 0.5, 0.5]);
  view.ranges();
  view.objects();
  view.debugLines(31);
  db.order();
  if (!keep_view) view.dispose();
  db.dispose();
  id_of(() => sightcell.open(bytes.subarray(0, bytes.length - 1)));
}

// A block that is not freed has at least 32 bytes, and a page 65,536.
function memory_does_not_grow() {
  const names = lines(answers).map((line) => `${line.split(" ")[0]}.pvs`).filter((name) => !is_old(name));
  const round = () => names.forEach((name) => { for (let i = 0; i < 10; ++i) cycle(file(name), i % 2 === 0); });
  round();
  const before = sightcell.memoryBytes;
  for (let i = 0; i < 10; ++i) round();
  const tiny = file("v1_tiny.pvs");
  for (let i = 0; i < 2100; ++i) cycle(tiny, i % 2 === 0);
  equal(sightcell.memoryBytes, before, "bytes after many cycles");
}

// What was returned keeps its elements when the memory grows, and the view goes on.
function growth_detaches_nothing() {
  const db = sightcell.open(file("v1_small.pvs"));
  const view = db.createView();
  view.move([0.5, 0.5, 0.5]);
  const order = db.order(), ranges = view.ranges(), objects = view.objects(), polygons = view.polygons();
  const kept = [order, ranges, objects, polygons].map((list) => Array.from(list));
  const before = sightcell.memoryBytes;
  id_of(() => sightcell.open(new Uint8Array(before)));
  require(sightcell.memoryBytes > before, "the memory has grown");
  equal([order, ranges, objects, polygons].map((list) => Array.from(list)), kept, "lists after growth");
  view.move([50, 50, 50]);
  view.move([0.5, 0.5, 0.5]);
  equal([db.order(), view.ranges(), view.objects(), view.polygons()].map((list) => Array.from(list)), kept, "new lists");
  db.dispose();
}

async function rejection_of(promise) {
  return promise.then(() => "ok", (error) => (error instanceof SightcellError ? error.id : error.name));
}

async function urls_are_opened() {
  const served = { "/v1_small.pvs": file("v1_small.pvs"), "/sightcell.wasm": readFileSync(join(folder, "sightcell.wasm")) };
  const server = createServer((request, response) => {
    response.writeHead(served[request.url] === undefined ? 404 : 200).end(served[request.url]);
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  const base = `http://127.0.0.1:${server.address().port}/`;
  try {
    const own = await Sightcell.load({ wasm: `${base}sightcell.wasm` });
    for (const url of [`${base}v1_small.pvs`, new URL("v1_small.pvs", base), pathToFileURL(join(golden, "v1_small.pvs"))]) {
      equal((await own.openUrl(url)).info.polygonCount, 300, `polygons of ${url}`);
    }
    equal(await rejection_of(own.openUrl(`${base}none.pvs`)), "io", "a file that the server does not have");
    equal(await rejection_of(own.openUrl(`${base}sightcell.wasm`)), "not_ours", "a file of another kind");
    equal(await rejection_of(own.openUrl(pathToFileURL(join(golden, "none.pvs")))), "io", "a file that does not exist");
    equal(await rejection_of(own.openUrl(`${base}v1_small.pvs`, { signal: AbortSignal.abort() })), "AbortError", "a signal");
    // A module without our functions.
    const empty = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0);
    equal(await rejection_of(Sightcell.load({ wasm: empty })), "version", "another module");
  } finally {
    server.close();
    server.closeAllConnections();
  }
}

const read = same_answers();
for (const name of ["v1_small.pvs", "v1_merged.pvs", "v1_lattice.pvs"]) objects_are_those_of_the_set(file(name), name);
importance_is_of_the_set();
objects_are_those_of_the_set(readFileSync(town), town);  // more draws than a word has bits
boxes_are_visible_with_their_volume();
a_view_moves();
files_in_a_glb_open();
errors_have_ids();
await everything_is_disposed();
memory_does_not_grow();
growth_detaches_nothing();
await urls_are_opened();
console.log(`${read} files are the same, in ${sightcell.memoryBytes / 65536} pages`);
