// Runs in the browser: pictures of the streamed scene, and of the whole .glb by GLTFLoader.
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { stream } from "sightcell-stream";

import { camera, differing, lit_scene, look_from, pixels_of, renderer, sleep, until } from "./pictures.mjs";
import { showSite } from "./show.mjs";

// For each pose the cell, the wrong pixels and the draw calls of both. shown: pictures for a person.
globalThis.compare = async (site, glb, poses, files) => {
  const scene = lit_scene(),
    whole = lit_scene(),
    errors = [];
  const { scene: original } = await new GLTFLoader().loadAsync(glb);
  whole.add(original);
  let streamed;
  const out = { poses: [], shown: [], errors };
  // The largest images come after the cell is complete.
  const urls = files.map((name) => new URL(name, new URL(site, location)));
  const has_largest = () => urls.every((url) => performance.getEntriesByName(url).length > 0);
  for (const pose of poses) {
    look_from(pose);
    streamed ??= await stream(site, scene, camera, { onError: (error) => errors.push(error.message) });
    streamed.update(camera);
    await until(() => streamed.complete && has_largest());
    await sleep(200);
    const found = pixels_of(scene),
      { calls } = renderer.info.render;
    out.shown.push(renderer.domElement.toDataURL());
    const wrong = differing(found, pixels_of(whole));
    out.poses.push({ cell: streamed.cell, wrong, calls, whole_calls: renderer.info.render.calls });
  }
  // A group that is moved is drawn where it is.
  for (const { position } of [streamed.group, original, camera]) position.x += 0.5;
  out.moved = differing(pixels_of(scene), pixels_of(whole));
  streamed.dispose();
  out.memory = { ...renderer.info.memory };
  return out;
};

// What is left on the device after a site is opened and disposed again and again.
globalThis.open_and_dispose = async (site, times) => {
  const memory = [];
  for (let i = 0; i < times; ++i) {
    const scene = lit_scene();
    const streamed = await showSite(site, renderer, scene, camera);
    await until(() => streamed.complete);
    renderer.render(scene, camera);
    renderer.setAnimationLoop(null);
    streamed.dispose();
    memory.push(`${renderer.info.memory.geometries} ${renderer.info.memory.textures}`);
  }
  return memory;
};
globalThis.ready = true;
