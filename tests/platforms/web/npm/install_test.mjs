// The tarball is small, and a project that installs it and nothing else can use it.
// usage: install_test.mjs PACKAGE_FOLDER TARBALL NPM FILE.pvs FILE.txt BYTES    BYTES: the most that the tarball may have
import { spawnSync } from "node:child_process";
import { copyFileSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { require } from "../host.mjs";

const [folder, tarball, npm, file, text, limit] = process.argv.slice(2);
const size = statSync(tarball).size;
require(size <= Number(limit), `the tarball has ${size} bytes, more than ${limit}`);

function run(command, args, options) {
  const done = spawnSync(command, args, { encoding: "utf8", ...options });
  require(done.status === 0, `${command} ${args.join(" ")}: ${done.error ?? done.status}\n${done.stdout}${done.stderr}`);
  return done.stdout;
}

const project = mkdtempSync(join(tmpdir(), "sightcell-test-"));
try {
  writeFileSync(join(project, "package.json"), '{ "name": "empty", "private": true }\n');
  // Nothing of the user's own npm: no cache, no configuration.
  const environment = { ...process.env, HOME: project, npm_config_cache: join(project, ".npm") };
  run(npm, ["install", "--offline", "--no-audit", "--no-fund", resolve(tarball)], { cwd: project, env: environment });
  const modules = join(project, "node_modules");
  const installed = readdirSync(modules).filter((name) => !name.startsWith("."));
  require(installed.join() === "sightcell", `installed: ${installed}`);

  // What is installed is the folder, with each file that it names.
  const there = readdirSync(join(modules, "sightcell")).sort().join();
  require(there === readdirSync(folder).sort().join(), `the package has ${there}`);
  const { exports, types, dependencies } = JSON.parse(readFileSync(join(modules, "sightcell", "package.json"), "utf8"));
  require(dependencies === undefined, "the package has dependencies");
  const names = Object.values(exports).flatMap((each) => (typeof each === "string" ? [each] : Object.values(each)));
  for (const name of [types, ...names]) require(existsSync(join(modules, "sightcell", name)), `no ${name}`);

  const here = dirname(fileURLToPath(import.meta.url));
  for (const name of ["user.mjs", "show.mjs"]) copyFileSync(join(here, name), join(project, name));
  const shown = readFileSync(join(here, "show.mjs"), "utf8").match(/\/\* \[package \*\/\n(.*?)\/\* package\] \*\//s)[1];
  require(readFileSync(join(modules, "sightcell", "README.md"), "utf8").includes(`\`\`\`js\n${shown}\`\`\``), "README.md");
  const found = JSON.parse(run(process.execPath, ["--no-warnings", "user.mjs", resolve(file)], { cwd: project }));
  const expected = readFileSync(text, "utf8").match(/^cell 0: .*?  .*?  sees(.*)/m)[1].trim().split(" ").length;
  const polygons = found.ranges.reduce((sum, number, i) => sum + (i % 3 === 2 ? number : 0), 0);
  require(found.cell === 0 && polygons === expected, `${polygons} polygons of ${expected}`);
  require(found.shown.join() === [...new Set(found.ranges.filter((_, i) => i % 3 === 0))].join(), `shown: ${found.shown}`);
  require(found.id === "not_ours" && found.wasm, JSON.stringify(found));
  require(tarball.endsWith(`sightcell-${found.version}.tgz`), found.version);
  console.log(`${size} bytes, at most ${limit}`);
} finally {
  rmSync(project, { recursive: true });
}
