// The plugin in 3d-tiles-renderer in a headless Chromium: pictures, and only the tiles of the cells that were visited.
// usage: browser_tiles_test.mjs PACKAGE_FOLDER SITE_FOLDER NODE_MODULES THREE CHROMIUM
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { require } from "../host.mjs";
import { in_browser, most_wrong } from "./browser.mjs";

const [folder, sites, modules, three, chromium_path] = process.argv.slice(2);
const { cells } = JSON.parse(readFileSync(join(sites, "rooms.json"), "utf8"));
const poses = [
  [
    [4, 2, 4],
    [6, 1.5, 3],
  ],
  [
    [13, 2, 4],
    [12, 1.7, 8],
  ],
  [
    [22, 2, 4],
    [21, 1, 2],
  ],
];
const tiles = "/modules/3d-tiles-renderer/build/";
const imports = {
  "3d-tiles-renderer/three": `${tiles}index.three.js`,
  "3d-tiles-renderer/three/plugins": `${tiles}index.three-plugins.js`,
  "3d-tiles-renderer/core": `${tiles}index.core.js`,
  "3d-tiles-renderer/core/plugins": `${tiles}index.core-plugins.js`,
};
const { result, printed } = await in_browser(
  { folder, sites, modules, three, chromium_path, script: "browser_tiles_page.mjs", imports },
  (page) => page.evaluate((list) => globalThis.compare("/site/", "/sites/rooms.glb", list), poses),
);
const visited = [3, 1, 2];
require(result.map(({ cell }) => cell).join() === visited.join(), JSON.stringify(result));
result.forEach(({ wrong, loaded, visible }, i) => {
  require(wrong <= most_wrong, `cell ${visited[i]}: ${wrong} pixels differ`);
  const pages = new Set([0, ...visited.slice(0, i + 1).flatMap((cell) => cells[cell].pages)]);
  require(loaded === pages.size, `cell ${visited[i]}: ${loaded} tiles are loaded, ${pages.size} were needed`);
  const own = 1 + cells[visited[i]].pages.length;
  require(visible === own, `cell ${visited[i]}: ${visible} tiles are visible, ${own} are needed`);
});
// 3d-tiles-renderer warns of all tilesets of 3D Tiles 1.1.
const others = printed.filter((text) => !text.startsWith("TilesRenderer: tiles versions at 1.1"));
require(others.length === 0, `the console has: ${others.join("\n")}`);
console.log(result.map(({ wrong, loaded }) => `${wrong} wrong, ${loaded} tiles`).join("; "));
