// A page in a headless Chromium, over a server of files.
import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

export const most_wrong = 230;  // of the 230,400 pixels of a picture, as for the native client

const types = {
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".glb": "model/gltf-binary",
  ".webp": "image/webp",
};

function serve(roots, text) {
  const server = createServer((request, response) => {
    const path = normalize(new URL(request.url, "http://host").pathname);
    const root = Object.keys(roots).find((each) => path.startsWith(each));
    try {
      const file = path === "/" ? "" : join(roots[root], path.slice(root.length));
      const copy = `${file}.gz`;  // as docs/streaming.md tells servers to send it
      const compressed = path !== "/" && existsSync(copy) && /gzip/.test(request.headers["accept-encoding"]);
      const body = path === "/" ? text : readFileSync(compressed ? copy : file);
      const type = path === "/" ? "text/html" : (types[extname(path)] ?? "application/octet-stream");
      const cache = path.endsWith(".front") ? "no-cache" : "public, max-age=31536000, immutable";
      const headers = { "Content-Type": type, "Cache-Control": cache };
      if (compressed) headers["Content-Encoding"] = "gzip";
      response.writeHead(200, headers);
      response.end(body);
    } catch {
      response.writeHead(404);
      response.end();
    }
  });
  return new Promise((done) => server.listen(0, "127.0.0.1", () => done(server)));
}

// act(page): with a page that has run `script`, a file beside this one. Returns what act returns, and what the page has
// printed. modules: the folder of npm packages. three: the name of the one that is three.js.
export async function in_browser({ folder, sites, modules, three, chromium_path, script, imports = {} }, act) {
  const { chromium } = await import(pathToFileURL(resolve(modules, "playwright-core", "index.mjs")).href);
  const roots = {
    "/three/": join(modules, three),
    "/package/": folder,
    "/site/": join(sites, "rooms.site"),
    "/sites/": sites,
    "/test/": dirname(fileURLToPath(import.meta.url)),
    "/modules/": modules,
  };
  const all = {
    three: "/three/build/three.module.js",
    "three/addons/": "/three/examples/jsm/",
    "sightcell-stream": "/package/stream.js",
    "sightcell-stream/tiles": "/package/tiles.js",
    ...imports,
  };
  const server = await serve(
    roots,
    `<!doctype html><link rel="icon" href="data:,">
<script type="importmap">${JSON.stringify({ imports: all })}</script>
<body style="margin:0"><script type="module" src="/test/${script}"></script>`,
  );
  const browser = await chromium.launch({
    executablePath: chromium_path,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  try {
    const page = await browser.newPage(),
      printed = [];
    page.on("console", (message) => printed.push(message.text()));
    page.on("pageerror", (error) => printed.push(error.stack));
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    await page.waitForFunction(() => globalThis.ready, undefined, { timeout: 60000 });
    return { result: await act(page), printed };
  } finally {
    await browser.close();
    server.close();
  }
}
