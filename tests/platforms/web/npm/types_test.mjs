// The declarations of the package are its exports and members, and where TypeScript is there, a program that uses each of
// them compiles in strict mode. usage: types_test.mjs PACKAGE_FOLDER [NODE_MODULES]    NODE_MODULES: with typescript, three
import { spawnSync } from "node:child_process";
import { copyFileSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

import { require } from "../host.mjs";

const [folder, modules] = process.argv.slice(2);
const users = ["types_user.ts", "types_user_three.ts"];
const here = dirname(fileURLToPath(import.meta.url));
const all = (text, pattern) => Array.from(text.matchAll(pattern), (match) => match[1]);
const sorted = (names) => Array.from(new Set(names)).sort().join();

// The names of the functions and of what is read, without those of JavaScript.
function members_of(made) {
  const names = Object.getOwnPropertyNames(made.prototype).concat(Object.getOwnPropertyNames(made));
  return names.filter((name) => !["constructor", "length", "name", "prototype"].includes(name));
}

// Members that only instances have, as they are no functions.
const of_instances = { SightcellError: ["id"], View: ["database"], DebugOverlay: ["lines"] };
const internal = { SightcellError: ["ofStatus"], Database: ["open", "ofPages"], View: ["create"] };

async function check_module(from, name, user) {
  const text = readFileSync(join(from, `${name}.d.ts`), "utf8").replaceAll(/\/\*.*?\*\/|\/\/[^\n]*/gs, "");
  const load = (file) => import(pathToFileURL(join(from, file)).href);
  const module = await load(`${name}.js`);
  const classes = { ...await load("database.js"), ...await load("view.js"), ...module };
  const declared = all(text, /^export (?:class|const|function) (\w+)/gm);
  // Classes that no page makes are declared as types.
  const types = ["Database", "View"].filter((each) => declared.includes(each));
  require(sorted(Object.keys(module)) === sorted(declared.filter((each) => !types.includes(each))),
    `${name}: exports ${Object.keys(module)}, declarations ${declared}`);
  const used = readFileSync(join(here, user), "utf8");
  for (const [, each, body] of text.matchAll(/^export (?:class|interface) (\w+)[^{]*\{\n(.*?)^\}/gms)) {
    const members = all(body, /^ {2}(?:static |readonly )*(\w+)\??[(:]/gm).filter((member) => member !== "constructor");
    for (const member of members) require(used.includes(member), `${user} does not use ${each}.${member}`);
    if (classes[each] === undefined) continue;  // an interface
    const found = members_of(classes[each]).filter((member) => !internal[each]?.includes(member));
    require(sorted(members) === sorted(found.concat(of_instances[each] ?? [])), `${each} has ${found}, declared ${members}`);
  }
  for (const each of all(text, /^export (?:\w+) (\w+)/gm)) require(used.includes(each), `${user} does not use ${each}`);
}

// What three.d.ts takes of three.js, whose types are a package of their own with more packages.
const three_types = `declare module 'three' {
  export class Object3D { name: string; children: Object3D[]; }
  export class Camera extends Object3D { projectionMatrix: object; }
  export class Mesh extends Object3D { geometry: object; }
  export class BatchedMesh extends Mesh { customSort: object; }
  export class LineSegments extends Object3D { isLineSegments: true; }
}
`;

function compile(project) {
  writeFileSync(join(project, "three_types.d.ts"), three_types);
  for (const user of users) copyFileSync(join(here, user), join(project, user));
  const done = spawnSync(process.execPath, [join(resolve(modules), "typescript", "bin", "tsc"), "--noEmit", "--strict",
    "--noUncheckedIndexedAccess", "--exactOptionalPropertyTypes", "--module", "nodenext", "--target", "es2022", "--lib",
    "es2022,dom", "three_types.d.ts", ...users], { cwd: project, encoding: "utf8" });
  require(done.status === 0, `tsc: ${done.error ?? done.status}\n${done.stdout}${done.stderr}`);
}

const project = mkdtempSync(join(tmpdir(), "sightcell-test-"));
process.on("exit", () => rmSync(project, { recursive: true }));
writeFileSync(join(project, "package.json"), '{ "type": "module" }\n');
const installed = join(project, "node_modules", "sightcell");
mkdirSync(join(project, "node_modules"));
cpSync(folder, installed, { recursive: true });
await check_module(installed, "sightcell", users[0]);
if (modules !== undefined) {
  symlinkSync(resolve(modules, "three"), join(project, "node_modules", "three"));
  await check_module(installed, "three", users[1]);
  await check_module(installed, "three_overlay", users[1]);
  compile(project);
}
console.log(modules === undefined ? "not compiled: no TypeScript" : "compiled");
