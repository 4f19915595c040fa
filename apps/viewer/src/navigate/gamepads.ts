import { orbitedBy, sticksOf } from '../camera/gamepad-motion.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { CommandName, RunCommand } from '../state/command-list.ts';
import type { ViewerStore } from '../state/store.ts';

/** Commands by button index in the standard mapping: the lower, right and upper face buttons. */
const BUTTON_COMMANDS: Readonly<Record<number, CommandName>> = { 0: 'frame', 1: 'reset', 3: 'fly' };
/** Longest step of the camera, s: it does not jump after a pause, as when the page was hidden. */
const LONGEST_STEP_S = 0.1;

/**
 * Lets gamepads move the camera, around the scene or through it. Gamepads send no input events:
 * their state is polled at each display refresh. Returns a function that stops this.
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

/** Connected gamepads with the standard mapping of sticks and buttons. */
function connectedGamepads(): Gamepad[] {
  return [...navigator.getGamepads()].filter(
    (pad): pad is Gamepad => pad?.mapping === 'standard' && pad.connected,
  );
}
