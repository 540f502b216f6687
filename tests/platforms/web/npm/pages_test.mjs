// Of a file on a server, only the pages that are needed are downloaded, and the answers are those of the whole file. A
// server that fails gives an error or the whole file, and never a set that lacks something.
// usage: pages_test.mjs PACKAGE_FOLDER GOLDEN_FOLDER FLOOR.pvs    FLOOR.pvs: has seven pages
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { require } from "../host.mjs";

const [folder, golden, path] = process.argv.slice(2);
const { Sightcell, SightcellError } = await import(pathToFileURL(resolve(folder, "sightcell.js")).href);
const sightcell = await Sightcell.load();
const file = readFileSync(path);
const first_bytes = 256;

const equal = (found, expected, what) => {
  const [is, should_be] = [found, expected].map((value) => JSON.stringify(value));
  require(is === should_be, `${what}: ${is}, not ${should_be}`);
};
const rejection_of = (promise) => promise.then(() => "ok", (error) => {
  if (!(error instanceof SightcellError)) return error.name;
  require(error.id !== "io" || /^sightcell: http.*$/.test(error.message), error.message);  // one line with the address
  return error.id;
});
const middle = ({ min, max }) => min.map((end, axis) => 0.5 * (end + max[axis]));

async function until(done, what) {
  for (let i = 0; i < 1000; ++i) {
    if (done()) return;
    await new Promise((later) => setTimeout(later, 5));
  }
  throw new Error(`not done: ${what}`);
}

// A server whose answer a test decides. bytes: sent in all bodies.
const server = { bytes: 0, ranges: [], answer: null };
const http = createServer((request, response) => {
  const [, begin, end] = request.headers.range?.match(/^bytes=(\d+)-(\d+)$/)?.map(Number) ?? [];
  server.ranges.push(request.headers.range);
  server.answer(response, begin, end === undefined ? undefined : end + 1);
});
await new Promise((listening) => http.listen(0, "127.0.0.1", listening));
const url = `http://127.0.0.1:${http.address().port}/floor.pvs`;

function send(response, status, headers, body) {
  server.bytes += body.length;
  response.writeHead(status, headers).end(body);
}
const send_whole = (response) => send(response, 200, {}, server.file ?? file);
function send_range(response, begin, end, content = server.file ?? file) {
  if (begin === undefined) return send(response, 200, {}, content);
  if (begin >= content.length) return send(response, 416, { "Content-Range": `bytes */${content.length}` }, "");
  end = Math.min(end, content.length);
  const range = { "Content-Range": `bytes ${begin}-${end - 1}/${content.length}` };
  return send(response, 206, range, content.subarray(begin, end));
}

function serve(answer, content) {
  Object.assign(server, { bytes: 0, ranges: [], answer, file: content });
}
const open = (options) => sightcell.openUrl(url, { firstBytes: first_bytes, ...options });

// Moves, and again when the page of the cell has arrived.
async function arrive(view, point) {
  const frame = view.move(point);
  if (!frame.pending) return;
  const { polygonCount } = view.database.info;
  require(frame.drawAll && frame.polygonCount === polygonCount, "everything is drawn while a page is pending");
  await until(() => !view.move(point).pending, "a page");
}

function whole_answers() {
  const db = sightcell.open(file);
  const view = db.createView();
  const answers = Array.from({ length: db.info.cellCount }, (_, cell) => {
    view.move(middle(db.cellBox(cell)));
    return Array.from(view.ranges()).join();
  });
  db.dispose();
  return answers;
}
const expected = whole_answers();

async function pages_arrive_when_they_are_needed() {
  serve(send_range);
  let loaded = 0;
  const db = await open({ pageLoaded: () => ++loaded });
  require(db.paged && db.statistics().deliveredBytes === 0n, "a file without its pages");
  const tables = server.bytes;
  const view = db.createView();
  const after = [];
  for (let cell = 0; cell < db.info.cellCount; ++cell) {
    if (cell % 64 === 0) after.push(server.bytes);
    await arrive(view, middle(db.cellBox(cell)));
    equal(Array.from(view.ranges()).join(), expected[cell], `ranges of cell ${cell}`);
  }
  equal(loaded, Math.ceil(db.info.cellCount / 64), "pages");
  require(after.every((bytes, i) => i === 0 || bytes > after[i - 1]), `bytes before each page: ${after}`);
  equal(server.bytes, file.length, "bytes in all");
  db.dispose();
  return `tables ${tables}, before each page ${after.join(", ")} of ${file.length} bytes`;
}

