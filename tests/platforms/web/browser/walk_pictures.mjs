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
    /** The picture with the PVS and without: how many pixels of each half differ by more than 8 levels, and how many
     * squares of 2 x 2 pixels do whole. */
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
      const width = gl.drawingBufferWidth, differing = new Uint8Array(all.length / 4);
      let squares = 0;
      for (let i = 0; i < differing.length; ++i) {
        if (!differ(4 * i)) continue;
        ++wrong[i % width < width / 2 ? 0 : 1];
        differing[i] = 1;
        const others = [i - 1, i - width, i - width - 1];
        if (i % width > 0 && others.every((at) => differing[at])) ++squares;
      }
      const shades = new Set();
      for (let at = 0; at < all.length; at += 4) shades.add(all[at] << 16 | all[at + 1] << 8 | all[at + 2]);
      return { cell: frame.cell, drawAll: frame.drawAll, wrong, squares, shades: shades.size, on: drawn, off,
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
    if ((wrong > most_wrong * found.pixels || found.squares > most_squares) && folder !== undefined) {
      mkdirSync(folder, { recursive: true });
      writeFileSync(join(folder, `viewpoint_${i}.png`), await page.screenshot());
    }
    require(wrong <= most_wrong * found.pixels, `viewpoint ${i}: ${wrong} wrong pixels of ${found.pixels}`);
    require(found.squares <= most_squares, `viewpoint ${i}: ${found.squares} squares of 2 x 2 wrong pixels`);
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

// Nearly all wrong pixels are in lines of one pixel, at edges of walls: as many as these are long, so that their share
// is larger in a smaller picture. Rays from the eye meet polygons outside the set in at most a thousandth of the area of
// such a pixel; what is drawn there depends on where the samples of a pixel lie.
export const wrong_share_at = (width) => 1e-3 * Math.max(1, 1280 / width);
// What a set lacks is wider than a line: the town with a bound of 5e-3 in place of 1e-4 has 116 squares in a picture.
export const most_squares = 4;
