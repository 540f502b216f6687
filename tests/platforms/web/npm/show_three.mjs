// What docs/hosting.md and the README.md of the package show of three.js, as in show.mjs. three_test.mjs runs it.

/* [three */
import { Sightcell } from 'sightcell';
import { attach } from 'sightcell/three';

export async function cullScene(gltf, url) {  // gltf: of GLTFLoader
  const sightcell = await Sightcell.load();
  const pvs = await attach(gltf, await sightcell.openUrl(url), { mode: 'ranges' });
  return (camera) => pvs.update(camera);  // in each frame, before renderer.render
}
/* three] */
