// The sample's page in Chromium: with and without the PVS it draws the same pictures, also for both eyes of an emulated
// headset; nothing grows while files are opened and disposed; the browser has nothing to warn of.
// usage: walk_test.mjs SITE NODE_MODULES VIEWPOINTS WIDTH [FOLDER]    SITE: of samples/web/make_site.py
//   WIDTH: of the pictures; their height is 9/16 of it
//   FOLDER: receives a picture of each viewpoint with more wrong pixels than allowed
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { require } from "../host.mjs";
import { open_page, with_chromium } from "./chromium.mjs";
import { serve } from "./static_server.mjs";
import { most_squares, pictures_are_the_same, tools, wrong_share_at } from "./walk_pictures.mjs";

const [site, modules, viewpoints, width, folder] = process.argv.slice(2);
const size = { width: Number(width), height: Number(width) * 9 / 16 };
const most_wrong = wrong_share_at(size.width);
const cycles = 100;

// The page with an emulated headset, paused.
async function open_walk(browser, url) {
  const emulation = readFileSync(join(modules, "iwer", "build", "iwer.min.js"), "utf8");
  const content = `${emulation};
    globalThis.headset = new IWER.XRDevice(IWER.metaQuest3);
    globalThis.headset.stereoEnabled = true;
    globalThis.headset.installRuntime({ forceInstall: true });`;
  const opened = await open_page(browser, url, { viewport: size }, (page) => page.addInitScript({ content }));
  await opened.page.waitForFunction(() => globalThis.walk ?? document.querySelector("#loading.failed"));
  opened.no_problems();
  await opened.page.evaluate(() => globalThis.walk.pause());
  await opened.page.evaluate(tools);
  return opened;
}

// An emulated headset: its eyes are on the left and on the right half of the picture.
async function both_eyes_are_the_same(page) {
  await page.evaluate(() => globalThis.tools.back_to_start());
  await page.evaluate(() => globalThis.walk.run());
  await page.click("#headset");
  await page.waitForFunction(() => globalThis.walk.headset.presenting);
  const found = await page.evaluate(() => new Promise((done, failed) => {
    const { walk, tools: { compare }, headset } = globalThis;
    const { frame } = walk;
    const results = [];
    headset.position.set(0.1, 1.6, 0.2);
    let count = 0;
    walk.frame = (time) => {
      try {
        frame.call(walk, time);
        headset.quaternion.set(0, Math.sin(0.4 * count), 0, Math.cos(0.4 * count));
        if (++count > 2 && !walk.pvs.view.frame.pending) {
          const eyes = walk.renderer.xr.getCamera().cameras.map(({ viewport }) => [viewport.x, viewport.z]);
          results.push({ ...compare(), eyes });
        }
        if (results.length === 4) done(results);
      } catch (error) {
        failed(error);
      }
    };
  }));
  for (const each of found) {
    const half = size.width / 2;
    require(JSON.stringify(each.eyes) === JSON.stringify([[0, half], [half, half]]), `eyes at ${each.eyes}`);
    require(!each.drawAll && each.cell >= 0, JSON.stringify(each));
    for (const wrong of each.wrong) require(wrong <= most_wrong * each.pixels / 2, JSON.stringify(each));
    require(each.squares <= most_squares, JSON.stringify(each));
  }
  require(found.some(({ shades }) => shades > 20), "both eyes show walls");
  // The left stick walks.
  const moved = await page.evaluate(async () => {
    const { walk, headset } = globalThis;
    delete walk.frame;
    const before = walk.rig.position.clone();
    headset.controllers.left.updateAxes("thumbstick", 0, -1);
    for (let i = 0; i < 30 && before.distanceTo(walk.rig.position) < 0.05; ++i) {
      await new Promise((later) => setTimeout(later, 50));
    }
    return before.distanceTo(walk.rig.position);
  });
  require(moved > 0.05, `the stick moved the person by ${moved} m`);
  await page.evaluate(() => globalThis.walk.renderer.xr.getSession().end());
  await page.evaluate(() => globalThis.walk.pause());
  return `eyes: ${found.map(({ wrong }) => wrong.join(" and ")).join(", ")} wrong pixels of ${found[0].pixels / 2}`;
}

