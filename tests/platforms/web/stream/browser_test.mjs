// The client in a headless Chromium: pictures of each cell against those of the whole .glb by GLTFLoader.
// usage: browser_test.mjs PACKAGE_FOLDER SITE_FOLDER NODE_MODULES THREE CHROMIUM [PICTURES]
// THREE: three or three_oldest. PICTURES: a folder for pictures of the streamed scene.
import { readFileSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

import { require } from "../host.mjs";

const [folder, sites, modules, three, chromium_path, pictures] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(resolve(modules, "playwright-core", "index.mjs")).href);
const most_wrong = 230;  // of 230,400 pixels, as for the native client
const roots = {
  "/three/": join(modules, three),
  "/package/": folder,
  "/site/": join(sites, "rooms.site"),
  "/sites/": sites,
  "/test/": dirname(fileURLToPath(import.meta.url)),
};
const types = {
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".glb": "model/gltf-binary",
  ".webp": "image/webp",
  ".png": "image/png",
};
const imports = {
  three: "/three/build/three.module.js",
  "three/addons/": "/three/examples/jsm/",
  "sightcell-stream": "/package/stream.js",
};
const page_text = `<!doctype html><link rel="icon" href="data:,">
<script type="importmap">${JSON.stringify({ imports })}</script>
<body style="margin:0"><script type="module" src="/test/browser_page.mjs"></script>`;

const server = createServer((request, response) => {
  const path = normalize(new URL(request.url, "http://host").pathname);
  const root = Object.keys(roots).find((each) => path.startsWith(each));
  try {
    const body = path === "/" ? page_text : readFileSync(join(roots[root], path.slice(root.length)));
    const cache = path.endsWith(".front") ? "no-cache" : "public, max-age=31536000, immutable";
    response.writeHead(200, {
      "Content-Type": path === "/" ? "text/html" : (types[extname(path)] ?? "application/octet-stream"),
      "Cache-Control": cache,
    });
    response.end(body);
  } catch {
    response.writeHead(404);
    response.end();
  }
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const browser = await chromium.launch({
  executablePath: chromium_path,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  const page = await browser.newPage();
  const printed = [];
  page.on("console", (message) => printed.push(message.text()));
  page.on("pageerror", (error) => printed.push(error.stack));
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  await page.waitForFunction(() => globalThis.compare !== undefined, undefined, { timeout: 60000 });
  const large = JSON.parse(readFileSync(join(sites, "rooms.json"), "utf8")).images[0][1].url;
  const poses = [
    [
      [4, 2, 4],
      [6, 1.5, 3],
    ],
    [
      [3.5, 2, 2],
      [4, 1.7, 4.5],
    ],
    [
      [13, 2, 4],
      [12, 1.7, 8],
    ],
    [
      [13, 2, 2],
      [14, 1, 4],
    ],
    [
      [22, 2, 4],
      [21, 1, 2],
    ],
    [
      [20, 2, 6],
      [24, 1, 2],
    ],
  ];
  const {
    poses: found,
    shown,
    moved,
    memory,
    errors,
  } = await page.evaluate(
    ([list, file]) => globalThis.compare("/site/", "/sites/rooms.glb", list, [file]),
    [poses, large],
  );
  if (pictures !== undefined) {
    shown.forEach((url, i) =>
      writeFileSync(join(pictures, `${three}_${i}.png`), Buffer.from(url.split(",")[1], "base64")),
    );
  }
  require(found.map(({ cell }) => cell).join() === "3,0,1,1,2,2", `cells ${found.map(({ cell }) => cell)}`);
  for (const { cell, wrong } of [...found, { cell: "moved", wrong: moved }]) {
    require(wrong <= most_wrong, `cell ${cell}: ${wrong} pixels differ`);
  }
  require(errors.length === 0, `${errors}`);
  const memories = await page.evaluate(() => globalThis.open_and_dispose("/site/", 20));
  require(new Set(memories.slice(2)).size === 1, `geometries and textures grow: ${memories.join(", ")}`);
  require(printed.length === 0, `the console has: ${printed.join("\n")}`);
  const list = found.map(({ wrong, calls, whole_calls }) => `${wrong} wrong (${calls} calls, ${whole_calls})`);
  console.log(`${three}: ${list.join(", ")}; left ${JSON.stringify(memory)}`);
} finally {
  await browser.close();
  server.close();
}