// Bytes that arrived with the first request are not downloaded again.
async function nothing_is_downloaded_twice() {
  serve(send_range);
  const db = await open({ firstBytes: file.length - 1 });
  const view = db.createView();
  for (let cell = 0; cell < db.info.cellCount; ++cell) await arrive(view, middle(db.cellBox(cell)));
  equal([server.ranges.length, server.bytes], [2, file.length], "requests and bytes");
  db.dispose();
  serve(send_range);
  const small = await open({ firstBytes: undefined });
  equal([small.paged, server.ranges], [false, ["bytes=0-65535"]], "a small file");
  small.check();
  small.dispose();
}

async function the_last_set_is_kept_where_that_is_asked_for() {
  serve(send_range);
  const db = await open();
  const view = db.createView();
  view.setPolicy("all", Infinity, "last");
  await arrive(view, middle(db.cellBox(0)));
  const last = db.info.cellCount - 1;
  const { pending, drawAll, changed, cell } = view.move(middle(db.cellBox(last)));
  equal([pending, drawAll, changed, cell], [true, false, false, last], "while the page is on its way");
  equal(Array.from(view.ranges()).join(), expected[0], "ranges of the cell before");
  await until(() => !view.move(middle(db.cellBox(last))).pending, "the last page");
  equal(Array.from(view.ranges()).join(), expected[last], "ranges of the last cell");
  db.dispose();
}

async function pages_are_prefetched() {
  serve(send_range);
  const db = await open();
  const last = db.info.cellCount - 1;
  const view = db.createView();
  db.prefetch(middle(db.cellBox(0)), { x: 1000, y: 1000, z: 1000 }, 10);
  await until(() => Number(db.statistics().deliveredBytes) > 0 && server.bytes === file.length, "all pages");
  await until(() => !view.move(middle(db.cellBox(last))).pending, "the last page");
  equal(Array.from(view.ranges()).join(), expected[last], "ranges of the last cell");
  db.dispose();
}

async function servers_without_ranges_send_the_whole_file() {
  const hidden = (response, begin, end) => (begin === undefined ? send_whole(response)
    : send(response, 206, {}, file.subarray(begin, end)));  // as a page of another origin reads it
  const empty = (response) => send(response, 416, {}, "");
  for (const answer of [send_whole, hidden]) {
    serve(answer);
    const db = await open();
    require(!db.paged, "a whole file");
    db.check();
    db.dispose();
  }
  serve((response, begin) => (begin === undefined ? send_whole(response) : empty(response)), new Uint8Array(0));
  equal(await rejection_of(open()), "truncated", "an empty file");
  serve(send_range, readFileSync(join(golden, "v0_small.pvs")));
  equal(await rejection_of(open()), "version", "a file of version 0");
  serve(send_range);
  const large = await open({ residentBytes: 10 });
  equal(large.paged, false, "a page that is larger than residentBytes");
  large.dispose();
  serve(send_range);
  const whole = await open({ whole: true });
  equal([whole.paged, server.ranges], [false, [undefined]], "the option whole");
  whole.dispose();
}

