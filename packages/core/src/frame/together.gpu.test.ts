// Proves: the shaders of whatever may be in one frame link and are valid together, for every host.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { internAccuracy } from '../data/accuracy/accuracy.ts';
import { WebSplatterError } from '../data/errors.ts';
import { numberOf } from '../data/number-of.ts';
import { linkShader, loadVariant } from '../gpu/shaders/link-shader.ts';
import type { RasterizeDepth } from '../stages/quads/quads.ts';
import { sortDeviceOf } from '../stages/sort/sort.ts';
import { type FrameMember, frameMembers, MemberFrames } from '../testing/frame-members.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { frameStages } from './frame.ts';
import { FramePlanner } from './frame-planner.ts';
import type { FrameOutput } from './frame-shape.ts';

const TRIPLES = 500;
const SIZE = { widthPx: 32, heightPx: 32 };
const DEPTH = { mapping: 'projection', compare: 'less-equal', isOrthographic: false } as const;

const HOSTS: Readonly<Record<string, readonly [FrameOutput, RasterizeDepth | null]>> = {
  image: [{ kind: 'image' }, null],
  canvas: [{ kind: 'canvas', format: 'bgra8unorm', storable: null }, null],
  'canvas that compute shaders write': [
    { kind: 'canvas', format: 'rgba8unorm', storable: 'rgba8unorm' },
    null,
  ],
  host: [{ kind: 'host' }, null],
  'host with depth': [{ kind: 'host' }, { ...DEPTH, isTested: true, layerFormat: null }],
  'host that takes depth': [{ kind: 'host' }, { ...DEPTH, isTested: true, layerFormat: 'r32float' }],
  'host that takes depth of quads': [
    { kind: 'host' },
    { ...DEPTH, isTested: false, layerFormat: 'r16float' },
  ],
};

let device: GPUDevice;
let members: readonly FrameMember[];
let frames: MemberFrames;
beforeAll(async () => {
  device = await shareTestDevice();
  members = frameMembers(device);
  frames = new MemberFrames(device);
});
afterAll(() => frames.destroy());

/** Stages that were linked, by all that their texts depend on. */
const linked = new Set<string>();

/** Links all shaders of a frame for every host, and has the device check new ones. */
async function link(some: readonly FrameMember[]): Promise<void> {
  const { request } = await frames.frameOf(some);
  for (const { cloud } of request.clouds) await cloud.uploaded;
  const accuracy = internAccuracy((await frames.engineFor(some)).accuracy);
  const { maxComputeWorkgroupsPerDimension: dispatchRow } = device.limits;
  const checks: Promise<void>[] = [];
  for (const [output, depth] of Object.values(HOSTS)) {
    const planner = new FramePlanner({ dispatchRow, sortDevice: sortDeviceOf(device) }, output, () => true);
    const plan = planner.plan({ ...request, ...SIZE }, { accuracy, depth, faster: 'tiles' });
    for (const entry of frameStages(plan.shape)) {
      const stage = 'stage' in entry ? entry : entry[0];
      const { conditions, constants, effects } = stage;
      const key = JSON.stringify([stage.stage, conditions, constants, effects && numberOf(effects)]);
      if (linked.has(key)) continue;
      linked.add(key);
      checks.push(check(linkShader(await loadVariant(stage))));
    }
  }
  await Promise.all(checks);
}

async function check(text: string): Promise<void> {
  const { messages } = await device.createShaderModule({ code: text }).getCompilationInfo();
  expect(messages.filter(({ type }) => type === 'error').map(({ message }) => message)).toEqual([]);
}

/** Links frames; members that refuse each other by name are left to the test that draws pairs. */
async function linkAll(all: Iterable<readonly FrameMember[]>): Promise<number> {
  let count = 0;
  for (const some of all) {
    try {
      await link(some);
      count++;
    } catch (error) {
      const names = some.map(({ name }) => name).join(' + ');
      if (!(error instanceof WebSplatterError)) throw new Error(names, { cause: error });
    }
  }
  return count;
}

function* pairs() {
  for (const [i, a] of members.entries())
    for (const b of members.slice(i + 1)) if (!a.load || !b.load) yield [a, b];
}

function* triples() {
  const random = seededRandom(TRIPLES);
  const anyOf = () => members[Math.floor(members.length * random())];
  for (let i = 0; i < TRIPLES; i++) {
    const some = new Set([anyOf(), anyOf(), anyOf()]);
    // Two that make the cloud in their own ways cannot meet.
    if (Array.from(some).filter(({ load }) => load).length < 2)
      yield members.filter((each) => some.has(each));
  }
}

describe('shaders of everything that may be in one frame', () => {
  gpuTest('link in pairs, for every host', async () => {
    expect(await linkAll(pairs())).toBeGreaterThan((members.length * (members.length - 1)) / 2 - 25);
  });

  gpuTest(`link in ${TRIPLES} triples, for every host`, async () => {
    expect(await linkAll(triples())).toBeGreaterThan(0.8 * TRIPLES);
  });
});
