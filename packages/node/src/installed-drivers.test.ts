import { expect, test } from 'vitest';
import { installedDrivers } from './installed-drivers.ts';

const ICD = '/usr/share/vulkan/icd.d';
/** Mesa's, as Debian installs them, beside NVIDIA's. */
const DRIVERS = ['lvp_icd.x86_64.json', 'radeon_icd.x86_64.json', 'intel_icd.json', 'nvidia_icd.json'];

function onMachine(directories: Record<string, string[]>, env: Record<string, string> = {}) {
  return installedDrivers({
    env,
    listDirectory: (path) => directories[path] ?? [],
    fileExists: () => true,
  });
}

test('where there is no render node, Mesa’s drivers for GPUs are idle', () => {
  // A virtual machine's display: Mesa's Vulkan drivers do not use it.
  expect(onMachine({ [ICD]: DRIVERS, '/dev/dri': ['card0', 'by-path'] })).toEqual({
    gpu: [`${ICD}/nvidia_icd.json`],
    software: [`${ICD}/lvp_icd.x86_64.json`],
    idle: [`${ICD}/radeon_icd.x86_64.json`, `${ICD}/intel_icd.json`],
  });
});

test('with a render node they may all find a GPU', () => {
  const { gpu, software, idle } = onMachine({ [ICD]: DRIVERS, '/dev/dri': ['card0', 'renderD128'] });
  expect(gpu).toEqual([`${ICD}/radeon_icd.x86_64.json`, `${ICD}/intel_icd.json`, `${ICD}/nvidia_icd.json`]);
  expect(software).toEqual([`${ICD}/lvp_icd.x86_64.json`]);
  expect(idle).toEqual([]);
});

test('drivers that reach their GPU in another way have their own devices', () => {
  const drivers = ['dzn_icd.x86_64.json', 'freedreno_icd.aarch64.json'];
  expect(onMachine({ [ICD]: drivers }).gpu).toEqual([]);
  expect(onMachine({ [ICD]: drivers, '/dev': ['dxg'] }).gpu).toEqual([`${ICD}/dzn_icd.x86_64.json`]);
  expect(onMachine({ [ICD]: drivers, '/dev': ['kgsl-3d0'] }).gpu).toEqual([
    `${ICD}/freedreno_icd.aarch64.json`,
  ]);
});

test('the directories are the loader’s, each once, and drivers that the user adds come first', () => {
  const directories = {
    '/home/ann/.config/vulkan/icd.d': ['a.json'],
    '/etc/vulkan/icd.d': ['b.json', 'b.json.bak'],
    '/data/vulkan/icd.d': ['c.json'],
  };
  const env = { HOME: '/home/ann', XDG_DATA_DIRS: '/data:/data', VK_ADD_DRIVER_FILES: '/opt/d.json' };
  expect(onMachine(directories, env).gpu).toEqual([
    '/opt/d.json',
    '/home/ann/.config/vulkan/icd.d/a.json',
    '/etc/vulkan/icd.d/b.json',
    '/data/vulkan/icd.d/c.json',
  ]);
});

test('a user’s choice of drivers leaves no others', () => {
  const none = { gpu: [], software: [], idle: [] };
  expect(onMachine({ [ICD]: DRIVERS }, { VK_DRIVER_FILES: '/opt/driver.json' })).toEqual(none);
  expect(onMachine({ [ICD]: DRIVERS }, { VK_ICD_FILENAMES: '/opt/driver.json' })).toEqual(none);
});
