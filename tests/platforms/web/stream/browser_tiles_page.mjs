// Runs in the browser: pictures of 3d-tiles-renderer with the plugin, and of the whole .glb by GLTFLoader.
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

import { camera, differing, lit_scene, look_from, pixels_of, renderer, sleep, until } from "./pictures.mjs";
import { tilesOf } from "./show_tiles.mjs";

// For each pose the cell, the wrong pixels and the tiles that are loaded.
globalThis.compare = async (site, glb, poses) => {
  const scene = lit_scene(),
    whole = lit_scene(),
    out = [];
  whole.add((await new GLTFLoader().loadAsync(glb)).scene);
  const { tiles, plugin } = tilesOf(site);
  scene.add(tiles.group);
  tiles.setCamera(camera);
  tiles.setResolutionFromRenderer(camera, renderer);
  for (const pose of poses) {
    look_from(pose);
    await sleep(120);  // chunks are listed ten times a second
    await until(
      () => plugin.complete,
      () => tiles.update(),
    );
    for (let frame = 0; frame < 5; ++frame) {
      tiles.update();
      await sleep(20);
    }
    const wrong = differing(pixels_of(scene), pixels_of(whole));
    out.push({ cell: plugin.cell, wrong, loaded: tiles.stats.loaded, visible: tiles.visibleTiles.size });
  }
  tiles.dispose();
  return out;
};
globalThis.ready = true;
