import type { SplatPick } from '@websplatter/core';
import { vi } from 'vitest';
import type { Inspecting } from '../state/inspecting.ts';
import { createViewerStore } from '../state/store.ts';
import type { InspectTools } from './inspect-tools.ts';

/** Tools without a GPU and without files: `pickAt` gives `pick`, and `ask` is to be taught. */
export function fakeTools(pick: Partial<SplatPick> | null = null) {
  const store = createViewerStore();
  const ask = vi.fn<(about: string, question: unknown) => Promise<unknown>>();
  const viewer = {
    pickAt: vi.fn(async () => pick as SplatPick | null),
    askShown: vi.fn(async () => null),
    shownFrame: null as InspectTools['viewer']['shownFrame'],
    setEffects: vi.fn<InspectTools['viewer']['setEffects']>(),
    scenes: { newest: null } as unknown as InspectTools['viewer']['scenes'],
    camera: { controls: { home: { target: [1, 2, 3] } } } as unknown as InspectTools['viewer']['camera'],
  };
  const update = (change: Partial<Inspecting>) =>
    store.setState(({ inspecting }) => ({ inspecting: { ...inspecting, ...change } }));
  const tools: InspectTools = {
    store,
    viewer,
    reader: { ask: ask as InspectTools['reader']['ask'] },
    update,
  };
  return { tools, store, viewer, ask, inspecting: () => store.getState().inspecting };
}
