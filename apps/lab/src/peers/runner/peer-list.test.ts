import { existsSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { SPLAT_FORMATS } from '@websplatter/core/formats';
import { describe, expect, test } from 'vitest';
import { BenchError } from './bench-error.ts';
import { choosePeers, PEER_NAMES, peersFolder, withPackages } from './peer-list.ts';

const all = choosePeers('all', '/here');

describe('the peers that the bench knows', () => {
  test('are all, once, and have adapters', () => {
    expect(all.map(({ name }) => name)).toEqual(PEER_NAMES);
    for (const { adapterPath } of all) expect(existsSync(adapterPath), adapterPath).toBe(true);
  });

  test('are dependencies of apps/lab/peers where their packages come on demand, in one version each', async () => {
    const { dependencies } = JSON.parse(await readFile(join(peersFolder, 'package.json'), 'utf8'));
    for (const { packageFile, isOnDemand } of all) {
      if (!isOnDemand) continue;
      const folder = packageFile!.slice(join(peersFolder, 'node_modules/').length, -'/package.json'.length);
      expect(dependencies[folder], folder).toMatch(/(?:^|@)\d+\.\d+\.\d+$/);
    }
  });

  test('say in their adapters which formats they read', async () => {
    const names = new Set(SPLAT_FORMATS.map(({ name }) => name));
    for (const { name, adapterPath } of all) {
      let source = await readFile(adapterPath, 'utf8');
      const [, from] = /export \{ formats \} from '(.*)'/.exec(source) ?? [];
      if (from) source = await readFile(join(adapterPath, '..', from), 'utf8');
      const [, list] = /export const formats(?:: PeerFormats)? = (\[.*\]|'any');/.exec(source) ?? [];
      const entries = [...(list ?? '').matchAll(/'([\w-]+)(?: [^']*)?'/g)].map(([, entry]) => entry);
      expect(entries, name).not.toEqual([]);
      for (const entry of entries) expect(entry === 'any' || names.has(entry), entry).toBe(true);
    }
  });

  test('have a lock without addresses', async () => {
    const lock = await readFile(join(peersFolder, 'package-lock.json'), 'utf8');
    expect(lock).not.toContain('"resolved"');
  });
});

describe('peers on the command line', () => {
  test('keep their order, and have options for their adapters', () => {
    const [ours, floor] = choosePeers('websplatter?accuracy=fast,floor-webgl2?a=1', '/here');
    expect(ours).toMatchObject({ name: 'websplatter?accuracy=fast', options: 'accuracy=fast' });
    expect(floor).toMatchObject({ name: 'floor-webgl2?a=1', options: 'api=webgl2&a=1', isFloor: true });
  });

  test("one's own are found from where the command was called", () => {
    const [own] = choosePeers('mine=adapters/mine.js?x', '/here');
    expect(own).toMatchObject({
      name: 'mine?x',
      adapterPath: '/here/adapters/mine.js',
      options: 'x',
      packageFile: null,
      isOnDemand: false,
      source: null,
    });
  });

  test('are refused where they are named and their clone is not there, with what to put where', () => {
    const choose = () => choosePeers('antimatter15', '/here', '/clones');
    expect(choose).toThrow(BenchError);
    expect(choose).toThrow(
      /\/clones\/antimatter15 has no main\.js: clone https:\S+ \(its adapter knows commit \w+\) there, or name the folder above by --sources/,
    );
    expect(() => choosePeers('web-splat', '/here', '/clones')).toThrow('compile it by');
  });

  test('are left out of all where their clone is not there', () => {
    const said: string[] = [];
    const chosen = choosePeers('all', '/here', '/clones');
    const installation = { isInstalled: () => true, install: () => false };
    const there = withPackages(chosen, installation, true, (line) => said.push(line));
    expect(chosen.length - there.length).toBe(2);
    expect(there.map(({ name }) => name)).not.toContain('antimatter15');
    expect(said[0]).toMatch(/^antimatter15 is left out: \/clones\/antimatter15 has no main\.js/);
  });

  test.each([
    ['websplater', /has "websplater"; known are floor-webgpu, .*gsplat, .*, and NAME=ADAPTER/],
    ['', /has ""/],
    ['three=mine.js', /new name/],
    ['three,spark,three', /three twice/],
    ['all,gsplat', /gsplat twice/],
  ])('%j is an error that says why', (text, message) => {
    expect(() => choosePeers(text, '/here')).toThrow(BenchError);
    expect(() => choosePeers(text, '/here')).toThrow(message);
  });
});
