/** What the page and the server agree on about steering: modes, pivots, stops, frames. */

import type { Place } from './camera/aim';
import { Follower } from './camera/follower';
import { framing } from './camera/frame';
import { reach } from './camera/pose';
import type { CameraRig } from './camera/rig';
import { length, subtract } from './camera/vec';
import type {
  CameraMessage,
  CameraPose,
  ClientMessage,
  Navigation,
  NavigationMessage,
  PickedMessage,
  PickedPoint,
} from './protocol.gen';

const ORDER: readonly Navigation[] = ['look', 'orbit', 'fly'];
const CENTRE: Place = [0.5, 0.5];
/** How far from where it was an answer to a pick may find the camera, as a share of the way to the point. */
const MOVED_ON = 0.05;

export interface SteeringEvents {
  /** False if nothing can be sent now. */
  send(message: ClientMessage): boolean;
  onMode(mode: Navigation): void;
  /** A surface is in the way. */
  onHeldUp(): void;
}

interface Question {
  /** Where the eye was when the question was asked. */
  asked: CameraPose;
  onAnswer(hit: PickedPoint | undefined): void;
}

export class Steering {
  private readonly follower = new Follower();
  private facts: NavigationMessage | null = null;
  /** The user's own choice for this scene, or the scene's. */
  private chosen: Navigation | null = null;
  private request = 0;
  private question: Question | null = null;

  constructor(
    private readonly rig: CameraRig,
    private readonly events: SteeringEvents,
  ) {}

  get navigation(): NavigationMessage | null {
    return this.facts;
  }

  /** Another scene is open, in which the user may have chosen a mode before. */
  opened(chosen: Navigation | null): void {
    this.facts = null;
    this.chosen = chosen;
    this.connected();
  }

  /** No answer to what was asked before comes any more. */
  connected(): void {
    this.question = null;
    this.follower.reset();
  }

  /** The server knows what suits the scene. */
  advised(facts: NavigationMessage): void {
    const first = this.facts === null;
    this.facts = facts;
    this.rig.setExtent(length(subtract(facts.bounds.max, facts.bounds.min)));
    if (!first) return;
    const mode = this.chosen ?? facts.mode;
    this.rig.mode = mode;
    // The pivot lies on the line of sight, so the picture stays as it is.
    const home = this.rig.homePose;
    const atHome = reach(home) > 0 && this.rig.current === home;
    if (mode === 'orbit' && atHome) {
      this.rig.setPivotDistance(length(subtract(facts.pivot, home.position)));
    }
    this.chosen = mode;
    this.events.onMode(mode);
  }

  nextMode(): void {
    const at = ORDER.indexOf(this.rig.mode);
    this.setMode(ORDER[(at + 1) % ORDER.length] ?? 'orbit');
  }

  setMode(mode: Navigation): void {
    this.rig.mode = mode;
    this.chosen = mode;
    this.events.onMode(mode);
    if (mode !== 'orbit') return;
    // Orbits what is in the middle of the picture.
    this.ask(CENTRE, (hit) => {
      if (hit === undefined || this.rig.mode !== 'orbit') return;
      const { position } = this.rig.current;
      this.rig.setPivotDistance(length(subtract(hit.point, position)));
    });
  }

  goHome(): void {
    this.rig.goHome();
  }

  /** Shows everything in a picture with this ratio of width to height. */
  frameAll(aspect: number): void {
    if (this.facts === null) {
      this.rig.goHome();
      return;
    }
    const { bounds, overview } = this.facts;
    this.rig.go(framing(this.rig.homePose, bounds, overview, aspect), true);
  }

  /** A double click or tap: turn about what is there, or walk up to it. */
  goTo(place: Place): void {
    this.ask(place, (hit) => {
      if (hit !== undefined) this.rig.goTo(hit.point, hit.normal ?? null);
    });
  }

  /** A camera left as this input. */
  left(input: number, pose: CameraPose): void {
    this.follower.left(input, pose);
  }

  /** A surface stopped the eye. Returns whether the camera is now exactly what the server shows. */
  stopped({ input, camera }: CameraMessage): boolean {
    const next = this.follower.stopped(input, camera, this.rig.current);
    if (this.follower.isHeldUp) this.events.onHeldUp();
    this.rig.correct(next);
    return next === camera;
  }

  picked({ request, hit }: PickedMessage): void {
    const { question } = this;
    if (question === null || request !== this.request) return;
    this.question = null;
    const moved = subtract(this.rig.current.position, question.asked.position);
    const way = hit && length(subtract(hit.point, question.asked.position));
    // The answer is about what was seen when it was asked.
    if (way !== undefined && length(moved) > MOVED_ON * way) return;
    question.onAnswer(hit);
  }

  private ask(place: Place, onAnswer: Question['onAnswer']): void {
    this.request += 1;
    if (!this.events.send({ type: 'pick', request: this.request, place })) return;
    this.question = { asked: this.rig.current, onAnswer };
  }
}
