// Uses every declaration of stream.d.ts and tiles.d.ts. package_test.mjs compiles it, beside a few lines in place of
// the types of three.js.
import { stream, StreamError } from 'sightcell-stream';
import type { Stream, StreamedDraw, StreamErrorId, StreamOptions } from 'sightcell-stream';
import { CellTilesPlugin } from 'sightcell-stream/tiles';
import type { CellTile, CellTilesOptions } from 'sightcell-stream/tiles';
import type { Camera, Group, Matrix4, Mesh, Object3D } from 'three';

declare const scene: Object3D;
declare const camera: Camera;
declare const matrix: Matrix4;

const ids: StreamErrorId[] = [];
const options: StreamOptions = {
  requests: 6, memory: 2 ** 28, lookahead: 0, workers: 0, init: { credentials: 'include' },
  onError: (error: StreamError) => { ids.push(error.id); console.log(error.url, error.message, error.cause); },
  onChange: () => {},
  onMesh: (mesh: Mesh) => { mesh.name = 'streamed'; },
};
const streamed: Stream = await stream(new URL('https://host/site/'), scene, camera, options);
await stream('site/', scene, camera);
const nothing: void = streamed.update(camera);
const group: Group = streamed.group;
const draws: readonly StreamedDraw[] = streamed.draws;
const moving = draws.findIndex((draw) => draw.flags & 1 && draw.node + draw.mesh + draw.primitive + draw.instance > 0);
const at: Matrix4 | undefined = draws[moving]?.matrix;
streamed.moveDraw(moving, at ?? matrix);
const numbers: number[] = [streamed.cell, streamed.progress, streamed.weight, streamed.failed, streamed.memoryBytes,
  streamed.clearDistance];
const facts: boolean[] = [streamed.outside, streamed.complete];
streamed.dispose();
const made: Error = new StreamError('io', 'https://host/site/scene.front', 'a test', { cause: numbers });

const tile: CellTile = { extras: { sightcell: { page: 3 } }, children: [] };
const of_tiles: CellTilesOptions = { onError: ({ id }: StreamError) => ids.push(id) };
const plugin = new CellTilesPlugin('site/', of_tiles);
plugin.init({});
const target = { inView: true, error: 0 };
facts.push(plugin.visible(tile), plugin.complete, plugin.calculateTileViewError(tile, target));
numbers.push(plugin.priority(tile), plugin.cell, plugin.name.length, tile.children?.length ?? 0);
plugin.dispose();

// @ts-expect-error There is no such id.
const wrong: StreamErrorId = 'late';
// @ts-expect-error A camera is required.
await stream('site/', scene);

export { facts, group, made, nothing, wrong };
