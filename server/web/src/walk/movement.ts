// A viewer's position and direction, moved by keys and by dragging. On foot (a walk view space) steps stay level; elsewhere they follow the
// look.

import type { Vector } from "../runtime/placement";

export interface Pose {
  readonly position: Vector;
  readonly direction: Vector;
}

const TURN_RAD_S = 1.4,
  DRAG_RAD_PX = 0.005,
  STEEPEST_RAD = 1.5;
const MOVES: Record<string, "forward" | "back" | "left" | "right" | "turnLeft" | "turnRight" | "up" | "down"> = {
  KeyW: "forward",
  ArrowUp: "forward",
  KeyS: "back",
  ArrowDown: "back",
  KeyA: "left",
  KeyD: "right",
  ArrowLeft: "turnLeft",
  ArrowRight: "turnRight",
  KeyR: "up",
  KeyF: "down",
  PageUp: "up",
  PageDown: "down",
};

const anglesOf = ([x, y, z]: Vector) => ({ yaw: Math.atan2(-x, -z), pitch: Math.atan2(y, Math.hypot(x, z)) });
const directionOf = (yaw: number, pitch: number): Vector => [
  -Math.sin(yaw) * Math.cos(pitch),
  Math.sin(pitch),
  -Math.cos(yaw) * Math.cos(pitch),
];
const isTyping = (target: EventTarget | null) => target instanceof HTMLElement && ["INPUT", "SELECT", "TEXTAREA"].includes(target.tagName);

export class Movement {
  private readonly held = new Set<string>();
  private fast = false;

  /// `settle` says where a step to a position really leads.
  constructor(
    canvas: HTMLCanvasElement,
    private current: Pose,
    private readonly speed_m_s: number,
    private readonly onFoot: boolean,
    private readonly settle: (position: Vector) => Vector,
    private readonly changed: () => void,
    signal: AbortSignal,
  ) {
    addEventListener("keydown", (event) => this.press(event), { signal });
    addEventListener("keyup", (event) => this.held.delete(event.code), { signal });
    addEventListener("blur", () => this.held.clear(), { signal });
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId), { signal });
    canvas.addEventListener(
      "pointermove",
      (event) => canvas.hasPointerCapture(event.pointerId) && this.turn(event.movementX * DRAG_RAD_PX, event.movementY * DRAG_RAD_PX),
      { signal },
    );
  }

  get pose(): Pose {
    return this.current;
  }

  get moving(): boolean {
    return this.held.size > 0;
  }

  jump(pose: Pose): void {
    this.current = pose;
    this.changed();
  }

  /// Keys that were held for so long.
  advance(seconds: number): void {
    if (!this.moving) return;
    const has = (move: string) => [...this.held].some((code) => MOVES[code] === move);
    const axis = (plus: string, minus: string) => Number(has(plus)) - Number(has(minus));
    const turned = axis("turnLeft", "turnRight") * TURN_RAD_S * seconds;
    if (turned !== 0) this.turn(turned, 0);
    const { yaw, pitch } = anglesOf(this.current.direction);
    const ahead = this.onFoot ? directionOf(yaw, 0) : directionOf(yaw, pitch),
      aside = directionOf(yaw - Math.PI / 2, 0);
    const step = this.speed_m_s * (this.fast ? 4 : 1) * seconds;
    const along = axis("forward", "back") * step,
      across = axis("right", "left") * step,
      above = axis("up", "down") * step;
    if (along === 0 && across === 0 && above === 0) return;
    const { position } = this.current;
    const to: Vector = [
      position[0] + along * ahead[0] + across * aside[0],
      position[1] + along * ahead[1] + above,
      position[2] + along * ahead[2] + across * aside[2],
    ];
    this.jump({ ...this.current, position: above === 0 ? this.settle(to) : to });
  }

  private turn(left: number, up: number): void {
    const { yaw, pitch } = anglesOf(this.current.direction);
    this.jump({ ...this.current, direction: directionOf(yaw + left, Math.min(Math.max(pitch + up, -STEEPEST_RAD), STEEPEST_RAD)) });
  }

  private press(event: KeyboardEvent): void {
    if (isTyping(event.target) || event.ctrlKey || event.altKey || event.metaKey || MOVES[event.code] === undefined) return;
    this.fast = event.shiftKey;
    this.held.add(event.code);
    event.preventDefault();
    this.changed();
  }
}