async function errors_while_opening() {
  const short = (response, begin, end) => {
    const range = `bytes ${begin}-${end - 1}/${file.length}`;
    response.writeHead(206, { "Content-Range": range, "Content-Length": end - begin });
    response.write(file.subarray(begin, end - 1), () => response.destroy());
  };
  const later = (answer) => (response, begin, end) => (begin === 0 ? send_range : answer)(response, begin, end);
  const fewer = (response, begin, end) => send(response, 206,
    { "Content-Range": `bytes ${begin}-${end - 1}/${file.length}` }, file.subarray(begin, end - 1));
  const other = (response, begin, end) => send_range(response, begin + 1, end + 1);
  const longer = (response, begin, end) => send_range(response, begin, end, Buffer.concat([file, file]));
  const fails = (response) => send(response, 503, {}, "");
  const partial = (response) => send(response, 200, {}, file.subarray(1));
  const at_once = [fails, short, fewer], then = [fails, short, fewer, other, longer, partial];
  for (const answer of [...at_once, ...then.map(later)]) {
    serve(answer);
    equal(await rejection_of(open()), "io", answer);
  }
  serve(send_range, file.subarray(0, file.length - 1));
  equal(await rejection_of(open()), "truncated", "a file that lacks its end");
  serve(send_range, new Uint8Array(1000));
  equal(await rejection_of(open()), "not_ours", "zeros");
  const damaged = Buffer.from(file);
  damaged[4000] ^= 1;
  serve(send_range, damaged);
  equal(await rejection_of(open()), "checksum", "damaged tables");
  const abort = new AbortController();
  serve(() => abort.abort());
  equal(await rejection_of(open({ signal: abort.signal })), "AbortError", "a signal");
  const own = await Sightcell.load();
  serve((response, begin, end) => {
    if (begin > 0) own.dispose();
    send_range(response, begin, end);
  });
  equal(await rejection_of(own.openUrl(url, { firstBytes: first_bytes })), "disposed", "a module that is disposed");
}

async function failed_pages_are_asked_for_again() {
  serve(send_range);
  const errors = [];
  const abort = new AbortController();
  const db = await open({ pageFailed: (error) => errors.push(`${error.id}: ${error.message}`), signal: abort.signal });
  abort.abort();  // it was for opening
  const view = db.createView();
  const point = middle(db.cellBox(0));
  server.answer = (response) => send(response, 503, {}, "");
  const before = server.ranges.length;
  for (let i = 0; i < 50; ++i) {
    require(view.move(point).pending, "a page that has not arrived");
    await new Promise((later) => setTimeout(later, 2));
  }
  equal([server.ranges.length - before, errors], [1, [`io: sightcell: ${url}: status 503`]], "requests and errors");
  server.answer = send_range;
  await arrive(view, point);
  equal(Array.from(view.ranges()).join(), expected[0], "ranges of cell 0");

  // The page of the last cell, damaged.
  server.answer = (response, begin, end) => send_range(response, begin, end, Buffer.from(file).fill(0, begin));
  const last = middle(db.cellBox(db.info.cellCount - 1));
  view.move(last);
  await until(() => view.move(last).damaged, "a damaged page");
  require(view.frame.drawAll && errors.length === 2 && errors[1].startsWith("checksum: "), `${errors}`);
  // From now on the server ignores ranges.
  server.answer = send_whole;
  await arrive(view, middle(db.cellBox(64)));
  const requests = server.ranges.length;
  await arrive(view, middle(db.cellBox(128)));
  equal([Array.from(view.ranges()).join(), server.ranges.length], [expected[128], requests], "after the whole file");
  db.dispose();
}

// Nothing arrives in memory that was released, and no function of the module's table is left behind.
async function files_are_closed_while_pages_are_pending() {
  serve(send_range);
  let answers = [];
  let memory = 0;
  for (let i = 0; i < 100; ++i) {
    server.answer = send_range;
    const db = await open({ pageFailed: (error) => { throw error; } });
    const view = db.createView();
    server.answer = (...to) => answers.push(to);
    require(view.move(middle(db.cellBox(0))).pending, "a pending page");
    await until(() => answers.length > 0, "a request");
    db.dispose();
    for (const to of answers) send_range(...to);
    answers = [];
    if (i === 9) memory = sightcell.memoryBytes;
  }
  equal(sightcell.memoryBytes, memory, "memory after 100 files");
}

try {
  const walk = await pages_arrive_when_they_are_needed();
  await nothing_is_downloaded_twice();
  await the_last_set_is_kept_where_that_is_asked_for();
  await pages_are_prefetched();
  await servers_without_ranges_send_the_whole_file();
  await errors_while_opening();
  await failed_pages_are_asked_for_again();
  await files_are_closed_while_pages_are_pending();
  console.log(walk);
} finally {
  http.close();
  http.closeAllConnections();
}
