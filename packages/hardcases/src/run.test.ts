import { expect, test } from 'vitest';
import { HardCaseRunner } from './run.ts';

test('leaves no device where the first work on it fails', async () => {
  let held = 0;
  const device = {
    lost: new Promise(() => {}),
    addEventListener: () => {},
    createShaderModule: () => {
      throw new Error('no shaders today');
    },
    destroy: () => held--,
  };
  const requestDevice = async () => {
    held++;
    return device;
  };
  const adapter = { features: new Set(), limits: {}, requestDevice };
  const gpu = { requestAdapter: async () => adapter } as unknown as GPU;
  await expect(HardCaseRunner.create({ gpu })).rejects.toThrow('no shaders today');
  expect(held).toBe(0);
});
