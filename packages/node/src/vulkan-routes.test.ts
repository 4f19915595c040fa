import { expect, test } from 'vitest';
import type { VulkanSurroundings } from './installed-drivers.ts';
import { vulkanRoutes } from './vulkan-routes.ts';

const SWIFTSHADER = '/usr/lib/chromium/vk_swiftshader_icd.json';
const CHROMIUM_LOADER = '/usr/lib/chromium/libvulkan.so.1';
const RADEON = '/usr/share/vulkan/icd.d/radeon_icd.x86_64.json';
const LAVAPIPE = '/usr/share/vulkan/icd.d/lvp_icd.x86_64.json';
const RENDER_NODE = '/dev/dri/renderD128';
const NVIDIA = '/usr/local/nvidia/share/vulkan/icd.d/nvidia_icd.json';

function machine(files: string[], env: Record<string, string> = {}): VulkanSurroundings {
  return {
    env,
    fileExists: (path) => files.includes(path),
    listDirectory: (path) =>
      files.filter((file) => file.startsWith(`${path}/`)).map((file) => file.slice(path.length + 1)),
  };
}

test('a bare machine has no way to a driver', () => {
  expect(vulkanRoutes(machine([]))).toEqual([]);
});

test('with only Chromium, SwiftShader is reached through Chromium’s own loader', () => {
  expect(vulkanRoutes(machine([SWIFTSHADER, CHROMIUM_LOADER]))).toEqual([
    {
      loaders: ['libvulkan.so.1', CHROMIUM_LOADER],
      driverFiles: [SWIFTSHADER],
      isSoftware: true,
      mayFail: false,
    },
  ]);
});

test('an installed driver comes before SwiftShader, and is left out where software is asked for', () => {
  const desktop = machine([SWIFTSHADER, RADEON, RENDER_NODE]);
  expect(vulkanRoutes(desktop).map((route) => route.driverFiles)).toEqual([null, [SWIFTSHADER]]);
  expect(vulkanRoutes(desktop, true).map((route) => route.driverFiles)).toEqual([[SWIFTSHADER]]);
});

test('NVIDIA’s container mount is used where the user has chosen no driver', () => {
  expect(vulkanRoutes(machine([NVIDIA, SWIFTSHADER])).map((route) => route.driverFiles)).toEqual([
    [NVIDIA],
    [SWIFTSHADER],
  ]);
  const chosen = machine([NVIDIA, SWIFTSHADER], { VK_DRIVER_FILES: '/opt/driver.json' });
  expect(vulkanRoutes(chosen).map((route) => route.driverFiles)).toEqual([null, [SWIFTSHADER]]);
});

test('Mesa’s drivers without a GPU are not tried, and lavapipe does not take SwiftShader’s place', () => {
  const driverFiles = (files: string[], forceSoftware = false) =>
    vulkanRoutes(machine(files), forceSoftware).map((route) => route.driverFiles);
  expect(driverFiles([SWIFTSHADER, RADEON, LAVAPIPE])).toEqual([[SWIFTSHADER]]);
  expect(driverFiles([SWIFTSHADER, RADEON, LAVAPIPE], true)).toEqual([[SWIFTSHADER]]);
  expect(driverFiles([SWIFTSHADER, RADEON, LAVAPIPE, RENDER_NODE])).toEqual([[RADEON], [SWIFTSHADER]]);
});

test('lavapipe is the software driver where there is no SwiftShader', () => {
  expect(vulkanRoutes(machine([RADEON, LAVAPIPE]))).toEqual([
    { loaders: ['libvulkan.so.1'], driverFiles: [LAVAPIPE], isSoftware: true, mayFail: true },
  ]);
  expect(vulkanRoutes(machine([RADEON, LAVAPIPE, RENDER_NODE]), true)).toMatchObject([
    { driverFiles: [LAVAPIPE], isSoftware: true },
  ]);
});

test('WEBSPLATTER_VK_ICD replaces the places where SwiftShader is looked for, the loader beside it included', () => {
  const files = [SWIFTSHADER, CHROMIUM_LOADER, '/opt/sw/icd.json', '/opt/sw/libvulkan.so.1'];
  expect(vulkanRoutes(machine(files, { WEBSPLATTER_VK_ICD: '/opt/sw/icd.json' }))).toEqual([
    {
      loaders: ['libvulkan.so.1', '/opt/sw/libvulkan.so.1', CHROMIUM_LOADER],
      driverFiles: ['/opt/sw/icd.json'],
      isSoftware: true,
      mayFail: true,
    },
  ]);
});

test('a driver may fail unless it needs no GPU or its GPU is there', () => {
  const mayFail = (files: string[], env?: Record<string, string>) =>
    vulkanRoutes(machine(files, env)).map((route) => route.mayFail);
  expect(mayFail([SWIFTSHADER, RADEON, RENDER_NODE])).toEqual([true, false]);
  expect(mayFail([SWIFTSHADER], { VK_DRIVER_FILES: '/opt/driver.json' })).toEqual([true, false]);
  expect(mayFail([NVIDIA])).toEqual([true]);
  expect(mayFail([NVIDIA, '/dev/nvidiactl'])).toEqual([false]);
});
