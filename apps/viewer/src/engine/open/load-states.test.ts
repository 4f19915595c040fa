import { describe, expect, it, test } from 'vitest';
import type { Session } from '../show/session.ts';
import {
  type AskedPart,
  added,
  arrived,
  began,
  completed,
  dropped,
  ended,
  failed,
  isPartial,
  type LoadStage,
  NOTHING_ASKED,
  opened,
  type Preview,
  previewOf,
  putFirst,
  replaced,
  type SceneLoad,
  stopped,
  type WaitingPreview,
  waitingOf,
  waits,
} from './load-states.ts';
import type { ShownScene } from './shown-scene.ts';

const session = {} as Session;
const sceneOf = (files: number, change: Partial<ShownScene> = {}) =>
  ({ session, parts: Array(files).fill({}), firstView: null, ownCameras: null, ...change }) as ShownScene;
const asked = (key: number): AskedPart => ({ key, source: { kind: 'hard-case', name: 'a' }, look: null });
const report = { title: '', message: '' };

const scene = sceneOf(1);
const [one, two, three] = [1, 2, 3].map(asked);
const reading = new AbortController();
const preview = { scene: sceneOf(1) } as Preview;
const waiting = { framing: new AbortController() } as WaitingPreview;

const STAGES = {
  idle: { at: 'idle' },
  opening: { at: 'opening' },
  'framing a part': { at: 'framing', of: waiting },
  'framing the scene': { at: 'framing', of: 'scene' },
  arriving: { at: 'arriving', preview },
  shown: { at: 'shown' },
  failed: { at: 'failed' },
} satisfies Record<string, LoadStage>;
type Stage = keyof typeof STAGES;

const loadAt = (stage: Stage, change: Partial<SceneLoad> = {}): SceneLoad => ({
  ...{ scene, queue: [one, two], role: 'begins', failures: [report], stage: STAGES[stage], ...change },
  reading: ['idle', 'shown', 'failed'].includes(stage) ? null : reading,
});

const other = new AbortController();
const both = sceneOf(2);
/** Each event, the stage after it (null: the one before), and what else it changes. All else is kept. */
const EVENTS: readonly [string, (load: SceneLoad) => SceneLoad, Stage | null, Partial<SceneLoad>][] = [
  ['added', (load) => added(load, [three]), null, { queue: [one, two, three], failures: [] }],
  [
    'replaced',
    (load) => replaced(load, [three]),
    'idle',
    { queue: [three], reading: null, role: 'replaces', failures: [] },
  ],
  ['putFirst', (load) => putFirst(load, [three]), null, { queue: [three, one, two], role: 'replaces' }],
  ['began', (load) => began(load, other), 'opening', { reading: other }],
  ['waits', (load) => waits(load, waiting), 'framing a part', {}],
  ['arrived', (load) => arrived(load, preview), 'arriving', {}],
  ['dropped', dropped, 'opening', {}],
  ['opened', (load) => opened(load, both, false), 'opening', { scene: both, role: 'completes' }],
  ['failed', (load) => failed(load, report), null, { failures: [report, report] }],
  ['completed', completed, null, { role: 'joins' }],
  ['ended', (load) => ended(load, session), 'idle', { queue: [two], reading: null }],
  ['stopped', stopped, 'idle', { reading: null, role: 'joins' }],
];

describe.each(EVENTS)('%s', (_, after, stage, change) => {
  it.each(Object.keys(STAGES) as Stage[])('from %s', (before) => {
    const load = loadAt(before);
    expect(after(load)).toEqual({ ...load, ...change, stage: STAGES[stage ?? before] });
    expect(load).toEqual(loadAt(before));
  });
});

test('what is drawn, what waits, and what is partial, in each stage', () => {
  const stagesWith = (isSo: (load: SceneLoad) => unknown) =>
    (Object.keys(STAGES) as Stage[]).filter((stage) => isSo(loadAt(stage)));
  expect(stagesWith(previewOf)).toEqual(['arriving']);
  expect(stagesWith(waitingOf)).toEqual(['framing a part']);
  expect(stagesWith(isPartial)).toEqual(['framing the scene', 'arriving']);
});

describe('the role of the next file', () => {
  const firstView = {} as ShownScene['firstView'];

  it.each<[string, Stage, SceneLoad['role'], ShownScene, SceneLoad['role']]>([
    ['begins a scene with the first file', 'opening', 'replaces', scene, 'begins'],
    ['completes it after a part was drawn', 'arriving', 'replaces', scene, 'completes'],
    ['begins it where it has a view of its own', 'arriving', 'replaces', sceneOf(1, { firstView }), 'begins'],
    ['completes it with the second file', 'opening', 'begins', both, 'completes'],
    ['completes it with the third', 'opening', 'completes', sceneOf(3), 'completes'],
    ['joins where files were added', 'opening', 'joins', both, 'joins'],
    ['begins where it was added to no scene', 'opening', 'joins', scene, 'begins'],
  ])('%s', (_, stage, role, with_, after) => {
    expect(opened(loadAt(stage, { role }), with_, false).role).toBe(after);
  });

  it('joins where the scene is opened again', () => {
    expect(opened(loadAt('arriving', { role: 'replaces' }), scene, true).role).toBe('joins');
  });

  it('replaces the scene until a file has opened, whatever ends', () => {
    for (const after of [completed, stopped])
      expect(after(loadAt('opening', { role: 'replaces' })).role).toBe('replaces');
  });
});

it('finds the first view of a scene again once all its files are open', () => {
  const load = loadAt('opening', { role: 'completes' });
  expect(completed(load)).toEqual({ ...load, role: 'joins', stage: STAGES['framing the scene'] });
});

describe('after the last file of the queue', () => {
  const last = loadAt('opening', { queue: [one] });

  it('the scene is shown, and failures are told no more', () => {
    const shown = { ...NOTHING_ASKED, scene, role: 'joins', stage: STAGES.shown };
    expect(ended(last, session)).toEqual(shown);
  });

  it('opening has failed where there is no scene of this session', () => {
    expect(ended({ ...last, scene: null }, session).stage).toEqual(STAGES.failed);
    expect(ended(last, {} as Session).stage).toEqual(STAGES.failed);
  });
});
