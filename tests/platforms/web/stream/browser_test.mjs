// The client in a headless Chromium: pictures of each cell against those of the whole .glb by GLTFLoader.
// usage: browser_test.mjs PACKAGE_FOLDER SITE_FOLDER NODE_MODULES THREE CHROMIUM [PICTURES]
// THREE: three or three_oldest. PICTURES: a folder for pictures of the streamed scene.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import { require } from "../host.mjs";
import { in_browser, most_wrong } from "./browser.mjs";

const [folder, sites, modules, three, chromium_path, pictures] = process.argv.slice(2);
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

const { result, printed } = await in_browser(
  { folder, sites, modules, three, chromium_path, script: "browser_page.mjs" },
  async (page) => ({
    ...(await page.evaluate((list) => globalThis.compare("/site/", "/sites/rooms.glb", ...list), [poses, [large]])),
    memories: await page.evaluate(() => globalThis.open_and_dispose("/site/", 20)),
  }),
);
if (pictures !== undefined) {
  result.shown.forEach((url, i) => writeFileSync(join(pictures, `${three}_${i}.png`), url.split(",")[1], "base64"));
}
const cells = result.poses.map(({ cell }) => cell).join();
require(cells === "3,0,1,1,2,2", `cells ${cells}`);
for (const { cell, wrong } of [...result.poses, { cell: "moved", wrong: result.moved }]) {
  require(wrong <= most_wrong, `cell ${cell}: ${wrong} pixels differ`);
}
require(result.errors.length === 0, `${result.errors}`);
require(new Set(result.memories.slice(2)).size === 1, `geometries and textures grow: ${result.memories.join(", ")}`);
require(printed.length === 0, `the console has: ${printed.join("\n")}`);
const list = result.poses.map(({ wrong, calls, whole_calls }) => `${wrong} wrong (${calls} calls, ${whole_calls})`);
console.log(`${three}: ${list.join(", ")}; left ${JSON.stringify(result.memory)}`);
