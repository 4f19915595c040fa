import { beforeEach, expect, it } from 'vitest';
import type { PanelProps } from '../engine/viewer.ts';
import { createViewerStore } from '../state/store.ts';
import { changeEffect, switchEffect } from './choose-effects.ts';
import { playReveal } from './requested-effects-form.tsx';

let panel: PanelProps;
let steps: ((nowMs: number) => void)[];
const chosen = () => panel.store.getState().requested.choices.reveal?.values;
const isPlaying = () => panel.store.getState().isRevealPlaying;
const stepAt = (nowMs: number) => steps.shift()?.(nowMs);

beforeEach(() => {
  const viewer = {
    camera: { controls: { home: { target: [0, 0, 0], distance: 2 } }, subjectSphere: null },
    shownFrame: null,
    setEffects: () => {},
  } as unknown as PanelProps['viewer'];
  panel = { store: createViewerStore(), viewer };
  steps = [];
  switchEffect(panel, 'reveal', true);
  playReveal(panel, (step) => steps.push(step));
});

it('lets the scene appear from nothing until all of it is there', () => {
  expect(isPlaying()).toBe(true);
  stepAt(1000);
  expect(chosen()?.radius).toBe(0);
  stepAt(2500);
  expect(chosen()?.radius).toBeCloseTo(1, 9);
  stepAt(4000);
  expect(chosen()?.radius).toBe(Infinity);
  expect(isPlaying()).toBe(false);
  expect(steps).toHaveLength(0);
});

it('ends where a person takes the slider', () => {
  stepAt(0);
  changeEffect(panel, 'reveal', (values) => ({ ...values, radius: 0.25 }));
  stepAt(100);
  expect(chosen()?.radius).toBe(0.25);
  expect(isPlaying()).toBe(false);
});

it('ends where it is stopped, and keeps what is there', () => {
  stepAt(0);
  stepAt(1500);
  panel.store.setState({ isRevealPlaying: false });
  stepAt(2000);
  expect(chosen()?.radius).toBeCloseTo(1, 9);
  expect(steps).toHaveLength(0);
});
