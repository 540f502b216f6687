// The module exports exactly what sightcell.h declares and what a page needs to call it. It imports nothing and has at most
// BYTES of code. usage: exports_test.mjs MODULE.wasm HEADER BYTES
import { readFileSync } from "node:fs";

import { require } from "./host.mjs";

const [path, header, limit] = process.argv.slice(2);
const bytes = readFileSync(path);
const module = await WebAssembly.compile(bytes);

const text = readFileSync(header, "utf8");
const declared = Array.from(text.matchAll(/^SIGHTCELL_API [^;(]*?(sightcell_\w+)\(/gm), (match) => match[1]);
require(declared.length > 0, `${header} declares nothing`);
const wanted = [...declared, "malloc", "free", "memory", "__indirect_function_table"].sort();
const exported = WebAssembly.Module.exports(module).map((e) => e.name).sort();
const only = (a, b) => a.filter((name) => !b.includes(name));
require(exported.join() === wanted.join(),
  `exported only: ${only(exported, wanted)}\ndeclared only: ${only(wanted, exported)}`);

const imports = WebAssembly.Module.imports(module);
require(imports.length === 0, `imports: ${JSON.stringify(imports)}`);

// Sizes of all sections. A section begins with a byte for its kind and its size as a number of 7 bits per byte.
const sizes = new Map();
for (let at = 8; at < bytes.length;) {
  const id = bytes[at++];
  let size = 0;
  for (let shift = 0, more = true; more; shift += 7) {
    size |= (bytes[at] & 127) << shift;
    more = bytes[at++] >= 128;
  }
  sizes.set(id, (sizes.get(id) ?? 0) + size);
  at += size;
}
const code = sizes.get(10);
console.log(`${code} bytes of code, ${sizes.get(11) ?? 0} of data, ${bytes.length} in all; at most ${limit} of code`);
require(code > 0 && code <= Number(limit), "too much code");
