// Proves: whatever may be in one frame is drawn together as in float64, or refused by name.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { WebSplatterError } from '../data/errors.ts';
import { compareImages, renderReference } from '../reference/index.ts';
import { type FrameMember, frameMembers, MemberFrames } from '../testing/frame-members.ts';

const SIZE = { widthPx: 32, heightPx: 32 };

let device: GPUDevice;
let members: readonly FrameMember[];
let frames: MemberFrames;
beforeAll(async () => {
  device = await shareTestDevice();
  members = frameMembers(device);
  frames = new MemberFrames(device);
});
afterAll(() => frames.destroy());

/**
 * Members that refuse each other, by what the error says. The test device binds as few storage buffers as
 * WebGPU promises.
 */
const REFUSED: readonly [readonly string[], RegExp][] = [
  [['opacity', 'opacity of the cloud'], /The effect opacity is used twice/],
  [['highlight', 'own rows'], /need 9 storage buffers in one shader stage/],
  [['highlight', 'motion'], /need 9 storage buffers/],
  [['own rows', 'motion'], /need 9 storage buffers/],
  [['motion', 'morph'], /a morph holds only splats that stand still/],
  [['motion', 'stream'], /a scene in bricks holds only splats that stand still/],
  [['motion', 'skin'], /its splats move by themselves/],
  [['morph', 'skin'], /follows a morph, so it cannot follow this skin/],
  [['morph', 'edits'], /follows a morph; edit its splats before/],
  [['morph', 'removed'], /follows a morph; edit its splats before/],
  [['stream', 'skin'], /only parts of it are there/],
  [['stream', 'edits'], /only parts of it are there/],
  [['stream', 'removed'], /only parts of it are there/],
  [['stream', 'instances'], /a cloud that streams has no instances/],
  [['skin', 'edits'], /follows a skin; edit its splats before/],
  [['skin', 'removed'], /follows a skin; edit its splats before/],
];

/** The error by which some refuse each other. */
function refusalOf(some: readonly FrameMember[]): RegExp | undefined {
  const names = some.map(({ name }) => name);
  return REFUSED.find(([two]) => two.every((name) => names.includes(name)))?.[1];
}

/** Most members of a frame of pairs: of more, each brings fewer pairs that have not met. */
const MOST_TOGETHER = 4;

/**
 * Frames in which each two members meet once that do not both make the cloud. Two that refuse each other are a
 * frame; others meet in frames of up to four, since compiling a frame's shaders takes most of its time.
 */
function framesOfPairs(): FrameMember[][] {
  const met = new Set<string>();
  const pairsOf = (some: readonly FrameMember[]) =>
    some.flatMap((a, i) => some.slice(i + 1).map((b) => [a, b]));
  const sorted = (some: readonly FrameMember[]) => members.filter((member) => some.includes(member));
  const keyOf = (pair: readonly FrameMember[]) => JSON.stringify(sorted(pair).map(({ name }) => name));
  const mayMeet = (pair: readonly FrameMember[]) =>
    !met.has(keyOf(pair)) && !refusalOf(pair) && !pair.every(({ load }) => load);
  const frames: FrameMember[][] = [];
  for (const pair of pairsOf(members)) {
    if (refusalOf(pair)) frames.push(pair);
    if (!mayMeet(pair)) continue;
    const some = [...pair];
    for (const each of members)
      if (some.length < MOST_TOGETHER && some.every((one) => one !== each && mayMeet([one, each])))
        some.push(each);
    for (const two of pairsOf(some)) met.add(keyOf(two));
    frames.push(sorted(some));
  }
  return frames;
}

/** @throws the errors by which members refuse each other. */
async function psnrDbOf(some: readonly FrameMember[]): Promise<number> {
  const { request, reference } = await frames.frameOf(some);
  const view = (await frames.engineFor(some)).createView();
  try {
    view.render({ ...request, ...SIZE });
    await view.whenComplete();
    const { data } = await view.readPixels();
    return compareImages(data, renderReference({ ...reference, ...SIZE }).data, SIZE).psnrDb;
  } finally {
    view.destroy();
  }
}

async function checkTogether(some: readonly FrameMember[]): Promise<void> {
  const names = some.map(({ name }) => name);
  const refusal = refusalOf(some);
  const found = await psnrDbOf(some).catch((error: Error) => error);
  if (refusal) {
    expect(found, names.join(' + ')).toBeInstanceOf(WebSplatterError);
    expect((found as Error).message, names.join(' + ')).toMatch(refusal);
    return;
  }
  if (found instanceof Error) throw new Error(names.join(' + '), { cause: found });
  expect(found, names.join(' + ')).toBeGreaterThan(names.includes('packed splats') ? 40 : 60);
}

describe('everything that may be in one frame is drawn as in float64, or refused by name', () => {
  gpuTest('alone', async () => {
    for (const member of members) await checkTogether([member]);
  });

  const parts = 2;
  for (let part = 0; part < parts; part++)
    gpuTest(`each two, part ${part + 1} of ${parts}`, async () => {
      for (const some of framesOfPairs().filter((_, i) => i % parts === part)) await checkTogether(some);
    });
});
