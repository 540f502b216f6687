// What docs/streaming.md shows of 3d-tiles-renderer. browser_tiles_page.mjs runs it.

/* [tiles */
import { TilesRenderer } from '3d-tiles-renderer/three';
import { GLTFExtensionsPlugin } from '3d-tiles-renderer/three/plugins';
import { CellTilesPlugin } from 'sightcell-stream/tiles';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';

export function tilesOf(site) {  // the folder of the site, with a slash at its end
  const tiles = new TilesRenderer(`${site}tileset.json`);
  const plugin = new CellTilesPlugin(site);
  tiles.registerPlugin(new GLTFExtensionsPlugin({ meshoptDecoder: MeshoptDecoder }));
  tiles.registerPlugin(plugin);
  tiles.group.rotation.x = -Math.PI / 2;  // from Z up to the axes of the scene
  return { tiles, plugin };
}
/* tiles] */
