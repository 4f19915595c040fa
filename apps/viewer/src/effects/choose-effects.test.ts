import { expect, it } from 'vitest';
import type { PanelProps } from '../engine/viewer.ts';
import type { RequestedEffects } from '../state/effects.ts';
import { createViewerStore } from '../state/store.ts';
import { changeEffect, resetEffect, switchEffect } from './choose-effects.ts';

it('fog begins with the colour of the background, and keeps a chosen one until it is reset', () => {
  const store = createViewerStore();
  const viewer = {
    camera: { controls: { home: { target: [0, 0, 0], distance: 3 } }, subjectSphere: null },
    shownFrame: {
      frame: {
        camera: { viewMatrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -3, 1] },
        background: [15 / 255, 17 / 255, 1],
      },
    },
    setEffects: (owner: keyof RequestedEffects, uses: unknown) =>
      store.setState(({ requested }) => ({ requested: { ...requested, [owner]: uses } })),
  };
  const panel = { store, viewer } as unknown as PanelProps;
  const color = () => store.getState().requested.choices.fog?.values.color;
  switchEffect(panel, 'fog', true);
  expect(color()).toBe('#0f11ff');
  changeEffect(panel, 'fog', (values) => ({ ...values, color: '#aabbcc' }));
  switchEffect(panel, 'fog', false);
  switchEffect(panel, 'fog', true);
  expect(color()).toBe('#aabbcc');
  resetEffect(panel, 'fog');
  expect(color()).toBe('#0f11ff');
});
