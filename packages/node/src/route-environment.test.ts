import { expect, test } from 'vitest';
import { routeEnvironment } from './node-gpu.ts';
import type { VulkanRoute } from './vulkan-routes.ts';

const route = (driverFiles: string[] | null): VulkanRoute => ({
  loaders: ['libvulkan.so.1'],
  driverFiles,
  isSoftware: false,
  mayFail: false,
});
const SESSION = { XDG_RUNTIME_DIR: '/run/user/1000' };

test('loaders old and new are pointed at the drivers of a route', () => {
  expect(routeEnvironment(route(['/a.json', '/b.json']), SESSION)).toEqual({
    VK_DRIVER_FILES: '/a.json:/b.json',
    VK_ICD_FILENAMES: '/a.json:/b.json',
  });
});

test('a desktop session’s loader is left to find its drivers by itself', () => {
  expect(routeEnvironment(route(null), SESSION)).toEqual({});
});

test('libwayland finds an absolute path in XDG_RUNTIME_DIR where the user has set none', () => {
  for (const env of [{}, { XDG_RUNTIME_DIR: '' }, { XDG_RUNTIME_DIR: 'run' }]) {
    expect(routeEnvironment(route(null), env)).toEqual({ XDG_RUNTIME_DIR: '/dev/null' });
  }
});
