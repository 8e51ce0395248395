/** What the page knows, for tests and for curious engineers at the console. */

import type { ConnectionState } from './connection';
import type { FrameHeader } from './header';
import type { LatencySummary } from './latency';
import type {
  CameraPose,
  DarknessCause,
  Navigation,
  NavigationMessage,
  Plan,
  Stats,
  Welcome,
} from './protocol.gen';

export interface DebugState {
  connection: ConnectionState;
  welcome: Welcome | null;
  /** Number of welcomes received: one more for every reconnection. */
  connections: number;
  sceneName: string;
  framesPainted: number;
  lastHeader: FrameHeader | null;
  stats: Stats | null;
  plan: Plan | null;
  latency: LatencySummary | null;
  lastInput: number;
  camera: CameraPose | null;
  /** The way of steering; null until the server has said what suits the scene. */
  mode: Navigation | null;
  navigation: NavigationMessage | null;
  /** Why the picture is black, while the page says so. */
  darkness: DarknessCause | null;
  /** Whether the page says that the picture is too bright to show anything. */
  overexposed: boolean;
  errors: string[];
  /** Closes the socket as a broken network would. */
  drop(): void;
}

declare global {
  interface Window {
    __tyndall: DebugState;
  }
}
