// Uses every declaration of three.d.ts and three_overlay.d.ts. types_test.mjs compiles it, beside a few lines in place of the types of three.js.
import { attach, embeddedPvs } from 'sightcell/three';
import type { Attachment, AttachOptions, LoadedScene } from 'sightcell/three';
import { DebugOverlay } from 'sightcell/three/overlay';
import { DebugLines } from 'sightcell';
import type { Database, Frame, View } from 'sightcell';
import type { Camera, LineSegments, Mesh, Object3D } from 'three';

declare const db: Database;
declare const camera: Camera;
declare const gltf: { scene: Object3D; scenes: Object3D[]; parser: { json: any; associations: Map<Object3D, number> } };

const loaded: LoadedScene = gltf;
const clone: LoadedScene = { scene: gltf.scene, parser: loaded.parser.json };
const options: AttachOptions = { mode: 'ranges', warn: (text: string) => console.log(text.length),
  skip: (mesh: Mesh, draw) => mesh.name === 'door' || draw.node === 3 };
const inside: ArrayBuffer | null = await embeddedPvs(gltf);
const pvs: Attachment = await attach(gltf, db, options);
await attach(clone, db, { mode: 'packed' });
const frame: Frame = pvs.update(camera);
const view: View = pvs.view;
const batches: Mesh[] = pvs.batches;
const overlay = new DebugOverlay(pvs, gltf.scene, { kinds: DebugLines.volumes });
overlay.kinds = overlay.kinds | DebugLines.outsideRegion;
overlay.visible = !overlay.visible;
overlay.frozen = overlay.visible;
const seen: [Frame, LineSegments] = [overlay.update(camera), overlay.lines];
overlay.dispose();
pvs.dispose();

// @ts-expect-error There is no such mode.
await attach(gltf, db, { mode: 'triangles' });
// @ts-expect-error A frame is no camera.
pvs.update(frame);

export { batches, loaded, seen, view };
