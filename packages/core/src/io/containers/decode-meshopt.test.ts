import { expect, test, vi } from 'vitest';
import { CodeUnavailableError } from '../../data/errors.ts';
import { glbBytes, gltfOf, splatAttributes } from '../../testing/gltf-fixture.ts';
import { meshoptPacked } from '../../testing/meshopt-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { readSplats } from '../loading/read-splats.ts';

const decoder = vi.hoisted(() => ({
  MeshoptDecoder: {
    supported: true,
    get ready() {
      return Promise.reject(new Error('blocked by CSP'));
    },
  },
}));
vi.mock('meshoptimizer/decoder', () => decoder);

/** @fault Files: views that claim to be packed by meshopt, damaged or impossible */
test('without WebAssembly, as a policy may forbid it, a file that needs it is a typed error', async () => {
  const file = glbBytes(await meshoptPacked(gltfOf(splatAttributes(randomSplats({ count: 5 })))));
  const blocked = await readSplats(file).catch((reason) => reason);
  expect(blocked).toBeInstanceOf(CodeUnavailableError);
  expect(blocked.message).toContain('decoder of meshopt');
  expect(blocked.message).toContain('blocked by CSP');
  decoder.MeshoptDecoder.supported = false;
  await expect(readSplats(file)).rejects.toThrow('there is no WebAssembly here');
});
