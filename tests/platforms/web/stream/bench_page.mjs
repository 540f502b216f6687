// Runs in the browser: how long a site takes until what its first camera sees has arrived.
import { stream } from "sightcell-stream";
import { Scene } from "three";

import { camera, look_from, until } from "./pictures.mjs";

// When 99.9 % of the weight of the cell are in the scene, and all of it with its first images. Nothing is drawn, as by
// `sightcell-stream-client --no-draw`, because software rendering on the cores that decode is not what users have.
// pose: position, and a point in the direction of the view. Seconds are from the request of the front on; bytes are those
// of files that had arrived by then, with headers.
globalThis.measure = async (site, pose) => {
  const scene = new Scene(),
    errors = [];
  look_from(pose);
  performance.setResourceTimingBufferSize(100000);
  const times = {};
  let streamed;
  const note = () => {
    const { progress, complete } = streamed ?? {};  // none before stream() has returned
    if (progress >= 0.999) times.most ??= performance.now();
    if (complete) times.complete ??= performance.now();
  };
  streamed = await stream(site, scene, camera, { onChange: note, onError: ({ message }) => errors.push(message) });
  note();
  await until(() => streamed.complete, () => streamed.update(camera));
  const { href } = new URL(site, location);
  const files = performance.getEntriesByType("resource").filter(({ name }) => name.startsWith(href));
  const { startTime } = files.find(({ name }) => name.endsWith("scene.front"));
  const at = (time) => ({
    seconds: (time - startTime) / 1000,
    bytes: files.reduce((sum, { responseEnd, transferSize }) => sum + (responseEnd <= time ? transferSize : 0), 0),
  });
  return { cell: streamed.cell, errors, most: at(times.most), complete: at(times.complete) };
};
globalThis.ready = true;
