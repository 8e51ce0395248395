/** One WebSocket that comes back by itself. Knows nothing of scenes or pictures. */

import type { Access } from './access';
import { backoffMillis } from './backoff';
import type { ClientMessage, ServerMessage } from './protocol.gen';
import { Signal } from './store';

export type ConnectionState = 'connecting' | 'connected' | 'reconnecting' | 'refused' | 'offline';

/** Failed attempts in a row after which the page says "offline" instead of "reconnecting". */
const OFFLINE_AFTER = 4;
const CONNECT_TIMEOUT_MILLIS = 10_000;

export interface ConnectionEvents {
  /** The socket is open; the return value is the first message sent on it. */
  onOpen(): ClientMessage;
  onMessage(message: ServerMessage): void;
  onPicture(message: ArrayBuffer): void;
  onBroken(reason: string): void;
  /**
   * Asks whether the server lets the page in: before the first socket, and before the next one after one to
   * which the server did not say welcome. A browser hides from a WebSocket why it was refused.
   */
  mayConnect(): Promise<Access>;
}

export class Connection {
  readonly state = new Signal<ConnectionState>('connecting');
  private socket: WebSocket | null = null;
  private failures = 0;
  private everConnected = false;
  private welcomed = false;
  /** The question whether the server lets the page in is on its way. */
  private asking = false;
  private retryTimer: ReturnType<typeof setTimeout> | undefined;
  private connectTimer: ReturnType<typeof setTimeout> | undefined;
  private received = 0;

  constructor(
    private readonly url: string,
    private readonly events: ConnectionEvents,
  ) {
    window.addEventListener('online', () => this.retryNow());
    window.addEventListener('offline', () => this.dropped('offline'));
    document.addEventListener('visibilitychange', () => {
      if (!document.hidden) this.retryNow();
    });
  }

  /** Bytes received since the page was opened. */
  get bytesReceived(): number {
    return this.received;
  }

  get isOpen(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  /** Connects, once the server has said that it lets the page in. */
  open(): void {
    clearTimeout(this.retryTimer);
    if (this.asking) return;
    if (this.welcomed) {
      this.connect();
      return;
    }
    this.asking = true;
    void this.events.mayConnect().then((access) => {
      this.asking = false;
      this.answered(access);
    });
  }

  private answered(access: Access): void {
    switch (access) {
      case 'admitted':
        if (this.state.value === 'refused') this.state.set('connecting');
        this.connect();
        break;
      case 'unreachable':
        this.tryLater('reconnecting');
        break;
      case 'later':
        this.state.set('refused');
        this.tryLater('reconnecting');
        break;
      case 'refused':
        // Asked again when somebody comes back to the page.
        this.state.set('refused');
        break;
    }
  }

  private connect(): void {
    this.welcomed = false;
    const socket = new WebSocket(this.url);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.connectTimer = setTimeout(() => this.dropped('reconnecting'), CONNECT_TIMEOUT_MILLIS);
    socket.onopen = () => {
      clearTimeout(this.connectTimer);
      this.send(this.events.onOpen());
    };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => this.receive(event.data);
    // A failure is always followed by a close.
    socket.onclose = () => this.dropped('reconnecting');
  }

  /** False when there is no open socket; the caller keeps what it wanted to say. */
  send(message: ClientMessage): boolean {
    if (!this.isOpen) return false;
    this.socket?.send(JSON.stringify(message));
    return true;
  }

  /** Skips the rest of the wait, if the page is waiting. */
  retryNow(): void {
    if (this.socket === null) this.open();
  }

  /** Closes the socket as a broken network would; the page reconnects. */
  drop(): void {
    this.socket?.close();
  }

  private receive(data: string | ArrayBuffer): void {
    if (data instanceof ArrayBuffer) {
      this.received += data.byteLength;
      this.events.onPicture(data);
      return;
    }
    this.received += data.length;
    let message: ServerMessage;
    try {
      message = JSON.parse(data) as ServerMessage;
    } catch {
      this.events.onBroken('the server sent a message that is not JSON');
      return;
    }
    if (message.type === 'welcome') {
      // Only now: a server that accepts and closes at once must not be hammered.
      this.failures = 0;
      this.everConnected = true;
      this.welcomed = true;
      this.state.set('connected');
    }
    this.events.onMessage(message);
  }

  private dropped(state: ConnectionState): void {
    const socket = this.socket;
    if (socket === null) return;
    clearTimeout(this.connectTimer);
    this.socket = null;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
    this.tryLater(state);
  }

  private tryLater(state: ConnectionState): void {
    const wait = backoffMillis(this.failures);
    this.failures += 1;
    if (this.state.value === 'refused') {
      // The page says why already; it goes on trying in case the server changes its mind.
    } else if (this.failures >= OFFLINE_AFTER || state === 'offline') this.state.set('offline');
    else this.state.set(this.everConnected ? 'reconnecting' : 'connecting');
    this.retryTimer = setTimeout(() => this.open(), wait);
  }
}
