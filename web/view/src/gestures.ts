import type { Panel } from "./panel.ts";
import type { State } from "./state.ts";

/** What the hand does on one panel. */
export interface Hand {
  /** The pointer is over a point of the panel; `tapped` where it was pressed and let go there. */
  over(x: number, y: number, tapped: boolean): void;
  /** The pointer has left. */
  left(): void;
  /** What is shown has changed. */
  changed(): void;
}

/** Pixels that a pointer may move and still tap. */
const TAP = 6;

/** Moves and zooms the camera, and measures, by mouse, pen or fingers. */
export function listen(stage: HTMLElement, panel: Panel, state: State, hand: Hand): void {
  const fingers = new Map<number, { x: number; y: number }>();
  let moved = 0;
  let measuring = false;
  const place = (event: MouseEvent): [number, number] => {
    const box = stage.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  stage.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    stage.setPointerCapture(event.pointerId);
    const [x, y] = place(event);
    fingers.set(event.pointerId, { x, y });
    moved = 0;
    measuring = fingers.size === 1 && (state.measuring || event.shiftKey);
    if (measuring) {
      const [px, py] = panel.view(state).plane(x, y);
      state.line = [px, py, px, py];
    }
    stage.classList.toggle("dragging", !measuring);
  });
  stage.addEventListener("pointermove", (event) => {
    const [x, y] = place(event);
    const last = fingers.get(event.pointerId);
    if (!last) {
      hand.over(x, y, false);
      return;
    }
    const [dx, dy] = [x - last.x, y - last.y];
    moved += Math.abs(dx) + Math.abs(dy);
    if (measuring && state.line) {
      const [px, py] = panel.view(state).plane(x, y);
      state.line = [state.line[0], state.line[1], px, py];
    } else if (fingers.size === 1) {
      if (moved > TAP) state.camera.pan(dx, dy);
    } else {
      pinch(fingers, event.pointerId, x, y, panel, state);
    }
    fingers.set(event.pointerId, { x, y });
    hand.changed();
  });
  const end = (event: PointerEvent) => {
    if (!fingers.delete(event.pointerId)) return;
    stage.classList.remove("dragging");
    const [x, y] = place(event);
    if (measuring && moved <= TAP) state.line = null;
    else if (event.type === "pointerup" && !measuring && moved <= TAP) hand.over(x, y, true);
    measuring = false;
    hand.changed();
  };
  stage.addEventListener("pointerup", end);
  stage.addEventListener("pointercancel", end);
  stage.addEventListener("pointerleave", () => {
    hand.left();
  });
  stage.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const [x, y] = place(event);
      const by = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 0.0016 : 0.05;
      state.camera.zoom(Math.exp(-event.deltaY * by), x, y, panel.width, panel.height);
      hand.changed();
    },
    { passive: false },
  );
}

/** Two fingers: what is under each stays under it. */
function pinch(
  fingers: Map<number, { x: number; y: number }>,
  moving: number,
  x: number,
  y: number,
  panel: Panel,
  state: State,
): void {
  const [, other] = [...fingers].find(([id]) => id !== moving) ?? [];
  const last = fingers.get(moving);
  if (!other || !last) return;
  const [before, after] = [Math.hypot(last.x - other.x, last.y - other.y), Math.hypot(x - other.x, y - other.y)];
  if (before < 1 || after < 1) return;
  state.camera.zoom(after / before, other.x, other.y, panel.width, panel.height);
}
