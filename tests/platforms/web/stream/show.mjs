// What docs/streaming.md and the README.md of the package show: check_readme.py and stream_test.mjs hold the texts
// against what is between the markers. stream_test.mjs and browser_test.mjs run it.

/* [stream */
import { stream } from 'sightcell-stream';

export async function showSite(url, renderer, scene, camera) {  // url: the folder that pack --stream has written
  const streamed = await stream(url, scene, camera);
  renderer.setAnimationLoop(() => {
    streamed.update(camera);
    renderer.render(scene, camera);
  });
  return streamed;
}
/* stream] */