// Files, views and batches that are disposed leave nothing behind, in the module, in JavaScript and in three.js.
async function nothing_grows(page) {
  const devtools = await page.context().newCDPSession(page);
  const run = async (times) => {
    const found = await page.evaluate(async (count) => {
      const { walk } = globalThis;
      const { Sightcell } = await import("sightcell");
      const { attach } = await import("sightcell/three");
      walk.pvs.dispose();
      globalThis.module ??= await Sightcell.load();
      globalThis.refs = [];
      for (let i = 0; i < count; ++i) {
        const db = await globalThis.module.openUrl(walk.site.sets, { firstBytes: 4096 });
        const pvs = await attach({ scene: walk.town, parser: walk.parser }, db, { mode: "ranges" });
        const wait = () => new Promise((later) => setTimeout(later, 1));
        for (let moves = 0; moves < 1000 && pvs.update(walk.camera).pending; ++moves) await wait();
        if (pvs.view.frame.drawAll) throw new Error("the set has not arrived");
        globalThis.refs.push(...[db, pvs, pvs.view, ...pvs.batches].map((object) => new WeakRef(object)));
        if (i === 0) walk.renderer.render(walk.scene, walk.camera);
        pvs.dispose();
        db.dispose();
      }
      walk.renderer.render(walk.scene, walk.camera);
      return { module: globalThis.module.memoryBytes, ...walk.renderer.info.memory,
        children: walk.town.children.length };
    }, times);
    await devtools.send("HeapProfiler.collectGarbage");
    const { made, kept } = await page.evaluate(() => ({ made: globalThis.refs.length,
      kept: globalThis.refs.filter((ref) => ref.deref() !== undefined).length }));
    require(made > 5 * times && kept <= 10, `${kept} of ${made} objects are left`);  // of the last cycle
    return found;
  };
  const first = await run(3);
  const last = await run(cycles);
  require(JSON.stringify(first) === JSON.stringify(last), `${JSON.stringify(first)}, then ${JSON.stringify(last)}`);
  return `after ${cycles} cycles as before: ${JSON.stringify(last)}`;
}

// What the switches and keys do.
async function the_panel_works(page) {
  await page.waitForFunction(() => !globalThis.walk.draw().pending);
  const calls = () => page.evaluate(() => {
    globalThis.walk.draw();
    return globalThis.walk.drawn.calls;
  });
  const on = await calls();
  await page.click(".switch");
  require(on < await calls(), "the switch changes nothing");
  await page.keyboard.press("p");
  require(on === await calls(), "the key changes nothing");
  await page.click("#freeze");
  const cell = await page.evaluate(() => {
    const { walk } = globalThis;
    walk.frame(1);
    const before = walk.pvs.view.frame.cell;
    walk.walker.eye.y += 100;
    walk.frame(2);
    return [before, walk.pvs.view.frame.cell, walk.overlay.lines.visible];
  });
  require(cell[0] === cell[1] && cell[2], `a frozen set: ${cell}`);
  await page.keyboard.press("f");
  const eye = await page.evaluate(() => {
    globalThis.walk.frame(3);
    return [globalThis.walk.walker.eye.y, globalThis.walk.overlay.lines.visible];
  });
  require(eye[0] < 50 && !eye[1], `after a frozen set: ${eye}`);
  // A key walks, and a wall ends the walk.
  const walked = await page.evaluate(() => {
    const { walk } = globalThis;
    const key = (type) => dispatchEvent(new KeyboardEvent(type, { code: "KeyW" }));
    const before = walk.walker.eye.clone();
    key("keydown");
    for (let i = 0; i < 2000; ++i) walk.walker.move(before.clone().set(0, 0, -walk.controls.wish[1] * 0.05), 1 / 60);
    key("keyup");
    const { eye } = walk.walker;
    return [before.distanceTo(eye), walk.walker.isClear(eye, walk.db.info.playerRadius), walk.controls.wish[1]];
  });
  require(walked[0] > 1 && walked[0] < 100 && walked[1] && walked[2] === 0, `a walk: ${walked}`);
}

