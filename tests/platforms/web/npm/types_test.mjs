// The declarations of the package are its exports and members, and where TypeScript is there, a program that uses each of
// them compiles in strict mode. usage: types_test.mjs PACKAGE_FOLDER [NODE_MODULES]    NODE_MODULES: with typescript
import { spawnSync } from "node:child_process";
import { copyFileSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

import { require } from "../host.mjs";

const [folder, modules] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));
const all = (text, pattern) => Array.from(text.matchAll(pattern), (match) => match[1]);
const sorted = (names) => Array.from(new Set(names)).sort().join();

// The names of the functions and of what is read, without those of JavaScript.
function members_of(made) {
  const names = Object.getOwnPropertyNames(made.prototype).concat(Object.getOwnPropertyNames(made));
  return names.filter((name) => !["constructor", "length", "name", "prototype"].includes(name));
}

// Members that only instances have, as they are no functions.
const of_instances = { SightcellError: ["id"], View: ["database"] };
const internal = { SightcellError: ["ofStatus"], Database: ["open"], View: ["create"] };

async function check_module(name) {
  const text = readFileSync(join(folder, `${name}.d.ts`), "utf8").replaceAll(/\/\*.*?\*\/|\/\/[^\n]*/gs, "");
  const module = await import(pathToFileURL(resolve(folder, `${name}.js`)).href);
  const classes = { ...await import(pathToFileURL(resolve(folder, "database.js")).href),
    ...await import(pathToFileURL(resolve(folder, "view.js")).href), ...module };
  const declared = all(text, /^export (?:class|const|function) (\w+)/gm);
  // Classes that no page makes are declared as types.
  const types = ["Database", "View"].filter((each) => declared.includes(each));
  require(sorted(Object.keys(module)) === sorted(declared.filter((each) => !types.includes(each))),
    `${name}: exports ${Object.keys(module)}, declarations ${declared}`);
  const users = readFileSync(join(here, "types_user.ts"), "utf8");
  for (const [, each, body] of text.matchAll(/^export (?:class|interface) (\w+)[^{]*\{\n(.*?)^\}/gms)) {
    const members = all(body, /^ {2}(?:static |readonly )*(\w+)\??[(:]/gm).filter((member) => member !== "constructor");
    for (const member of members) require(users.includes(member), `types_user.ts does not use ${each}.${member}`);
    if (classes[each] === undefined) continue;  // an interface
    const found = members_of(classes[each]).filter((member) => !internal[each]?.includes(member));
    require(sorted(members) === sorted(found.concat(of_instances[each] ?? [])), `${each} has ${found}, declared ${members}`);
  }
  for (const each of all(text, /^export (?:\w+) (\w+)/gm)) require(users.includes(each), `types_user.ts does not use ${each}`);
}

function compile() {
  const project = mkdtempSync(join(tmpdir(), "sightcell-test-"));
  try {
    writeFileSync(join(project, "package.json"), '{ "type": "module" }\n');
    mkdirSync(join(project, "node_modules"));
    cpSync(folder, join(project, "node_modules", "sightcell"), { recursive: true });
    copyFileSync(join(here, "types_user.ts"), join(project, "types_user.ts"));
    const done = spawnSync(process.execPath, [join(resolve(modules), "typescript", "bin", "tsc"), "--noEmit", "--strict",
      "--noUncheckedIndexedAccess", "--exactOptionalPropertyTypes", "--module", "nodenext", "--target", "es2022", "--lib",
      "es2022,dom", "types_user.ts"], { cwd: project, encoding: "utf8" });
    require(done.status === 0, `tsc: ${done.error ?? done.status}\n${done.stdout}${done.stderr}`);
  } finally {
    rmSync(project, { recursive: true });
  }
}

await check_module("sightcell");
if (modules !== undefined) compile();
console.log(modules === undefined ? "not compiled: no TypeScript" : "compiled");
