import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { Access } from '../src/access';
import { backoffMillis } from '../src/backoff';
import { Connection } from '../src/connection';
import { Outbox } from '../src/outbox';
import type { CameraPose, ClientMessage, SceneEdit } from '../src/protocol.gen';
import { Restore } from '../src/restore';
import { keep, takeKept } from '../src/resume';

const pose = (x: number): CameraPose => ({
  position: [x, 0, 0],
  target: [0, 0, 0],
  up: [0, 1, 0],
  vertical_fov_degrees: 50,
});

function drain(outbox: Outbox): ClientMessage[] {
  const sent: ClientMessage[] = [];
  outbox.flush((message) => sent.push(message) > 0);
  return sent;
}

describe('backoff', () => {
  it('doubles from a quarter of a second to eight seconds', () => {
    const longest = [0, 1, 2, 3, 4, 5, 6, 99].map((attempt) => backoffMillis(attempt, () => 1));
    expect(longest).toEqual([250, 500, 1000, 2000, 4000, 8000, 8000, 8000]);
  });

  it('spreads clients over the second half', () => {
    expect(backoffMillis(2, () => 0)).toBe(500);
    expect(backoffMillis(2, () => 0.5)).toBe(750);
  });
});

describe('connection', () => {
  /** A socket that a test opens, lets speak, and closes. */
  class FakeSocket {
    static readonly OPEN = 1;
    static all: FakeSocket[] = [];
    readyState = 0;
    onopen: (() => void) | null = null;
    onclose: (() => void) | null = null;
    onmessage: ((event: { data: string }) => void) | null = null;

    constructor() {
      FakeSocket.all.push(this);
    }

    send(): void {}
    close(): void {}

    welcome(): void {
      this.onmessage?.({ data: '{"type":"welcome"}' });
    }
  }

  const back: (() => void)[] = [];

  beforeEach(() => {
    vi.useFakeTimers();
    FakeSocket.all = [];
    back.length = 0;
    vi.stubGlobal('WebSocket', FakeSocket);
    vi.stubGlobal('window', { addEventListener: () => {} });
    const addEventListener = (_: string, listener: () => void) => back.push(listener);
    vi.stubGlobal('document', { hidden: false, addEventListener });
  });

  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  /** Answers the questions one after the other, the last one for ever. */
  function connection(answers: Access[]) {
    let asked = 0;
    const made = new Connection('ws://test/', {
      onOpen: () => ({ type: 'ack', frame: 0 }),
      onMessage: () => {},
      onPicture: () => {},
      onBroken: () => {},
      mayConnect: async () => {
        asked += 1;
        return answers[Math.min(asked, answers.length) - 1] ?? 'admitted';
      },
    });
    return { made, asked: () => asked };
  }

  it('opens no socket to a server that refuses the page, and asks once', async () => {
    const { made, asked } = connection(['refused', 'admitted']);
    made.open();
    await vi.advanceTimersByTimeAsync(600_000);
    expect(made.state.value).toBe('refused');
    expect([asked(), FakeSocket.all.length]).toEqual([1, 0]);
    // Somebody comes back to the page.
    for (const listener of back) listener();
    await vi.advanceTimersByTimeAsync(0);
    expect([asked(), FakeSocket.all.length]).toEqual([2, 1]);
  });

  it('goes on by itself where a refusal may end, or nobody answers', async () => {
    const { made, asked } = connection(['unreachable', 'later', 'admitted']);
    made.open();
    await vi.advanceTimersByTimeAsync(5_000);
    expect(asked()).toBe(3);
    FakeSocket.all[0]?.welcome();
    expect(made.state.value).toBe('connected');
  });

  it('comes back without a question where it was welcome, and asks where it was not', async () => {
    const { made, asked } = connection(['admitted']);
    made.open();
    await vi.advanceTimersByTimeAsync(0);
    FakeSocket.all[0]?.welcome();
    FakeSocket.all[0]?.onclose?.();
    await vi.advanceTimersByTimeAsync(1000);
    expect([asked(), FakeSocket.all.length]).toEqual([1, 2]);
    FakeSocket.all[1]?.onclose?.();
    await vi.advanceTimersByTimeAsync(1000);
    expect([asked(), FakeSocket.all.length]).toEqual([2, 3]);
  });
});

