/** Pointer, wheel, touch and keys on the canvas, turned into what the camera should do. */

import { type CameraRig, type HeldKeys, NO_KEYS } from './camera/rig';

/** Notch of a mouse wheel: the distance changes by an eighth. */
const ZOOM_PER_NOTCH = 1.125;
const PIXELS_PER_NOTCH = 100;
const PIXELS_PER_LINE = 33;

type DragKind = 'orbit' | 'look' | 'pan';

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
  ArrowLeft: ['orbitLeft', 1],
  ArrowRight: ['orbitLeft', -1],
  ArrowUp: ['orbitUp', 1],
  ArrowDown: ['orbitUp', -1],
  Equal: ['zoomIn', 1],
  NumpadAdd: ['zoomIn', 1],
  Minus: ['zoomIn', -1],
  NumpadSubtract: ['zoomIn', -1],
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
  private drag: DragKind = 'orbit';

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly rig: CameraRig,
  ) {
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.up(event));
    canvas.addEventListener('pointercancel', (event) => this.up(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('dblclick', () => this.rig.goHome());
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    window.addEventListener('keydown', (event) => this.key(event, true));
    window.addEventListener('keyup', (event) => this.key(event, false));
    canvas.addEventListener('blur', () => this.release());
    window.addEventListener('blur', () => this.release());
  }

  private down(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (event.button !== 0 || event.shiftKey) this.drag = 'pan';
    else this.drag = this.isFlying() ? 'look' : 'orbit';
    this.canvas.dataset.dragging = this.drag;
  }

  private move(event: PointerEvent): void {
    const last = this.pointers.get(event.pointerId);
    if (last === undefined) return;
    const now = { x: event.clientX, y: event.clientY };
    const height = this.canvas.clientHeight;
    if (this.pointers.size >= 2) this.pinch(event.pointerId, last, now, height);
    else this.dragBy(now.x - last.x, now.y - last.y, height);
    this.pointers.set(event.pointerId, now);
  }

  private dragBy(dx: number, dy: number, height: number): void {
    if (this.drag === 'pan') this.rig.dragPan(dx, dy, height);
    else if (this.drag === 'look') this.rig.dragLook(dx, dy, height);
    else this.rig.dragOrbit(dx, dy, height);
  }

  /** Two fingers: their middle pans, their distance zooms. */
  private pinch(moved: number, last: Point, now: Point, height: number): void {
    const [first, second] = [...this.pointers.keys()];
    const other = this.pointers.get(moved === first ? (second ?? -1) : (first ?? -1));
    if (other === undefined || (moved !== first && moved !== second)) return;
    this.rig.dragPan((now.x - last.x) / 2, (now.y - last.y) / 2, height);
    const before = Math.hypot(last.x - other.x, last.y - other.y);
    const after = Math.hypot(now.x - other.x, now.y - other.y);
    if (before > 1 && after > 1) this.rig.zoomBy(before / after, false);
  }

  private up(event: PointerEvent): void {
    this.pointers.delete(event.pointerId);
    if (this.pointers.size > 0) return;
    delete this.canvas.dataset.dragging;
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? PIXELS_PER_LINE : 1;
    const notches = (event.deltaY * unit) / PIXELS_PER_NOTCH;
    this.rig.zoomBy(ZOOM_PER_NOTCH ** Math.max(-4, Math.min(4, notches)), true);
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

  private isFlying(): boolean {
    const { right, up, forward } = this.rig.keys;
    return right !== 0 || up !== 0 || forward !== 0;
  }

  private release(): void {
    this.codes.clear();
    this.rig.keys = NO_KEYS;
  }
}
