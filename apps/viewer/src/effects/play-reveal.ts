import type { PanelProps } from '../engine/panel-props.ts';
import { scenePlaceOf } from '../engine/scene-place.ts';
import { changeEffect } from './choose-effects.ts';
import { slidersOf } from './effect-sliders.ts';

/** From nothing to the whole scene. */
const REVEAL_MS = 3000;

type RequestFrame = (step: (nowMs: number) => void) => void;

/**
 * Lets the scene appear from nothing. It ends when all of it is there, when `isRevealPlaying` is
 * set to false, and when something else changes the effect.
 */
export function playReveal(panel: PanelProps, requestFrame: RequestFrame = requestAnimationFrame): void {
  const { store, viewer } = panel;
  const chosen = () => store.getState().requested.choices.reveal;
  const place = scenePlaceOf(viewer);
  let beganMs: number | null = null;
  let last = chosen();
  const step = (nowMs: number) => {
    const isOurs = last?.isOn && chosen() === last;
    if (!isOurs || !store.getState().isRevealPlaying) {
      store.setState({ isRevealPlaying: false });
      return;
    }
    beganMs ??= nowMs;
    const part = (nowMs - beganMs) / REVEAL_MS;
    changeEffect(panel, 'reveal', (values) => {
      const radius = slidersOf('reveal', values, place).find(({ name }) => name === 'radius');
      // All is there at its end.
      return radius?.write(values, Math.min(part, 1) * radius.max) ?? values;
    });
    last = chosen();
    if (part < 1) requestFrame(step);
    else store.setState({ isRevealPlaying: false });
  };
  store.setState({ isRevealPlaying: true });
  requestFrame(step);
}
