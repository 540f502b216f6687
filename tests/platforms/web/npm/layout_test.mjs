// layout.js has the offsets, sizes and values of sightcell.h: a compiler confirms each number by a static assertion, and
// rejects a wrong one. usage: layout_test.mjs PACKAGE_FOLDER HEADER CLANG TARGET
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { require } from "../host.mjs";

const [folder, header, clang, target] = process.argv.slice(2);
const { constants, structs } = await import(pathToFileURL(resolve(folder, "layout.js")).href);
const text = readFileSync(header, "utf8");
const bytes = { u8: 1, u32: 4, u64: 8, f32: 4, f64: 8 };
const types = { u8: "uint8_t", u32: "uint32_t", u64: "uint64_t", f32: "float", f64: "double" };

function assertions() {
  const list = Object.entries(constants).map(([name, value]) => `(unsigned)SIGHTCELL_${name} == ${value}u`);
  for (const [name, { size, members }] of Object.entries(structs)) {
    list.push(`sizeof(sightcell_${name}) == ${size}`);
    for (const [member, { at, kind, count = 1 }] of Object.entries(members)) {
      list.push(`offsetof(sightcell_${name}, ${member}) == ${at}`);
      list.push(`sizeof(((sightcell_${name}*)0)->${member}) == ${bytes[kind] * count}`);
      if (text.includes(`(*${member})(`) || member === "user") continue;  // addresses
      const type = `__typeof__(${count > 1 ? "*" : ""}((sightcell_${name}*)0)->${member})`;
      list.push(`__builtin_types_compatible_p(${type}, ${types[kind]})`);
    }
  }
  return list;
}

function compiles(list) {
  const source = [`#include "${resolve(header)}"`, ...list.map((each) => `_Static_assert(${each}, "${each}");`)].join("\n");
  const done = spawnSync(clang, [`--target=${target}`, "-std=gnu11", "-fsyntax-only", "-x", "c", "-"],
    { input: source, encoding: "utf8" });
  require(done.error === undefined, `${clang}: ${done.error}`);
  return { good: done.status === 0, errors: done.stderr };
}

// Each struct of the header and each of its constants is there.
const named = (pattern) => Array.from(text.matchAll(pattern), (match) => match[1]);
const declared = named(/^typedef struct sightcell_(\w+) \{/gm);
require(declared.length > 5 && declared.every((name) => name in structs), `structs: ${declared}`);
const valued = [...named(/^ +SIGHTCELL_(\w+) = /gm), ...named(/^#define SIGHTCELL_(\w+) \d/gm)];
require(valued.length > 20 && valued.every((name) => name in constants), `constants: ${valued}`);
for (const name of declared) {
  const body = text.match(new RegExp(`^typedef struct sightcell_${name} \\{(.*?)^\\}`, "ms"))[1];
  const members = body.replaceAll(/\/\*.*?\*\//gs, "").split(";").map((each) => each.trim()).filter((each) => each !== "");
  const count = members.reduce((sum, each) => sum + (each.includes("(") ? 1 : each.split(",").length), 0);
  require(Object.keys(structs[name].members).length === count, `${name} has ${count} members`);
}

const list = assertions();
const { good, errors } = compiles(list);
require(good, errors);
require(!compiles([...list, `offsetof(sightcell_draw, host_tag) == ${structs.draw.members.host_tag.at + 4}`]).good,
  "a wrong offset is accepted");
console.log(`${list.length} numbers`);
