// Keys, mouse and touch. Touch: the left half of the picture is a stick to walk with, the right half turns the head.
const turn = 0.0032;  // radians per pixel
const stickRadius = 58;  // pixels
const steepest = 1.45;  // radians up and down

const keys = { KeyW: [0, 1], ArrowUp: [0, 1], KeyS: [0, -1], ArrowDown: [0, -1], KeyA: [-1, 0], ArrowLeft: [-1, 0],
  KeyD: [1, 0], ArrowRight: [1, 0] };

export class Controls {
  heading = 0;  // radians to the left of -Z
  pitch = 0;
  #pressed = new Set();
  #stick = { pointer: null, x: 0, y: 0, x0: 0, y0: 0 };
  #look = { pointer: null, x: 0, y: 0 };  // what turns the head, and where it was last
  #picture;
  #drawnStick;
  #actions;

  /** actions: functions by the code of a key. touched: called when a finger first touches the picture. */
  constructor(picture, drawnStick, actions, touched) {
    this.#picture = picture;
    this.#drawnStick = drawnStick;
    this.#actions = actions;
    addEventListener('keydown', (event) => this.#key(event, true));
    addEventListener('keyup', (event) => this.#key(event, false));
    addEventListener('blur', () => this.#pressed.clear());
    picture.addEventListener('pointerdown', (event) => {
      if (event.pointerType !== 'mouse') touched();
      this.#down(event);
    });
    picture.addEventListener('pointermove', (event) => this.#move(event));
    for (const type of ['pointerup', 'pointercancel']) picture.addEventListener(type, (event) => this.#up(event));
    picture.addEventListener('contextmenu', (event) => event.preventDefault());
    document.addEventListener('pointerlockchange', () => picture.classList.toggle('locked', this.#locked));
  }

  get #locked() { return document.pointerLockElement === this.#picture; }

  #key(event, down) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (down && !event.repeat) this.#actions[event.code]?.();
    if (keys[event.code] === undefined && !event.code.startsWith('Shift')) return;
    if (event.code.startsWith('Arrow')) event.preventDefault();
    if (down) this.#pressed.add(event.code);
    else this.#pressed.delete(event.code);
  }

  #down(event) {
    this.#picture.focus();
    if (event.pointerType === 'mouse') {
      // Without a lock (a page in a frame can forbid it) a drag turns the head, too.
      if (!this.#locked) Promise.resolve(this.#picture.requestPointerLock?.()).catch(() => {});
      this.#beginLook(event);
      return;
    }
    this.#picture.setPointerCapture(event.pointerId);
    if (event.clientX < innerWidth / 2 && this.#stick.pointer === null) {
      Object.assign(this.#stick, { pointer: event.pointerId, x0: event.clientX, y0: event.clientY });
    } else {
      this.#beginLook(event);
    }
  }

  #beginLook({ pointerId, clientX, clientY }) {
    Object.assign(this.#look, { pointer: pointerId, x: clientX, y: clientY });
  }

  #turn(x, y) {
    this.heading -= turn * x;
    this.pitch = Math.min(steepest, Math.max(-steepest, this.pitch - turn * y));
  }

  #move(event) {
    if (event.pointerId === this.#stick.pointer) {
      const x = event.clientX - this.#stick.x0, y = event.clientY - this.#stick.y0;
      const scale = 1 / Math.max(stickRadius, Math.hypot(x, y));
      this.#setStick(x * scale, y * scale);
    } else if (this.#locked) {
      this.#turn(event.movementX, event.movementY);
    } else if (event.pointerId === this.#look.pointer) {
      this.#turn(event.clientX - this.#look.x, event.clientY - this.#look.y);  // of a finger, movementX can be 0
      this.#beginLook(event);
    }
  }

  #up(event) {
    if (event.pointerId === this.#stick.pointer) {
      this.#stick.pointer = null;
      this.#setStick(0, 0);
    }
    if (event.pointerId === this.#look.pointer) this.#look.pointer = null;
  }

  #setStick(x, y) {
    Object.assign(this.#stick, { x, y });
    this.#drawnStick.style.transform = `translate(${0.6 * stickRadius * x}px, ${0.6 * stickRadius * y}px)`;
  }

  get running() { return this.#pressed.has('ShiftLeft') || this.#pressed.has('ShiftRight'); }

  /** How far to the right and forward the person wants to go: at most 1 together. */
  get wish() {
    let { x, y } = this.#stick;
    y = -y;
    for (const code of this.#pressed) {
      x += keys[code]?.[0] ?? 0;
      y += keys[code]?.[1] ?? 0;
    }
    const length = Math.max(1, Math.hypot(x, y));
    return [x / length, y / length];
  }
}
