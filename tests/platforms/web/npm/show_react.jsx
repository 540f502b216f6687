// What docs/hosting.md shows of React Three Fiber. react_test.mjs runs it.

/* [react */
import { useFrame } from '@react-three/fiber';
import { useEffect, useRef } from 'react';
import { attach } from 'sightcell/three';

export function Culled({ gltf, db }) {  // gltf: of useGLTF or useLoader; db: of sightcell.openUrl
  const pvs = useRef(null);
  useEffect(() => {
    let wanted = true;
    queueMicrotask(async () => {  // StrictMode has unmounted the first one by then
      if (wanted) pvs.current = await attach(gltf, db, { mode: 'ranges' });
    });
    return () => { wanted = false; pvs.current?.dispose(); pvs.current = null; };
  }, [gltf, db]);
  useFrame(({ camera }) => { pvs.current?.update(camera); });
  return <primitive object={gltf.scene} />;
}
/* react] */
