// A static web server with byte ranges, as any host of a site has them. Lists what was asked for. headers: sent with each
// answer.
import { createServer } from "node:http";
import { existsSync, readFileSync, statSync } from "node:fs";
import { extname, join, normalize } from "node:path";

const types = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml",
  ".json": "application/json", ".wasm": "application/wasm", ".glb": "model/gltf-binary" };

export async function serve(folder, headers_of_all = {}) {
  const asked = [];
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url, "http://localhost");
    const path = join(folder, normalize(pathname === "/" ? "/index.html" : decodeURIComponent(pathname)));
    const entry = { method: request.method, path: pathname, range: request.headers.range, status: 404, bytes: 0 };
    asked.push(entry);
    if (!existsSync(path) || !statSync(path).isFile()) {
      response.writeHead(404).end();
      return;
    }
    const content = readFileSync(path);
    const headers = { ...headers_of_all, "Content-Type": types[extname(path)] ?? "application/octet-stream" };
    const [, begin, last] = request.headers.range?.match(/^bytes=(\d+)-(\d+)$/)?.map(Number) ?? [];
    let body = content;
    entry.status = 200;
    if (begin < content.length) {
      const end = Math.min(last + 1, content.length);
      body = content.subarray(begin, end);
      entry.status = 206;
      headers["Content-Range"] = `bytes ${begin}-${end - 1}/${content.length}`;
    }
    entry.bytes = body.length;
    response.writeHead(entry.status, headers).end(body);
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  return {
    url: `http://127.0.0.1:${server.address().port}/`,
    asked,
    close() {
      server.close();
      server.closeAllConnections();
    },
  };
}