describe('outbox', () => {
  it('sends the newest camera once, with a growing number', () => {
    const outbox = new Outbox();
    for (const x of [1, 2, 3]) outbox.setCamera(pose(x));
    expect(drain(outbox)).toEqual([{ type: 'camera', input: 1, camera: pose(3) }]);
    expect(drain(outbox)).toEqual([]);
    outbox.setCamera(pose(4));
    expect(drain(outbox)).toEqual([{ type: 'camera', input: 2, camera: pose(4) }]);
  });

  it('says that surfaces stop a camera, unless part of the way leads through them', () => {
    const outbox = new Outbox();
    outbox.setCamera(pose(1), true);
    const stopping = { type: 'camera', input: 1, camera: pose(1), stops_at_surfaces: true };
    expect(drain(outbox)).toEqual([stopping]);
    outbox.setCamera(pose(2), false);
    outbox.setCamera(pose(3), true);
    expect(drain(outbox)).toEqual([{ type: 'camera', input: 2, camera: pose(3) }]);
    outbox.setCamera(pose(4), true);
    outbox.dropCamera();
    expect(drain(outbox)).toEqual([]);
  });

  it('merges edits by part', () => {
    const outbox = new Outbox(41);
    outbox.addEdit({ exposure_ev: 1, lights: [] });
    outbox.addEdit({ exposure_ev: 2 });
    expect(drain(outbox)).toEqual([
      { type: 'edit', input: 42, edit: { exposure_ev: 2, lights: [] } },
    ]);
  });

  it('sends nothing of the old scene once a preset is being opened', () => {
    const outbox = new Outbox();
    outbox.setCamera(pose(1));
    outbox.addEdit({ exposure_ev: 1 });
    outbox.openPreset('cornell');
    outbox.setSize({ width: 640, height: 360 });
    expect(drain(outbox)).toEqual([
      { type: 'resize', input: 1, width: 640, height: 360 },
      { type: 'open_preset', input: 2, name: 'cornell' },
    ]);
    outbox.setCamera(pose(2));
    outbox.setSize({ width: 320, height: 180 });
    expect(drain(outbox).map(({ type }) => type)).toEqual(['resize']);
    outbox.sceneOpened();
    expect(drain(outbox)).toEqual([]);
    outbox.setCamera(pose(3));
    expect(drain(outbox)).toEqual([{ type: 'camera', input: 4, camera: pose(3) }]);
  });

  it('goes on with the old scene when the preset is refused', () => {
    const outbox = new Outbox();
    outbox.openPreset('nowhere');
    drain(outbox);
    outbox.setCamera(pose(1));
    outbox.refused(99);
    expect(drain(outbox)).toEqual([]);
    outbox.refused(1);
    expect(drain(outbox)).toEqual([{ type: 'camera', input: 2, camera: pose(1) }]);
  });

  it('keeps what could not be sent, and its number', () => {
    const outbox = new Outbox();
    outbox.addEdit({ exposure_ev: 1 });
    outbox.setCamera(pose(1));
    outbox.flush(() => false);
    expect(drain(outbox).map(({ type }) => type)).toEqual(['edit', 'camera']);
    expect(outbox.newestInput).toBe(2);
  });
});

describe('restore', () => {
  const edit: SceneEdit = { exposure_ev: 1.5 };

  it('does nothing on a first connection', () => {
    expect(new Restore().onScene('hall', 'hall')).toBeNull();
  });

  it('brings the state back when the server shows the same scene', () => {
    const restore = new Restore();
    restore.begin('hall', edit);
    expect(restore.onScene('hall', 'hall')).toEqual({ edit });
    expect(restore.onScene('hall', 'hall')).toBeNull();
  });

  it('opens the preset first when the server shows another scene', () => {
    const restore = new Restore();
    restore.begin('street', edit);
    expect(restore.onScene('hall', 'street')).toEqual({ open: 'street' });
    expect(restore.onScene('street', 'street')).toEqual({ edit });
  });

  it('gives up on a scene that cannot be opened', () => {
    const restore = new Restore();
    restore.begin('own file', edit);
    expect(restore.onScene('hall', null)).toBeNull();
    restore.begin('street', edit);
    restore.onScene('hall', 'street');
    expect(restore.onScene('hall', 'street')).toBeNull();
  });
});

describe('session of a reloaded tab', () => {
  it('is taken once, so that a duplicated tab does not share it', () => {
    const entries = new Map<string, string>();
    const storage = {
      getItem: (key: string) => entries.get(key) ?? null,
      setItem: (key: string, value: string) => void entries.set(key, value),
      removeItem: (key: string) => void entries.delete(key),
    } as unknown as Storage;
    const kept = {
      session: 's',
      lastInput: 9,
      sceneName: 'hall',
      home: pose(1),
      edit: { exposure_ev: 2 },
      own: { exposure: 0, densities: [1] },
    };
    keep(kept, storage);
    expect(takeKept(storage)).toEqual(kept);
    expect(takeKept(storage)).toBeNull();
  });
});
