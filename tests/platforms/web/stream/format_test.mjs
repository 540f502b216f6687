// The front and the cell chunks of a site as the reader of tests/stream finds them, and damaged ones.
// usage: format_test.mjs PACKAGE_FOLDER SITE_FOLDER
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { deflateSync, inflateSync } from "node:zlib";

import { require } from "../host.mjs";

const [folder, sites] = process.argv.slice(2);
const load = (name) => import(pathToFileURL(resolve(folder, name)).href);
const { readChunk, readFront } = await load("format.js");
const { StreamError } = await load("error.js");
const { weightOf } = await load("cells.js");
const base = "https://host/site/",
  url = `${base}scene.front`;
const expected = JSON.parse(readFileSync(join(sites, "rooms.json"), "utf8"));
const file = (name) => readFileSync(join(sites, "rooms.site", name));
const buffer_of = (bytes) => bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);

function same(found, wanted, what) {
  if (typeof wanted === "number") {
    require(Math.abs(found - wanted) < 1e-5, `${what}: ${found} instead of ${wanted}`);
  } else if (typeof wanted === "object") {
    require(Object.keys(found).length >= Object.keys(wanted).length, `${what} is shorter`);
    for (const key of Object.keys(wanted)) same(found[key], wanted[key], `${what}.${key}`);
  } else {
    require(found === wanted, `${what}: ${found} instead of ${wanted}`);
  }
}

async function error_of(act) {
  try {
    await act();
    return "none";
  } catch (error) {
    require(error instanceof StreamError && error.message.startsWith(`sightcell: ${error.url}: `), error.stack);
    return error.id;
  }
}

const front = await readFront(buffer_of(file("scene.front")), url);
const chunk_bytes = file(front.chunks[0].url.slice(base.length));
const cells = await readChunk(buffer_of(chunk_bytes), front.chunks[0], front);

function all_is_read() {
  const { draws, images, chunks, cells: listed, ...rest } = expected;
  same(front, { ...rest, pages: rest.pages.map((page) => ({ ...page, url: base + page.url })) }, "front");
  same(
    front.draws,
    draws.map(({ material, object, matrix, ...draw }) => ({ ...draw, material: material + 1, object: object + 1 })),
    "draws",
  );
  const matrices = front.draws.map((_, i) => front.columns.map((column) => column[i]));
  same(
    matrices,
    draws.map(({ matrix }) => matrix),
    "matrices",
  );
  same(
    front.images.map(({ files }) => files),
    images.map((files) => files.map((each) => ({ ...each, url: base + each.url }))),
    "images",
  );
  same(
    front.chunks,
    chunks.map((each) => ({ ...each, url: base + each.url })),
    "chunks",
  );
  same(
    cells,
    listed.map(({ draws: _, ...cell }) => cell),
    "cells",
  );
  const draws_of = ({ runs }) =>
    runs.flatMap(([begin, end]) => Array.from({ length: end - begin }, (_, i) => begin + i));
  same(
    cells.map(draws_of),
    listed.map((cell) => cell.draws),
    "draws of cells",
  );
  require(cells.length === 4 && front.files.length === 10, `${cells.length} cells, ${front.files.length} files`);
  for (const { url: name, bytes, hash } of front.files) {
    const content = file(name.slice(base.length));
    const digest = createHash("sha256").update(content).digest("hex").slice(0, 16);
    require(content.length === bytes && digest === hash, name);
  }
  const [cell] = cells;
  cell.pages.forEach((_, i) => same(weightOf(cell, i), cell.weight * 2 ** (-cell.shares[i] / 8), "a weight"));
}

const packed_front = (payload, size = payload.length, version = 1) => {
  const head = Buffer.from("SIGHTFRT\0\0\0\0\0\0\0\0", "latin1");
  head.writeUInt32LE(version, 8);
  head.writeUInt32LE(size, 12);
  return Buffer.concat([head, deflateSync(payload)]);
};
const packed_chunk = (payload, size = payload.length) => {
  const head = Buffer.alloc(4);
  head.writeUInt32LE(size);
  return Buffer.concat([head, deflateSync(payload)]);
};
const front_payload = inflateSync(file("scene.front").subarray(16)),
  chunk_payload = inflateSync(chunk_bytes.subarray(4));
