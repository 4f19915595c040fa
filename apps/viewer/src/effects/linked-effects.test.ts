import type { EffectUse } from '@websplatter/core/effects';
import { builtinScenes } from '@websplatter/scenes';
import { beforeEach, describe, expect, it } from 'vitest';
import type { SceneSource } from '../engine/open/scene-source.ts';
import type { Viewer } from '../engine/viewer.ts';
import { NO_EFFECTS } from '../state/effects.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import { followLinkedEffects } from './linked-effects.ts';

const builtin: SceneSource = { kind: 'builtin', scene: builtinScenes[0] };
const file: SceneSource = { kind: 'file', name: 'a.ply', source: new File([], 'a.ply') };

let store: ViewerStore;
let asked: readonly EffectUse[];
let drawable: { parts: readonly { source: SceneSource }[] } | null;
const names = () => asked.map(({ effect }) => effect.name);

/** Opens the page at `address`; its first scene is `source`. */
async function open(address: string, source: SceneSource): Promise<void> {
  const query = new URLSearchParams(address);
  const viewer = {
    scenes: {
      get drawable() {
        return drawable;
      },
    },
    camera: { controls: { home: { target: [0, 0, 0], distance: 2 } }, subjectSphere: null },
    shownFrame: null,
    setEffects: (_: string, uses: readonly EffectUse[]) => {
      asked = uses;
    },
  } as unknown as Viewer;
  followLinkedEffects({ store, viewer }, query);
  expect(asked).toEqual([]);
  drawable = { parts: [{ source }] };
  store.setState({ scene: {} as never });
  await Promise.resolve();
}

beforeEach(() => {
  store = createViewerStore();
  asked = [];
  drawable = null;
});

describe('the effects of a link', () => {
  it('are asked for once its scene is there, with what the link does not tell', async () => {
    await open('effects=volumes:sphere:1:2:3:0.5:keep:0,fog:density:0.1:ff0000', builtin);
    expect(names()).toEqual(['volumes', 'fog']);
    const { volumes } = store.getState().requested.choices;
    expect(volumes?.values).toMatchObject({
      shape: 'sphere',
      center: [1, 2, 3],
      radius: 0.5,
      size: [1, 1, 1],
    });
    expect(store.getState().notice).toBeNull();
  });

  it('are not those of a file that was opened meanwhile, nor of a scene in place of another', async () => {
    await open('effects=tint:ff0000', file);
    expect(names()).toEqual([]);
    store = createViewerStore();
    await open('src=gone.ply&effects=tint:ff0000', builtin);
    expect(names()).toEqual([]);
  });

  it('come with its crop, which is drawn the way up that the scene is shown', async () => {
    store.setState({ isFlipped: true });
    await open('effects=tint:ff0000&crop=-1:0:2:1:2:4:outside', builtin);
    expect(store.getState().inspecting.crop).toEqual({ min: [-1, 0, 2], max: [1, 2, 4], keep: 'outside' });
    expect(names()).toEqual(['volumes']);
    expect(asked[0].options).toEqual([{ shape: 'box', mode: 'hide', center: [0, -1, -3], size: [2, 2, 2] }]);
    store = createViewerStore();
    drawable = null;
    asked = [];
    await open('crop=1:2:3', builtin);
    expect(store.getState().inspecting.crop).toBeNull();
    expect(store.getState().notice).toContain('crop=x:y:z');
  });

  it('are refused with a reason where they cannot be read, beside what else there is to say', async () => {
    store.setState({ notice: 'Another notice.' });
    await open('effects=glow:1', builtin);
    expect(store.getState().notice).toMatch(/^Another notice\. .*no effect “glow”/);
  });

  it('are refused by the engine where a number cannot be', async () => {
    await open('effects=fog:depths:3:1:c8d0dc', builtin);
    expect(store.getState().notice).toContain('far is 1');
    expect(store.getState().requested).toBe(NO_EFFECTS);
    expect(names()).toEqual([]);
  });
});
