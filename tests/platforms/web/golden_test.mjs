// The module reads the golden files like all other builds, and rejects the damaged ones with the same status.
// usage: golden_test.mjs MODULE.wasm GOLDEN_FOLDER ANSWERS
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { dump } from "./dump.mjs";
import { fnv_hash, host, require, requires_clusters, status } from "./host.mjs";
import { open_paged } from "./paged.mjs";
import { hash_of_walk } from "./walk.mjs";

const [module_path, folder, answers] = process.argv.slice(2);
const page = await host.load(module_path);
const lines = (path) => readFileSync(path, "utf8").split("\n").filter((line) => line !== "");

function hash_of(text) {
  const hash = new fnv_hash();
  hash.add_text(text);
  return hash.hex();
}

// The numbers that platforms_same_everywhere_test expects. The module is built without version 0.
let read = 0;
let old = 0;
for (const line of lines(answers)) {
  const [name, size, dump_hash, walk_hash] = line.split(" ");
  const path = join(folder, `${name}.pvs`);
  if (name.startsWith("v0_")) {
    page.with_file(path, ({ status: s }) => require(s === status.version, `${name}: status ${s}`));
    ++old;
    continue;
  }
  page.with_file(path, ({ db, status: s }) => {
    require(s === status.ok, `${name}: status ${s}`);
    const text = dump(page, db);
    require(!text.includes("WRONG"), text);
    require(`${text.length} ${hash_of(text)}` === `${size} ${dump_hash}`, `${name} is read otherwise:\n${text}`);
    const walked = hash_of_walk(page, db);
    require(walked === walk_hash, `${name}: the walk's hash is ${walked}`);
    require(page.c.sightcell_db_check(db) === status.ok, `${name} is not sound`);
  });
  // A paged file gives the same results.
  const paged = open_paged(page, readFileSync(path));
  require(paged.status === status.ok, `${name} paged: ${paged.status}`);
  const walked = hash_of_walk(page, paged.db);
  require(walked === walk_hash, `${name} piece by piece: the walk's hash is ${walked}`);
  require(paged.requests() > 2, `${name} piece by piece: ${paged.requests()} requests`);
  paged.close();
  ++read;
}
require(read > 0 && old > 0, `${answers}: ${read} files, and ${old} of version 0`);

let of_clusters = 0;
const names = Object.fromEntries(Object.entries(status).map(([name, number]) => [number, name]));
const damaged = lines(join(folder, "golden_errors", "statuses.txt"));
for (const line of damaged) {
  const [name, expected] = line.split(" ");
  const found = page.with_file(join(folder, "golden_errors", name), ({ db, status: opened }) =>
    names[opened === status.ok ? page.c.sightcell_db_check(db) : opened]);
  // The module is built without clusters.
  const in_clusters = requires_clusters(readFileSync(join(folder, "golden_errors", name)));
  const expected_here = in_clusters ? "version" : expected;
  require(found === expected_here, `${name}: ${found} instead of ${expected_here}`);
  of_clusters += in_clusters ? 1 : 0;
}
require(of_clusters > 10, "too few files of clusters");
require(damaged.length > 200, "too few damaged files");

// A page has no files.
const name = page.put(new TextEncoder().encode("v1_tiny.pvs\0"));
require(page.c.sightcell_db_open_file(name, 0, page.out) === status.io && page.written() === 0, "open_file");
page.c.free(name);
require(page.text(page.c.sightcell_status_text(status.not_ours)) === "not a .pvs file", "status_text");
require(page.c.sightcell_version() === 1, "version");
console.log(`${read} files are the same, ${damaged.length} damaged ones get the statuses that are listed`);
