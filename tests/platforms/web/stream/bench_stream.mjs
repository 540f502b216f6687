// What a first visit of streamed scenes takes in Chromium over a slow connection, which its developer tools imitate.
// usage: bench_stream.mjs PACKAGE_FOLDER NODE_MODULES CHROMIUM POSES MBIT_PER_SECOND LATENCY_MS SITE_FOLDER ...
// A pose is a random point of a random cell with a random heading, and starts with nothing. Prints a row per site: median
// and largest of seconds and bytes.
import { mkdtempSync, readFileSync, rmSync, symlinkSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { require } from "../host.mjs";
import { in_browser } from "./browser.mjs";

const [folder, modules, chromium_path, poses, rate, latency, ...given] = process.argv.slice(2);
const sites = mkdtempSync(join(tmpdir(), "sightcell-bench-"));
process.on("exit", () => rmSync(sites, { recursive: true }));
const { readChunk, readFront } = await import(pathToFileURL(resolve(folder, "format.js")).href);

const exact = (bytes) => bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);

async function cells_of(site) {
  const read = (...path) => exact(readFileSync(join(site, ...path)));
  const front = await readFront(read("scene.front"), "https://host/scene.front");
  const chunks = front.chunks.map((file) => readChunk(read("cells", basename(file.url)), file, front));
  return (await Promise.all(chunks)).flat();
}

function poses_in(cells, count) {
  let state = 1;
  const random = () => {
    state = (state * 48271) % 2147483647;
    return state / 2147483647;
  };
  return Array.from({ length: count }, () => {
    const { box } = cells[Math.floor(random() * cells.length)];
    const eye = [0, 1, 2].map((axis) => box[axis] + random() * (box[axis + 3] - box[axis]));
    const heading = 2 * Math.PI * random();
    return [eye, [eye[0] + Math.cos(heading), eye[1], eye[2] + Math.sin(heading)]];
  });
}

async function visit(page, name, pose) {
  await page.reload();
  await page.waitForFunction(() => globalThis.ready);
  const tools = await page.context().newCDPSession(page);
  const bytes_per_second = (Number(rate) * 1e6) / 8;
  await tools.send("Network.enable");
  await tools.send("Network.clearBrowserCache");
  await tools.send("Network.emulateNetworkConditions",
    { offline: false, latency: Number(latency), downloadThroughput: bytes_per_second, uploadThroughput: bytes_per_second });
  const found = await page.evaluate(([site, at]) => globalThis.measure(site, at), [`/sites/${name}/`, pose]);
  require(found.errors.length === 0, `${name}: ${found.errors}`);
  await tools.detach();
  return found;
}

function both(numbers, digits, scale = 1) {
  const list = numbers.map((number) => number / scale).sort((a, b) => a - b);
  const middle = (list[Math.floor((list.length - 1) / 2)] + list[Math.ceil((list.length - 1) / 2)]) / 2;
  return `${middle.toFixed(digits)},${list.at(-1).toFixed(digits)}`;
}

console.log("scene,cells,poses,seconds_99.9,seconds_99.9_max,kb_99.9,kb_99.9_max,seconds,seconds_max,kb,kb_max");
for (const site of given) {
  const name = basename(resolve(site));
  symlinkSync(resolve(site), join(sites, name));
  const cells = await cells_of(site);
  const { result } = await in_browser({ folder, sites, modules, three: "three", chromium_path, script: "bench_page.mjs" },
    async (page) => {
      const visits = [];
      for (const pose of poses_in(cells, Number(poses))) visits.push(await visit(page, name, pose));
      return visits;
    });
  const columns = ["most", "complete"].flatMap((level) => [
    both(result.map((each) => each[level].seconds), 2), both(result.map((each) => each[level].bytes), 0, 1000)]);
  console.log([name, cells.length, result.length, ...columns].join());
}
