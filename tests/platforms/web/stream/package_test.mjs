// The tarball is small, an empty project can install it, and its declarations compile.
// usage: package_test.mjs PACKAGE_FOLDER SITE_FOLDER TARBALL NPM BYTES [NODE_MODULES]
// BYTES: the most that the tarball may have. NODE_MODULES: with typescript
import { spawnSync } from "node:child_process";
import {
  copyFileSync,
  existsSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  rmSync,
  statSync,
  writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { require } from "../host.mjs";

const [folder, , tarball, npm, limit, modules] = process.argv.slice(2);
const size = statSync(tarball).size;
require(size <= Number(limit), `the tarball has ${size} bytes, more than ${limit}`);
const project = mkdtempSync(join(tmpdir(), "sightcell-test-"));
process.on("exit", () => rmSync(project, { recursive: true }));

function run(command, args, env = process.env) {
  const done = spawnSync(command, args, { cwd: project, env, encoding: "utf8" });
  require(done.status ===
    0, `${command} ${args.join(" ")}: ${done.error ?? done.status}\n${done.stdout}${done.stderr}`);
}

writeFileSync(join(project, "package.json"), '{ "name": "empty", "private": true, "type": "module" }\n');
// Nothing of the user's own npm, and no three.js, which a project has itself.
const environment = { ...process.env, HOME: project, npm_config_cache: join(project, ".npm") };
run(npm, ["install", "--offline", "--legacy-peer-deps", "--no-audit", "--no-fund", resolve(tarball)], environment);
const installed = join(project, "node_modules", "sightcell-stream");
const there = readdirSync(installed).sort().join();
require(there === readdirSync(folder).sort().join(), `the package has ${there}`);
const { exports, types, dependencies, peerDependencies } = JSON.parse(
  readFileSync(join(installed, "package.json"), "utf8"),
);
require(dependencies === undefined && peerDependencies.three === ">=0.167.0", "dependencies");
const names = Object.values(exports).flatMap((each) => (typeof each === "string" ? [each] : Object.values(each)));
for (const name of [types, ...names]) require(existsSync(join(installed, name)), `no ${name}`);
for (const name of readdirSync(installed).filter((each) => each.endsWith(".js"))) {
  require(!/^ *(\/\/|\/\*)/m.test(readFileSync(join(installed, name), "utf8")), `${name} has comments`);
}

// What stream.d.ts takes of three.js, whose types are a package of their own with more packages.
const three_types = `declare module 'three' {
  export class Object3D { name: string; children: Object3D[]; }
  export class Camera extends Object3D { projectionMatrix: object; }
  export class Group extends Object3D { isGroup: true; }
  export class Mesh extends Object3D { geometry: object; }
  export class Matrix4 { elements: number[]; }
}
`;
if (modules !== undefined) {
  writeFileSync(join(project, "three_types.d.ts"), three_types);
  copyFileSync(join(dirname(fileURLToPath(import.meta.url)), "types_user.ts"), join(project, "types_user.ts"));
  run(process.execPath, [
    join(resolve(modules), "typescript", "bin", "tsc"),
    "--noEmit",
    "--strict",
    "--noUncheckedIndexedAccess",
    "--exactOptionalPropertyTypes",
    "--module",
    "nodenext",
    "--target",
    "es2022",
    "--lib",
    "es2022,dom",
    "three_types.d.ts",
    "types_user.ts",
  ]);
}
console.log(`${size} bytes, at most ${limit}${modules === undefined ? "; not compiled: no TypeScript" : ""}`);
