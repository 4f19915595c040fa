import { orbitedBy, sticksOf } from '../camera/gamepad-motion.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { CommandName, RunCommand } from '../state/command-list.ts';
import type { ViewerStore } from '../state/store.ts';

/** Commands of buttons by place in the standard mapping: lower, right and upper one of the four. */
const BUTTON_COMMANDS: Readonly<Record<number, CommandName>> = { 0: 'frame', 1: 'reset', 3: 'fly' };
/** After a longer pause, as when the page was hidden, the camera does not jump. */
const LONGEST_STEP_S = 0.1;

/**
 * Moves the camera by gamepads from now on, around the scene or through it. Gamepads have no events:
 * connected ones are asked at each refresh of the screen. Returns a function that stops this.
 */
export function followGamepads(viewer: Viewer, store: ViewerStore, run: RunCommand): () => void {
  let handle = 0;
  let lastMs: number | null = null;
  const held = new Set<number>();

  const step = (nowMs: number) => {
    const pads = connectedGamepads();
    handle = pads.length > 0 ? requestAnimationFrame(step) : 0;
    const elapsedS = lastMs === null ? 0 : Math.min(LONGEST_STEP_S, (nowMs - lastMs) / 1000);
    lastMs = handle === 0 ? null : nowMs;
    const { status, scene, isHelpVisible } = store.getState();
    if (status !== 'running' || !scene || isHelpVisible) return;
    for (const pad of pads) {
      move(pad, elapsedS);
      press(pad);
    }
  };

  const move = (pad: Gamepad, elapsedS: number) => {
    const sticks = sticksOf(pad);
    if (!sticks) return;
    const { controls, steering } = viewer.camera;
    const { pose, fovYDegrees, distanceRange } = controls;
    if (steering) steering(sticks, elapsedS);
    else controls.moveTo(orbitedBy(pose, sticks, elapsedS, fovYDegrees, distanceRange));
  };

  const press = ({ index, buttons }: Gamepad) => {
    for (const [button, command] of Object.entries(BUTTON_COMMANDS)) {
      const id = 100 * index + Number(button);
      const isPressed = buttons[Number(button)]?.pressed ?? false;
      if (isPressed && !held.has(id)) run(command);
      if (isPressed) held.add(id);
      else held.delete(id);
    }
  };

  const begin = () => {
    if (handle === 0) handle = requestAnimationFrame(step);
  };
  begin();
  window.addEventListener('gamepadconnected', begin);
  return () => {
    window.removeEventListener('gamepadconnected', begin);
    cancelAnimationFrame(handle);
  };
}

/** Those whose sticks and buttons are where they are expected. */
function connectedGamepads(): Gamepad[] {
  return [...navigator.getGamepads()].filter(
    (pad): pad is Gamepad => pad?.mapping === 'standard' && pad.connected,
  );
}
