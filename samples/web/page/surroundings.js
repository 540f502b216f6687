// Light and sky. The sun casts shadows that are rendered once, because nothing moves.
import { BackSide, Box3, BufferAttribute, Color, DirectionalLight, Fog, HemisphereLight, Matrix4, Mesh,
  MeshBasicMaterial, Sphere, SphereGeometry, Vector3 } from 'three';

const zenith = new Color(0x4f8fd0), horizon = new Color(0xd5e4ee), below = new Color(0xa79c8b);
const toSun = new Vector3(-0.55, 0.62, 0.38).normalize();

function makeSky() {
  const geometry = new SphereGeometry(1, 32, 24);
  const { position } = geometry.attributes;
  const shades = new Float32Array(3 * position.count);
  const shade = new Color();
  for (let i = 0; i < position.count; ++i) {
    const y = position.getY(i);
    const part = Math.min(1, y < 0 ? -6 * y : y) ** 0.6;
    shade.lerpColors(horizon, y < 0 ? below : zenith, part).toArray(shades, 3 * i);
  }
  geometry.setAttribute('color', new BufferAttribute(shades, 3));
  const material = new MeshBasicMaterial({ vertexColors: true, side: BackSide, depthWrite: false, depthTest: false,
    fog: false, toneMapped: false });
  const sky = new Mesh(geometry, material);
  sky.renderOrder = -1;
  sky.frustumCulled = false;
  return sky;
}

function makeSun(box, shadowSize) {
  const sun = new DirectionalLight(0xffe9c9, 3.1);
  const { shadow } = sun;
  const { radius, center } = box.getBoundingSphere(new Sphere());
  sun.target.position.copy(center);
  sun.position.copy(center).addScaledVector(toSun, radius);
  sun.castShadow = true;
  // The shadow map covers the town, seen from the sun, and no more.
  const view = new Matrix4().lookAt(sun.position, center, sun.up).setPosition(sun.position).invert();
  const seen = box.clone().applyMatrix4(view);
  Object.assign(shadow.camera, { left: seen.min.x, right: seen.max.x, bottom: seen.min.y, top: seen.max.y,
    near: -seen.max.z, far: -seen.min.z });
  shadow.mapSize.setScalar(shadowSize);
  shadow.normalBias = 0.06;
  shadow.bias = -0.0005;
  shadow.radius = 2;
  shadow.autoUpdate = false;
  shadow.needsUpdate = true;
  return sun;
}

/** Adds light and sky to a scene. Returns a function that moves the sky with the eye. */
export function addSurroundings(scene, town, shadowSize) {
  const box = new Box3().setFromObject(town);
  const { radius } = box.getBoundingSphere(new Sphere());
  const sun = makeSun(box, shadowSize);
  const sky = makeSky();
  const far = 3 * radius;
  sky.scale.setScalar(far / 2);
  scene.fog = new Fog(horizon, 0.2 * radius, far);
  scene.add(new HemisphereLight(0xcfe2ff, 0x95836c, 1.5), sun, sun.target, sky);
  const skyTriangles = sky.geometry.index.count / 3;
  return { far, follow: (eye) => sky.position.copy(eye), skyTriangles };
}
