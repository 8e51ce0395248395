/** Pointer, wheel, touch and keys on the canvas, turned into what the camera should do. */

import { aimAt, type Place, placeInPicture } from './camera/aim';
import { type CameraRig, type HeldKeys, NO_KEYS } from './camera/rig';
import type { Vec3 } from './camera/vec';
import { Taps } from './taps';

const PIXELS_PER_NOTCH = 100;
const PIXELS_PER_LINE = 33;

type DragKind = 'turn' | 'pan';

interface Point {
  x: number;
  y: number;
}

const AXES: Record<string, [keyof Omit<HeldKeys, 'fast'>, number]> = {
  KeyW: ['forward', 1],
  KeyS: ['forward', -1],
  KeyD: ['right', 1],
  KeyA: ['right', -1],
  KeyE: ['up', 1],
  KeyQ: ['up', -1],
  ArrowLeft: ['turnLeft', 1],
  ArrowRight: ['turnLeft', -1],
  ArrowUp: ['turnUp', 1],
  ArrowDown: ['turnUp', -1],
  Equal: ['nearer', 1],
  NumpadAdd: ['nearer', 1],
  Minus: ['nearer', -1],
  NumpadSubtract: ['nearer', -1],
};

/** The sum of all held keys; opposite keys cancel. */
export function heldKeys(codes: ReadonlySet<string>, fast: boolean): HeldKeys {
  const keys: HeldKeys = { ...NO_KEYS, fast };
  for (const code of codes) {
    const axis = AXES[code];
    if (axis !== undefined) keys[axis[0]] += axis[1];
  }
  return keys;
}

export class CameraInput {
  private readonly pointers = new Map<number, Point>();
  private readonly codes = new Set<string>();
  private readonly taps = new Taps();
  private kind: DragKind = 'turn';

  /** `onDoubleTap` gets the place of the picture that was tapped twice. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly rig: CameraRig,
    private readonly onDoubleTap: (place: Place) => void,
  ) {
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.up(event));
    canvas.addEventListener('pointercancel', (event) => this.cancel(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    window.addEventListener('keydown', (event) => this.key(event, true));
    window.addEventListener('keyup', (event) => this.key(event, false));
    canvas.addEventListener('blur', () => this.release());
    window.addEventListener('blur', () => this.release());
  }

  private down(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.kind = event.button !== 0 || event.shiftKey ? 'pan' : 'turn';
    this.canvas.dataset.dragging = this.kind;
    if (this.pointers.size > 1 || this.kind === 'pan') this.taps.spoil();
    else this.taps.down(event.clientX, event.clientY, event.timeStamp);
  }

  private move(event: PointerEvent): void {
    const last = this.pointers.get(event.pointerId);
    if (last === undefined) return;
    const now = { x: event.clientX, y: event.clientY };
    const height = this.canvas.clientHeight;
    if (this.pointers.size >= 2) this.pinch(event.pointerId, last, now, height);
    else if (this.kind === 'pan') this.rig.dragPan(now.x - last.x, now.y - last.y, height);
    else this.rig.drag(now.x - last.x, now.y - last.y, height);
    this.pointers.set(event.pointerId, now);
  }

  /** Two fingers: their middle pans, their distance brings nearer. */
  private pinch(moved: number, last: Point, now: Point, height: number): void {
    const [first, second] = [...this.pointers.keys()];
    const other = this.pointers.get(moved === first ? (second ?? -1) : (first ?? -1));
    if (other === undefined || (moved !== first && moved !== second)) return;
    this.rig.dragPan((now.x - last.x) / 2, (now.y - last.y) / 2, height);
    const before = Math.hypot(last.x - other.x, last.y - other.y);
    const after = Math.hypot(now.x - other.x, now.y - other.y);
    const middle = { x: (now.x + other.x) / 2, y: (now.y + other.y) / 2 };
    if (before > 1 && after > 1) this.rig.pinch(after / before, this.aim(middle));
  }

  private up(event: PointerEvent): void {
    const { clientX: x, clientY: y } = event;
    const single = this.pointers.size === 1;
    this.pointers.delete(event.pointerId);
    if (this.pointers.size > 0) return;
    delete this.canvas.dataset.dragging;
    if (single && this.taps.up(x, y, event.timeStamp)) this.onDoubleTap(this.place({ x, y }));
  }

  private cancel(event: PointerEvent): void {
    this.taps.spoil();
    this.pointers.delete(event.pointerId);
    if (this.pointers.size === 0) delete this.canvas.dataset.dragging;
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.taps.spoil();
    const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? PIXELS_PER_LINE : 1;
    const notches = (event.deltaY * unit) / PIXELS_PER_NOTCH;
    const aim = this.aim({ x: event.clientX, y: event.clientY });
    this.rig.wheel(-Math.max(-4, Math.min(4, notches)), aim);
  }

  private place(point: Point): Place {
    return placeInPicture(point, this.canvas.getBoundingClientRect(), this.canvas);
  }

  /** The direction in the world that is seen at a point of the window. */
  private aim(point: Point): Vec3 {
    const aspect = this.canvas.width / Math.max(1, this.canvas.height);
    return aimAt(this.rig.current, aspect, this.place(point));
  }

  private key(event: KeyboardEvent, pressed: boolean): void {
    // The browser's own shortcuts stay the browser's.
    if (pressed && (event.ctrlKey || event.metaKey || event.altKey)) return;
    // Keys belong to whatever has the focus: the picture, or the page when nothing has it.
    if (pressed && event.target !== this.canvas && event.target !== document.body) return;
    if (event.code in AXES) {
      if (pressed) {
        this.codes.add(event.code);
        event.preventDefault();
      } else {
        this.codes.delete(event.code);
      }
    }
    this.rig.keys = heldKeys(this.codes, event.shiftKey);
  }

  private release(): void {
    this.codes.clear();
    this.rig.keys = NO_KEYS;
  }
}
