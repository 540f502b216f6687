// A button for headsets (WebXR), and walking with their sticks: the left one walks, the right one turns.
import { Vector3 } from 'three';

const turnStep = Math.PI / 6;

export class Headset {
  #renderer;
  #turned = false;

  /** button: shown where the browser has a headset. changed(presenting): called when a session begins or ends. */
  constructor(renderer, button, changed) {
    this.#renderer = renderer;
    const { xr } = renderer;
    xr.enabled = true;
    xr.cameraAutoUpdate = false;  // the frame updates it before it asks for the set of the eyes
    xr.addEventListener('sessionstart', () => changed(true));
    xr.addEventListener('sessionend', () => {
      button.textContent = 'Enter VR';
      changed(false);
    });
    button.addEventListener('click', () => this.#toggle(button));
    navigator.xr?.isSessionSupported('immersive-vr').then((supported) => { button.hidden = !supported; }, () => {});
  }

  async #toggle(button) {
    const { xr } = this.#renderer;
    if (xr.getSession() !== null) {
      await xr.getSession().end();
      return;
    }
    try {
      const session = await navigator.xr.requestSession('immersive-vr', { optionalFeatures: ['local-floor'] });
      await xr.setSession(session);
      button.textContent = 'Leave VR';
    } catch (error) {  // the user did not allow it, or the headset is away
      button.textContent = error.name === 'NotAllowedError' ? 'Not allowed' : 'No headset';
    }
  }

  get presenting() { return this.#renderer.xr.isPresenting; }

  #stick(hand) {
    for (const { handedness, gamepad } of this.#renderer.xr.getSession().inputSources) {
      if (handedness === hand && gamepad?.axes.length >= 4) return [gamepad.axes[2], gamepad.axes[3]];
    }
    return [0, 0];
  }

  /** Walks with the rig that carries the head. camera: the one that three.js moves with the headset. */
  walk(rig, camera, walker, speed, seconds) {
    const { xr } = this.#renderer;
    xr.updateCamera(camera);
    const head = new Vector3().setFromMatrixPosition(xr.getCamera().matrixWorld);
    const [x, y] = this.#stick('left');
    const ahead = new Vector3(0, 0, -1).transformDirection(xr.getCamera().matrixWorld).setY(0).normalize();
    const right = new Vector3(-ahead.z, 0, ahead.x);
    walker.eye.setX(head.x).setZ(head.z);
    walker.move(ahead.multiplyScalar(-y * speed * seconds).addScaledVector(right, x * speed * seconds), seconds);
    rig.position.x += walker.eye.x - head.x;
    rig.position.z += walker.eye.z - head.z;
    this.#turn(rig, head);
  }

  /** Turns around the head, a step for each push of the stick. */
  #turn(rig, head) {
    const [x] = this.#stick('right');
    if (Math.abs(x) < 0.5) this.#turned = false;
    if (Math.abs(x) < 0.7 || this.#turned) return;
    this.#turned = true;
    const angle = -Math.sign(x) * turnStep;
    const arm = rig.position.clone().sub(head).setY(0).applyAxisAngle(rig.up, angle);
    rig.rotation.y += angle;
    rig.position.x = head.x + arm.x;
    rig.position.z = head.z + arm.z;
  }
}
