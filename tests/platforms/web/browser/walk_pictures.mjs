// Pictures of the sample's page with and without the PVS, at places of a random walk.
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import { require } from "../host.mjs";

/** What runs in the page: pictures of the same viewpoint, and a person who walks at random. */
export function tools() {
  const { walk } = globalThis;
  const gl = walk.renderer.getContext();
  const start = walk.walker.eye.clone();
  let seed = 12345;
  const random = () => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return seed / 2 ** 32;
  };
  const picture = () => {
    const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels;
  };
  globalThis.tools = {
    /** The picture with the PVS and without, and how many pixels of each half differ by more than 8 levels. */
    compare() {
      walk.set({ pvs: true });
      const frame = walk.draw();
      const { drawn } = walk;
      const culled = picture();
      walk.set({ pvs: false });
      walk.draw();
      const all = picture();
      const off = walk.drawn;
      walk.set({ pvs: true });
      const differ = (at) => [0, 1, 2].some((k) => Math.abs(culled[at + k] - all[at + k]) > 8);
      const wrong = [0, 0];
      const half = gl.drawingBufferWidth / 2;
      for (let i = 0; i < all.length / 4; ++i) if (differ(4 * i)) ++wrong[i % gl.drawingBufferWidth < half ? 0 : 1];
      const shades = new Set();
      for (let at = 0; at < all.length; at += 4) shades.add(all[at] << 16 | all[at + 1] << 8 | all[at + 2]);
      return { cell: frame.cell, drawAll: frame.drawAll, wrong, shades: shades.size, on: drawn, off,
        pixels: all.length / 4 };
    },
    back_to_start() {
      walk.walker.place(start);
      walk.frame(performance.now());
    },
    /** Walks a few meters and looks somewhere. */
    stroll() {
      const heading = 2 * Math.PI * random();
      const way = walk.rig.position.clone().set(Math.sin(heading), 0, Math.cos(heading)).multiplyScalar(0.08);
      for (let i = 0; i < 150; ++i) walk.walker.move(way, 1 / 60);
      walk.controls.heading = 2 * Math.PI * random();
      walk.controls.pitch = 0.6 * random() - 0.3;
      walk.frame(performance.now());
    },
  };
}

/** Compares pictures at `count` places of the walk. most_wrong: share of the pixels of one. Gives a line for people. */
export async function pictures_are_the_same(page, { count, most_wrong, folder }) {
  const cells = new Set();
  const sums = { wrong: 0, pixels: 0, on: 0, off: 0, calls_on: 0, calls_off: 0 };
  let worst = 0, rich = 0;
  for (let i = 0; i < count; ++i) {
    await page.evaluate(() => globalThis.tools.stroll());
    await page.waitForFunction(() => !globalThis.walk.draw().pending);
    const found = await page.evaluate(() => globalThis.tools.compare());
    require(!found.drawAll && found.cell >= 0, `viewpoint ${i} is in no cell`);
    const wrong = found.wrong[0] + found.wrong[1];
    if (wrong > most_wrong * found.pixels && folder !== undefined) {
      mkdirSync(folder, { recursive: true });
      writeFileSync(join(folder, `viewpoint_${i}.png`), await page.screenshot());
    }
    require(wrong <= most_wrong * found.pixels, `viewpoint ${i}: ${wrong} wrong pixels of ${found.pixels}`);
    worst = Math.max(worst, wrong);
    rich += Number(found.shades > 20);
    cells.add(found.cell);
    sums.wrong += wrong;
    sums.pixels += found.pixels;
    sums.on += found.on.triangles;
    sums.off += found.off.triangles;
    sums.calls_on += found.on.calls;
    sums.calls_off += found.off.calls;
  }
  require(rich > count / 2, `${rich} of ${count} pictures have more than 20 colors`);  // others show a wall
  require(cells.size > count / 4, `${count} viewpoints are in ${cells.size} cells`);
  require(sums.on < sums.off, `${sums.on} triangles with the PVS, ${sums.off} without`);
  return `${sums.wrong} of ${sums.pixels} pixels are wrong, at most ${worst} in a picture; ` +
    `triangles ${sums.on} of ${sums.off}, draw calls ${sums.calls_on} of ${sums.calls_off}`;
}

// Nearly all wrong pixels are at walls that are narrower than a pixel: as many as these are long, so that their share is
// larger in a smaller picture.
export const wrong_share_at = (width) => 1e-3 * Math.max(1, 1280 / width);
