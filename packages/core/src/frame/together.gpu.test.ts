// Proves: the shaders of whatever may be in one frame link and are valid together, for every host.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { linkShader } from '../gpu/shaders/link-shader.ts';
import type { FrameMember } from '../testing/frame-members.ts';
import { StagesTogether } from '../testing/stages-together.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';

let device: GPUDevice;
let together: StagesTogether;
beforeAll(async () => {
  device = await shareTestDevice();
  together = new StagesTogether(device);
});
afterAll(() => together.destroy());

/** Texts that the device has checked: different stages of many frames have the same. */
const checked = new Set<string>();

async function check(text: string): Promise<void> {
  if (checked.has(text)) return;
  checked.add(text);
  const { messages } = await device.createShaderModule({ code: text }).getCompilationInfo();
  expect(messages.filter(({ type }) => type === 'error').map(({ message }) => message)).toEqual([]);
}

/** Links the shaders of frames, and has the device check new ones. Returns how many frames can be drawn. */
async function linkAll(frames: readonly (readonly FrameMember[])[]): Promise<number> {
  let count = 0;
  for (const some of frames) {
    const stages = await together.newStagesOf(some);
    if (stages) count++;
    await Promise.all(stages?.map((stage) => check(linkShader(stage))) ?? []);
  }
  return count;
}

describe('shaders of everything that may be in one frame', () => {
  // The test that draws pairs says which are refused.
  gpuTest('link in pairs, for every host', { tags: 'deeper' }, async () => {
    const all = together.pairs();
    const pairs = all.filter((_, i) => isFull || i % 3 === 0);
    expect(new Set(pairs.flat()).size, 'members').toBe(new Set(all.flat()).size);
    expect(await linkAll(pairs)).toBeGreaterThan(pairs.length - (isFull ? 20 : 7));
  });

  gpuTest('link in triples, for every host', { tags: 'deeper' }, async () => {
    const triples = together.triples();
    const linked = await linkAll(isFull ? triples : triples.slice(0, 100));
    expect(linked).toBeGreaterThan(isFull ? 400 : 80);
  });
});
