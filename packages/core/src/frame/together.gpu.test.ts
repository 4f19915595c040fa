// Proves: the shaders of whatever may be in one frame link and are valid together, for every host.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { linkShader } from '../gpu/shaders/link-shader.ts';
import type { FrameMember } from '../testing/frame-members.ts';
import { StagesTogether } from '../testing/stages-together.ts';

let device: GPUDevice;
let together: StagesTogether;
beforeAll(async () => {
  device = await shareTestDevice();
  together = new StagesTogether(device);
});
afterAll(() => together.destroy());

async function check(text: string): Promise<void> {
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
  gpuTest('link in pairs, for every host', async () => {
    const pairs = together.pairs();
    expect(await linkAll(pairs)).toBeGreaterThan(pairs.length - 20);
  });

  gpuTest('link in triples, for every host', async () => {
    expect(await linkAll(together.triples())).toBeGreaterThan(400);
  });
});