const read_front = (bytes) => error_of(() => readFront(buffer_of(bytes), url));
const read_chunk = (bytes, of = front) => error_of(() => readChunk(buffer_of(bytes), of.chunks[0], of));

async function damaged_files_are_rejected() {
  const equal = (found, wanted, what) => require(found === wanted, `${what}: ${found} instead of ${wanted}`);
  equal(await read_front(packed_front(front_payload)), "none", "the payload, packed again");
  equal(await read_chunk(packed_chunk(chunk_payload)), "none", "the payload of the chunk, packed again");
  equal(await read_front(Buffer.from("<!doctype html><p>Not found")), "not_ours", "a page of a server");
  equal(await read_front(Buffer.from("")), "not_ours", "nothing");
  equal(await read_front(file("scene.front").subarray(0, 12)), "truncated", "half a header");
  equal(await read_front(packed_front(front_payload, undefined, 2)), "version", "version 2");
  for (const change of [-1, 1]) {
    equal(
      await read_front(packed_front(front_payload, front_payload.length + change)),
      "corrupt",
      `a size off by ${change}`,
    );
    equal(
      await read_chunk(packed_chunk(chunk_payload, chunk_payload.length + change)),
      "corrupt",
      `a size off by ${change}`,
    );
  }
  equal(await read_front(packed_front(front_payload, 0xffffffff)), "corrupt", "a size of 4 GB");
  equal(await read_front(file("scene.front").subarray(0, -7)), "corrupt", "a cut stream");
  equal(await read_chunk(chunk_bytes.subarray(0, -7)), "corrupt", "a cut chunk");
  equal(await read_chunk(chunk_bytes.subarray(0, 3)), "corrupt", "3 bytes of a chunk");
  equal(
    await read_chunk(packed_chunk(Buffer.concat([chunk_payload, Buffer.from([0])]))),
    "corrupt",
    "a byte behind the chunk",
  );
  equal(
    await read_front(packed_front(Buffer.concat([front_payload, Buffer.from([0])]))),
    "corrupt",
    "a byte behind the front",
  );
  // Needless bytes: the count of cells as two bytes.
  equal(
    await read_chunk(packed_chunk(Buffer.concat([Buffer.from([0x84, 0]), chunk_payload.subarray(1)]))),
    "corrupt",
    "84 00",
  );
  const few = (changes) => ({ ...front, ...changes });
  equal(
    await read_chunk(chunk_bytes, few({ pages: front.pages.slice(0, 3) })),
    "corrupt",
    "a page that does not exist",
  );
  equal(
    await read_chunk(chunk_bytes, few({ images: front.images.slice(0, 1) })),
    "corrupt",
    "an image that does not exist",
  );
  equal(
    await read_chunk(chunk_bytes, few({ draws: front.draws.slice(0, 3) })),
    "corrupt",
    "a draw that does not exist",
  );
}

// Every prefix, and changed bytes: an error with an id, or other numbers.
async function changed_bytes_are_no_crash() {
  const rejected = { cut: 0, changed: 0 };
  for (const [payload, pack, read] of [
    [front_payload, packed_front, read_front],
    [chunk_payload, packed_chunk, read_chunk],
  ]) {
    for (let end = 0; end < payload.length; end += 3) {
      const id = await read(pack(payload.subarray(0, end)));
      require(id === "corrupt", `${end} bytes of ${payload.length}: ${id}`);
      ++rejected.cut;
    }
    for (let at = 0; at < payload.length; at += 2) {
      const other = Buffer.from(payload);
      other[at] ^= [0xff, 0x80, 0x01][(at / 2) % 3];
      const id = await read(pack(other));
      require(id === "none" || id === "corrupt", `byte ${at}: ${id}`);
      rejected.changed += Number(id !== "none");
    }
  }
  require(rejected.changed > 100, `${rejected.changed} changed payloads were rejected`);
  return rejected;
}

all_is_read();
await damaged_files_are_rejected();
const { cut, changed } = await changed_bytes_are_no_crash();
console.log(`${front.files.length} files; ${cut} cut and ${changed} changed payloads rejected`);