// A finger on the left half walks, one on the right half looks.
async function fingers_work(page) {
  const devtools = await page.context().newCDPSession(page);
  await devtools.send("Emulation.setTouchEmulationEnabled", { enabled: true });
  const touch = (type, ...points) => devtools.send("Input.dispatchTouchEvent", { type,
    touchPoints: points.map(([x, y, id]) => ({ x: x * size.width, y: y * size.height, id })) });
  // Chromium passes moves on with the next picture.
  const wait_for = async (done, what, given) => page.waitForFunction(done, given, { timeout: 20000 }).catch((error) => {
    throw new Error(`${what}: ${error.message}`);
  });
  const heading = await page.evaluate(() => globalThis.walk.controls.heading);
  await touch("touchStart", [0.2, 0.9, 1]);
  await touch("touchMove", [0.2, 0.5, 1]);
  await wait_for(() => globalThis.walk.controls.wish[1] > 0.9 && !document.getElementById("stick").hidden,
    "the left finger");
  await touch("touchStart", [0.2, 0.5, 1], [0.9, 0.5, 2]);
  await touch("touchMove", [0.2, 0.5, 1], [0.8, 0.5, 2]);
  await wait_for((before) => globalThis.walk.controls.heading > before + 0.05, "the right finger", heading);
  require(await page.evaluate(() => globalThis.walk.controls.wish[1] > 0.9), "the left finger beside the right one");
  await touch("touchEnd");
  await wait_for(() => globalThis.walk.controls.wish.every((part) => Math.abs(part) === 0), "no finger");
  await devtools.send("Emulation.setTouchEmulationEnabled", { enabled: false });
}

// Pages of a file arrive from another origin where that lets the page read Content-Range, else the whole file arrives. A
// browser asks for ranges without a request in advance.
async function other_origins_are_read(page) {
  const everyone = { "Access-Control-Allow-Origin": "*" };
  const readable = { ...everyone, "Access-Control-Expose-Headers": "Content-Range" };
  for (const [paged, headers] of [[false, everyone], [true, readable]]) {
    const other = await serve(site, headers);
    try {
      const found = await page.evaluate(async (base) => {
        const { Sightcell } = await import("sightcell");
        const sightcell = await Sightcell.load();
        const db = await sightcell.openUrl(base + globalThis.walk.site.sets, { firstBytes: 4096 });
        const result = db.paged;
        sightcell.dispose();
        return result;
      }, other.url);
      require(found === paged, `a file of another origin ${found ? "has" : "lacks"} pages`);
      require(other.asked.every(({ method }) => method === "GET"), "a request in advance");
      require(other.asked[0].status === 206, "a range");
    } finally {
      other.close();
    }
  }
}

const server = await serve(site);
try {
  const results = await with_chromium(modules, async (browser) => {
    const { page, no_problems } = await open_walk(browser, server.url);
    const texts = [await pictures_are_the_same(page, { count: Number(viewpoints), most_wrong, folder })];
    no_problems();
    await the_panel_works(page);
    await fingers_work(page);
    await other_origins_are_read(page);
    texts.push(await both_eyes_are_the_same(page));
    no_problems();
    texts.push(await nothing_grows(page));  // ends the walk
    no_problems();
    return texts;
  });
  const missing = server.asked.filter(({ status }) => status === 404);
  require(missing.length === 0, `not in the site: ${missing.map(({ path }) => path)}`);
  console.log(results.join("\n"));
} finally {
  server.close();
}
