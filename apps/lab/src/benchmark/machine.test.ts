import { describe, expect, it } from 'vitest';
import { browserMachine } from './machine.ts';

describe('facts that a browser tells about its machine', () => {
  it('is all that it tells', async () => {
    const told = { platform: 'Linux', platformVersion: '6.1', architecture: 'x86', bitness: '64', model: '' };
    const machine = await browserMachine({
      userAgent: 'Browser/1',
      hardwareConcurrency: 8,
      deviceMemory: 4,
      userAgentData: { getHighEntropyValues: async () => told },
    });
    expect(machine).toEqual({
      browser: 'Browser/1',
      platform: 'Linux 6.1',
      architecture: 'x86 64',
      model: null,
      threads: 8,
      memoryGiB: 4,
    });
  });

  it.each([
    ['has no such questions', undefined],
    ['refuses to answer them', { getHighEntropyValues: () => Promise.reject(new Error('no')) }],
  ])('is the user agent alone where it %s', async (_, userAgentData) => {
    expect(await browserMachine({ userAgent: 'Browser/1', hardwareConcurrency: 0, userAgentData })).toEqual({
      browser: 'Browser/1',
      platform: null,
      architecture: null,
      model: null,
      threads: null,
      memoryGiB: null,
    });
  });
});
