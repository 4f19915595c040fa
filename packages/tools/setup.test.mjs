import { mkdirSync, mkdtempSync, rmSync, utimesSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { afterEach, expect, onTestFinished, test, vi } from 'vitest';
import { ensureSecondWebGpu, isInstalled } from './setup.mjs';

const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
vi.spyOn(console, 'error').mockImplementation(() => {});
const exit = vi.spyOn(process, 'exit').mockImplementation((status) => {
  throw new Error(`exit ${status}`);
});
afterEach(() => {
  vi.clearAllMocks();
});

const missing = ['firefox-esr'];
const lacking = { missing, mayInstall: true, install: () => false, isCi: false };

test('where apt-get cannot install the second WebGPU, its tests are skipped with a reason', () => {
  expect(ensureSecondWebGpu(lacking)).toBe(false);
  expect(warn).toHaveBeenCalledWith(
    expect.stringContaining('will be skipped: apt-get could not install firefox'),
  );
  expect(exit).not.toHaveBeenCalled();
});

test('where it may not be installed, nothing is tried', () => {
  const install = vi.fn();
  expect(ensureSecondWebGpu({ ...lacking, mayInstall: false, install, isCi: true })).toBe(false);
  expect(install).not.toHaveBeenCalled();
  expect(warn).toHaveBeenCalledWith(expect.stringContaining('firefox-esr cannot be found'));
});

test('in CI, a failed installation ends the process', () => {
  expect(() => ensureSecondWebGpu({ ...lacking, isCi: true })).toThrow('exit 1');
});

test('installed programs must run', () => {
  const isDenoThere = process.arch === 'x64';
  expect(ensureSecondWebGpu({ ...lacking, install: () => true })).toBe(isDenoThere);
  expect(ensureSecondWebGpu({ ...lacking, missing: [] })).toBe(isDenoThere);
  expect(warn).not.toHaveBeenCalled();
});

test('packages count as installed where they are not older than their lock', () => {
  const folder = mkdtempSync(join(tmpdir(), 'websplatter-setup-'));
  onTestFinished(() => rmSync(folder, { recursive: true }));
  const [lock, installed] = ['package-lock.json', 'node_modules/.package-lock.json'].map((path) =>
    join(folder, path),
  );
  mkdirSync(join(folder, 'node_modules'));
  writeFileSync(lock, '');
  expect(isInstalled(folder)).toBe(false);
  writeFileSync(installed, '');
  utimesSync(lock, 1000, 1000);
  expect(isInstalled(folder)).toBe(true);
  utimesSync(installed, 999, 999);
  expect(isInstalled(folder)).toBe(false);
});
